//! `conflicts.parquet`, batch by batch: a log as a sweep writes it, one file per run with its `run.json` inside.

use std::fs::File;
use std::path::{Path, PathBuf};

use parquet::basic::Type as Physical;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::conflicts::{LoggedConflict, LoggedSnapshot};
use super::fields::{FIELDS, WITHOUT_STANCES};
use crate::detection::kind::{Kind, Severity};
use crate::output::log::CONFLICT_COLUMNS;
use crate::{Error, Result};

/// The name of the conflicts' file in a sweep.
pub const PARQUET: &str = "conflicts.parquet";

/// Where in the file's metadata the text of `run.json` is.
pub(super) const RECORD_KEY: &str = "closecall.run.json";
/// Where in the file's metadata the fingerprint of what was asked for is.
pub(super) const FINGERPRINT_KEY: &str = "closecall.fingerprint";

/// So many rows are in memory at once.
const BATCH: usize = 4096;

/// What stands in a `conflicts.parquet` besides its rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed {
    /// The text of `run.json`.
    pub record: String,
    /// The fingerprint of what was asked for.
    pub fingerprint: String,
    /// The columns that tell the runs of a sweep apart, each with whether it holds numbers.
    pub labels: Vec<(String, bool)>,
}

impl Packed {
    /// Reads the metadata of a `conflicts.parquet`.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read; [`Error::Content`] where it is no file of a sweep.
    pub fn of(path: &Path) -> Result<Self> {
        let file = open(path)?;
        let metadata = file.metadata().file_metadata();
        let value = |key: &str| {
            let pairs = metadata.key_value_metadata().into_iter().flatten();
            let found = pairs.filter(|pair| pair.key == key).find_map(|pair| pair.value.clone());
            found.ok_or_else(|| Error::content(path, format!("no sweep of closecall has written it: {key} is missing")))
        };
        let columns = metadata.schema_descr().columns().iter();
        let labels = columns.filter(|column| !CONFLICT_COLUMNS.contains(&column.name()));
        Ok(Self {
            record: value(RECORD_KEY)?,
            fingerprint: value(FINGERPRINT_KEY)?,
            labels: labels
                .map(|column| (column.name().to_owned(), column.physical_type() != Physical::BYTE_ARRAY))
                .collect(),
        })
    }
}

/// The rows of a `conflicts.parquet`; memory is that of one batch and of the pages that it is in.
pub struct ParquetRows {
    path: PathBuf,
    file: SerializedFileReader<File>,
    /// Where in the file the columns of the log are, in the order of [`CONFLICT_COLUMNS`].
    places: Vec<Option<usize>>,
    /// How many of the columns are read.
    wanted: usize,
    next_group: usize,
    columns: Vec<Column>,
    /// Rows of the group that are not read yet.
    left: usize,
    /// Rows of the batch, and how many of them were passed on.
    batch: usize,
    passed: usize,
}

impl std::fmt::Debug for ParquetRows {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("ParquetRows").field("path", &self.path).finish_non_exhaustive()
    }
}

impl ParquetRows {
    /// Opens the file and checks its columns.
    pub fn open(path: &Path) -> Result<Self> {
        let file = open(path)?;
        let columns = file.metadata().file_metadata().schema_descr().columns();
        let mut places = Vec::with_capacity(FIELDS.len());
        for (at, (name, field)) in CONFLICT_COLUMNS.into_iter().zip(FIELDS).enumerate() {
            let place = columns.iter().position(|column| column.name() == name);
            let fits = place.is_some_and(|place| columns[place].physical_type() == field.physical());
            if !fits && (at < WITHOUT_STANCES || place.is_some()) {
                let wrong = if place.is_some() { "has another type than that of a log" } else { "is missing" };
                return Err(Error::content(path, format!("the column \"{name}\" {wrong}")));
            }
            places.push(place);
        }
        Ok(Self {
            path: path.to_owned(),
            file,
            places,
            wanted: WITHOUT_STANCES,
            next_group: 0,
            columns: Vec::new(),
            left: 0,
            batch: 0,
            passed: 0,
        })
    }

