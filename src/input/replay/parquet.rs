//! fcd-output in Parquet, as SUMO writes it since 1.24: the columns of its CSV, with numbers as numbers.

use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::column::reader::ColumnReader;
use parquet::data_type::{ByteArrayType, DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::clock;
use super::columns::{Columns, NamedColumn};
use super::names::Users;
use super::rows::{Fields, RecordedStep, Scope, in_order};
use crate::util::parquet_column::{self, Batch, guarded};
use crate::util::units::Second;
use crate::{Error, Result};

/// Rows in memory at once.
const BATCH: usize = 4096;

/// A Parquet recording being read.
pub(super) struct ParquetRecording {
    path: PathBuf,
    file: SerializedFileReader<File>,
    scope: Scope,
    columns: Columns,
    next_group: usize,
    /// The time and the columns that matter, in the row group that is read.
    values: Option<(ColumnBatch, Vec<(NamedColumn, ColumnBatch)>)>,
    /// Rows of the group that are not in the batch or before it.
    left: usize,
    /// Rows of the batch, and how many of them were used.
    batch: usize,
    used: usize,
    /// Rows of the batches before.
    rows_before: u64,
    last: Option<Second>,
}

impl ParquetRecording {
    pub fn new(path: &Path, file: File, scope: Scope) -> Result<Self> {
        let file = parquet_column::open(path, file)?;
        let schema = file.metadata().file_metadata().schema_descr();
        let names = schema.columns().iter().map(|column| column.name().to_owned()).collect::<Vec<_>>();
        let mut columns = Columns::of(path, &names, scope)?;
        columns.named.retain(|column| column.attribute.is_some());
        Ok(Self {
            path: path.to_owned(),
            file,
            scope,
            columns,
            next_group: 0,
            values: None,
            left: 0,
            batch: 0,
            used: 0,
            rows_before: 0,
            last: None,
        })
    }

    pub fn next_step(&mut self, step: &mut RecordedStep, users: &mut Users) -> Result<bool> {
        let mut begun = false;
        while self.fill()? {
            let Some((times, values)) = &self.values else { break };
            let row = self.used;
            let wrong = |message| {
                let row = self.rows_before + row as u64 + 1;
                Error::content(&self.path, format!("row {row}: {message}"))
            };
            let time = times.time(row).ok_or_else(|| wrong("its time cannot be read".to_owned()))?;
            if begun && time != step.time {
                break;
            }
            if !begun {
                in_order(self.last, time).map_err(wrong)?;
                step.begin(time, users);
                begun = true;
            }
            let mut fields = self.scope.fields();
            for (column, values) in values {
                values.set(row, column, &mut fields).map_err(wrong)?;
            }
            if self.columns.shared {
                fields.tell_apart();
            }
            // A step without road users has one row without an id.
            if fields.has_id() {
                step.add(&fields, users, "value in column").map_err(wrong)?;
            }
            self.used += 1;
        }
        if begun {
            step.end(users);
            self.last = Some(step.time);
        }
        Ok(begun)
    }

    /// Reads the next batch if all rows of the last one were used; whether there is a row.
    fn fill(&mut self) -> Result<bool> {
        if self.used < self.batch {
            return Ok(true);
        }
        let path = self.path.clone();
        guarded(&path, || self.next_batch())
    }

    fn next_batch(&mut self) -> std::result::Result<bool, ParquetError> {
        while self.used == self.batch {
            if self.left == 0 && !self.open_group()? {
                return Ok(false);
            }
            self.rows_before += self.batch as u64;
            self.batch = self.left.min(BATCH);
            self.used = 0;
            self.left -= self.batch;
            let Some((times, values)) = &mut self.values else { return Ok(false) };
            for column in std::iter::once(times).chain(values.iter_mut().map(|(_, values)| values)) {
                if column.read(self.batch)? != self.batch {
                    return Err(ParquetError::General("its columns differ in length".to_owned()));
                }
            }
        }
        Ok(true)
    }

    /// Opens the columns of the next row group; whether there is one.
    fn open_group(&mut self) -> std::result::Result<bool, ParquetError> {
        if self.next_group == self.file.num_row_groups() {
            return Ok(false);
        }
        let group = self.file.get_row_group(self.next_group)?;
        self.next_group += 1;
        self.left = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
        let open = |place: usize| ColumnBatch::new(group.get_column_reader(place)?);
        let named = self.columns.named.iter().map(|column| Ok((*column, open(column.place)?)));
        let named = named.collect::<std::result::Result<_, ParquetError>>()?;
        self.values = Some((open(self.columns.time)?, named));
        Ok(true)
    }
}

/// The values of a column in a batch. SUMO writes numbers as 64 or 32 bits (`--precision`), and clock times as text.
enum ColumnBatch {
    Text(Batch<ByteArrayType>),
    Double(Batch<DoubleType>),
    Float(Batch<FloatType>),
}

impl ColumnBatch {
    fn new(reader: ColumnReader) -> std::result::Result<Self, ParquetError> {
        Ok(match reader {
            ColumnReader::ByteArrayColumnReader(reader) => Self::Text(Batch::new(reader)),
            ColumnReader::DoubleColumnReader(reader) => Self::Double(Batch::new(reader)),
            ColumnReader::FloatColumnReader(reader) => Self::Float(Batch::new(reader)),
            _ => return Err(ParquetError::General("a column has another type than in an fcd-output".to_owned())),
        })
    }

    fn read(&mut self, rows: usize) -> std::result::Result<usize, ParquetError> {
        match self {
            Self::Text(batch) => batch.read(rows),
            Self::Double(batch) => batch.read(rows),
            Self::Float(batch) => batch.read(rows),
        }
    }

    fn number(&self, row: usize) -> Option<f64> {
        match self {
            Self::Text(_) => None,
            Self::Double(batch) => batch.get(row).copied(),
            Self::Float(batch) => batch.get(row).copied().map(f64::from),
        }
    }

    fn time(&self, row: usize) -> Option<Second> {
        match self {
            Self::Text(batch) => clock::time(batch.get(row)?.data()),
            _ => self.number(row),
        }
    }

    /// Sets a field from its value in a row, if there is one.
    #[inline]
    fn set<'a>(&'a self, row: usize, column: &NamedColumn, fields: &mut Fields<'a>) -> std::result::Result<(), String> {
        let Some(attribute) = column.attribute else { return Ok(()) };
        match self {
            Self::Text(batch) => {
                let Some(text) = batch.get(row) else { return Ok(()) };
                fields.set(attribute, text.data())?;
            }
            _ => {
                let Some(number) = self.number(row) else { return Ok(()) };
                fields.set_number(attribute, number)?;
            }
        }
        fields.person |= column.person;
        Ok(())
    }
}