    /// From now on rows have their snapshots, where the file has them.
    pub fn read_snapshots(&mut self) {
        if self.places.iter().all(Option::is_some) {
            self.wanted = FIELDS.len();
        }
    }

    /// The columns, without those that tell the runs of a sweep apart.
    pub fn columns(&self) -> Vec<String> {
        let there = CONFLICT_COLUMNS.iter().zip(&self.places).filter(|(_, place)| place.is_some());
        there.map(|(name, _)| (*name).to_owned()).collect()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next row; none after the last.
    pub fn read(&mut self) -> Result<Option<LoggedConflict>> {
        while self.passed == self.batch {
            if self.left == 0 && !self.open_group()? {
                return Ok(None);
            }
            self.read_batch()?;
        }
        let row = Row { columns: self.columns.iter_mut(), at: self.passed };
        self.passed += 1;
        let conflict = row.conflict().map_err(|message| Error::content(&self.path, message))?;
        match conflict.not_finite() {
            Some(number) => {
                let message = format!("conflict {}: {number} is no number of a log", conflict.id);
                Err(Error::content(&self.path, message))
            }
            None => Ok(Some(conflict)),
        }
    }

    /// Opens the columns of the next row group; whether there is one.
    fn open_group(&mut self) -> Result<bool> {
        if self.next_group == self.file.num_row_groups() {
            return Ok(false);
        }
        let fault = |error| unreadable(&self.path, &error);
        let group = self.file.get_row_group(self.next_group).map_err(fault)?;
        self.next_group += 1;
        self.left = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
        self.columns.clear();
        for place in self.places[..self.wanted].iter().copied().flatten() {
            let reader = group.get_column_reader(place).map_err(fault)?;
            self.columns.push(Column::new(reader).map_err(|message| Error::content(&self.path, message))?);
        }
        Ok(true)
    }

    fn read_batch(&mut self) -> Result<()> {
        (self.batch, self.passed) = (self.left.min(BATCH), 0);
        self.left -= self.batch;
        for column in &mut self.columns {
            let read = column.read(self.batch).map_err(|error| unreadable(&self.path, &error))?;
            if read != self.batch {
                return Err(Error::content(&self.path, "its columns differ in length"));
            }
        }
        Ok(())
    }
}

/// A column of a row group and its values in the batch.
enum Column {
    Count(Cells<parquet::data_type::Int64Type>),
    Text(Cells<parquet::data_type::ByteArrayType>),
    Number(Cells<parquet::data_type::DoubleType>),
    Flag(Cells<parquet::data_type::BoolType>),
}

impl Column {
    fn new(reader: ColumnReader) -> std::result::Result<Self, String> {
        Ok(match reader {
            ColumnReader::Int64ColumnReader(reader) => Self::Count(Cells::new(reader)),
            ColumnReader::ByteArrayColumnReader(reader) => Self::Text(Cells::new(reader)),
            ColumnReader::DoubleColumnReader(reader) => Self::Number(Cells::new(reader)),
            ColumnReader::BoolColumnReader(reader) => Self::Flag(Cells::new(reader)),
            _ => return Err("a column has another type than that of a log".to_owned()),
        })
    }

    fn read(&mut self, rows: usize) -> std::result::Result<usize, ParquetError> {
        match self {
            Self::Count(cells) => cells.read(rows),
            Self::Text(cells) => cells.read(rows),
            Self::Number(cells) => cells.read(rows),
            Self::Flag(cells) => cells.read(rows),
        }
    }
}

/// Values of one type; those that are null have none.
struct Cells<T: DataType> {
    reader: ColumnReaderImpl<T>,
    values: Vec<T::T>,
    /// 1 where there is a value; empty where nothing can be null.
    levels: Vec<i16>,
    next: usize,
}

impl<T: DataType> Cells<T> {
    fn new(reader: ColumnReaderImpl<T>) -> Self {
        Self { reader, values: Vec::new(), levels: Vec::new(), next: 0 }
    }

    fn read(&mut self, rows: usize) -> std::result::Result<usize, ParquetError> {
        self.values.clear();
        self.levels.clear();
        self.next = 0;
        let (rows, ..) = self.reader.read_records(rows, Some(&mut self.levels), None, &mut self.values)?;
        Ok(rows)
    }

    /// The value in the row, which comes after the last one that was asked for.
    fn take(&mut self, row: usize) -> Option<&T::T> {
        if self.levels.get(row).is_some_and(|level| *level == 0) {
            return None;
        }
        self.next += 1;
        self.values.get(self.next - 1)
    }
}

/// One row, column by column in the order of the log.
struct Row<'a> {
    columns: std::slice::IterMut<'a, Column>,
    at: usize,
}

type Said<T> = std::result::Result<T, String>;

impl Row<'_> {
    fn conflict(mut self) -> Said<LoggedConflict> {
        // The fields stand, and are evaluated, in the order of the columns.
        let mut conflict = LoggedConflict {
            id: self.count()?,
            ego: self.text()?,
            foe: self.text()?,
            kind: self.among(&Kind::ALL, Kind::name)?,
            severity: self.among(&Severity::ALL, Severity::name)?,
            begin: self.number()?,
            end: self.number()?,
            time: self.number()?,
            gap: self.number()?,
            mu: self.number()?,
            margin: self.number()?,
            clearance: self.number()?,
            ttc: self.maybe(),
            drac: self.maybe(),
            pet: self.maybe(),
            delta_v: self.number()?,
            ego_speed: self.number()?,
            foe_speed: self.number()?,
            angle: self.number()?,
            x: self.number()?,
            y: self.number()?,
            lane: self.text()?,
            collision: self.flag(),
            ego_type: self.text()?,
            foe_type: self.text()?,
            snapshots: None,
        };
        if self.columns.len() > 0 {
            conflict.snapshots = Some(Box::new([self.stance()?, self.stance()?]));
        }
        Ok(conflict)
    }

    fn stance(&mut self) -> Said<LoggedSnapshot> {
        let mut number = || self.maybe().unwrap_or_default();
        let (x, y, heading, length, width) = (number(), number(), number(), number(), number());
        Ok(LoggedSnapshot { x, y, heading, length, width, path: self.text()? })
    }

    fn count(&mut self) -> Said<u64> {
        let Some(Column::Count(cells)) = self.columns.next() else { return Err("an id is missing".to_owned()) };
        let count = cells.take(self.at).copied().unwrap_or_default();
        u64::try_from(count).map_err(|_| format!("{count} is no id"))
    }

    fn flag(&mut self) -> bool {
        match self.columns.next() {
            Some(Column::Flag(cells)) => cells.take(self.at) == Some(&true),
            _ => false,
        }
    }

    fn maybe(&mut self) -> Option<f64> {
        match self.columns.next() {
            Some(Column::Number(cells)) => cells.take(self.at).copied(),
            _ => None,
        }
    }

    fn number(&mut self) -> Said<f64> {
        self.maybe().ok_or_else(|| "a number is missing".to_owned())
    }

    fn word(&mut self) -> Said<&str> {
        let Some(Column::Text(cells)) = self.columns.next() else { return Err("a text is missing".to_owned()) };
        let text = cells.take(self.at).map_or(Ok(""), ByteArray::as_utf8);
        text.map_err(|_| "a text is no UTF-8".to_owned())
    }

    fn text(&mut self) -> Said<String> {
        self.word().map(str::to_owned)
    }

    fn among<T: Copy>(&mut self, all: &[T], name: fn(T) -> &'static str) -> Said<T> {
        let word = self.word()?;
        let found = all.iter().copied().find(|one| name(*one) == word);
        found.ok_or_else(|| format!("\"{word}\" is neither a kind nor a severity"))
    }
}

fn open(path: &Path) -> Result<SerializedFileReader<File>> {
    let file = File::open(path).map_err(|source| Error::file(path, source))?;
    SerializedFileReader::new(file).map_err(|error| unreadable(path, &error))
}

/// What the library says, in one line.
pub(super) fn unreadable(path: &Path, error: &ParquetError) -> Error {
    Error::content(path, error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" "))
}
