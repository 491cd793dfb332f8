//! `conflicts.parquet`, batch by batch: a sweep writes one file per run, with its `run.json` inside.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use parquet::basic::Type as Physical;
use parquet::column::reader::ColumnReader;
use parquet::data_type::{BoolType, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use serde::{Deserialize, Serialize};

use super::possible::PossibleRows;
use crate::output::input_hash::Hasher;
use crate::output::parquet_columns::physical;
use crate::output::schema::{COLUMNS, Column, ColumnType, LoggedConflict, Presence, Value};
use crate::util::input_file;
use crate::util::parquet_column::{self, Batch, guarded};
use crate::util::units::Second;
use crate::{Error, Result};

/// The key of the text of `run.json` in the file's metadata.
pub(super) const RECORD_KEY: &str = "closecall.run.json";
/// The key of the fingerprint in the file's metadata.
pub(super) const FINGERPRINT_KEY: &str = "closecall.fingerprint";
/// The key of the run time in the file's metadata.
pub(super) const RUN_TIME_KEY: &str = "closecall.run_time";
/// The key of the [`digest`] in the file's metadata; files of earlier versions have none.
pub(super) const DIGEST_KEY: &str = "closecall.digest";

/// How many bytes the rows take, and the SHA-256 of these and of the texts of the metadata: pages have no checksums of
/// their own.
pub(super) fn digest(bytes: usize, mut rows: Hasher, metadata: [&str; 3]) -> String {
    metadata.iter().for_each(|text| rows.add(text));
    format!("{bytes} {}", rows.digits())
}

/// Whether the file is as it was written; none where it does not tell.
fn is_as_written(path: &Path, file: &SerializedFileReader<File>) -> Result<Option<bool>> {
    let Some(known) = value(file, DIGEST_KEY) else { return Ok(None) };
    let bytes = known.split(' ').next().and_then(|bytes| bytes.parse::<u64>().ok()).unwrap_or_default();
    let mut rows = Hasher::default();
    let copied = std::io::copy(&mut input_file::file(path)?.take(bytes), &mut rows);
    copied.map_err(|source| Error::file(path, source))?;
    let metadata = [RECORD_KEY, FINGERPRINT_KEY, RUN_TIME_KEY].map(|key| value(file, key).unwrap_or_default());
    Ok(Some(digest(bytes as usize, rows, metadata.each_ref().map(String::as_str)) == known))
}

/// The value of a key in the file's metadata.
fn value(file: &SerializedFileReader<File>, key: &str) -> Option<String> {
    let pairs = file.metadata().file_metadata().key_value_metadata().into_iter().flatten();
    pairs.filter(|pair| pair.key == key).find_map(|pair| pair.value.clone())
}

/// Rows in memory at once: few, so that all of their columns stay in a core's cache.
const BATCH: usize = 256;

/// What a `conflicts.parquet` holds besides its rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// The text of `run.json`.
    pub record: String,
    /// The hash of what the run was asked for.
    pub fingerprint: String,
    /// The labels of the run, each with whether it is a number.
    pub labels: Vec<(String, bool)>,
    /// What the run took; files of earlier versions do not have it.
    pub run_time: Option<RunTime>,
}

/// What a run took, as the process that it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunTime {
    /// From its start to its end.
    pub wall: Second,
    /// Of all processors together.
    pub cpu: Second,
}

impl Packed {
    /// The text of `run.json` that a `conflicts.parquet` holds.
    ///
    /// # Errors
    /// As [`Packed::of`].
    pub fn record_of(path: &Path) -> Result<String> {
        Ok(Self::of(path)?.record)
    }

    /// Reads the metadata of a `conflicts.parquet`.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read; [`Error::Content`] where no sweep has written it.
    pub fn of(path: &Path) -> Result<Self> {
        let file = open(path)?;
        let metadata = file.metadata().file_metadata();
        let value = |key: &str| {
            value(&file, key)
                .ok_or_else(|| Error::content(path, format!("it is not a file of closecall sweep: {key} is missing")))
        };
        let columns = metadata.schema_descr().columns().iter();
        let labels = columns.filter(|column| Column::named(column.name()).is_none());
        Ok(Self {
            record: value(RECORD_KEY)?,
            fingerprint: value(FINGERPRINT_KEY)?,
            labels: labels
                .map(|column| (column.name().to_owned(), column.physical_type() != Physical::BYTE_ARRAY))
                .collect(),
            run_time: self::value(&file, RUN_TIME_KEY).and_then(|text| serde_json::from_str(&text).ok()),
        })
    }
}

/// The rows of a `conflicts.parquet`; memory is that of one batch and of the pages that it is in.
pub struct ParquetLog {
    path: PathBuf,
    file: SerializedFileReader<File>,
    /// Where in the file each of the [`COLUMNS`] is; none where the file lacks it.
    places: [Option<usize>; COLUMNS.len()],
    /// Which of the [`COLUMNS`] are read with each batch.
    wanted: [bool; COLUMNS.len()],
    next_group: usize,
    /// Each of the [`COLUMNS`] in the group; none where the file lacks it.
    columns: Vec<Option<GroupColumn>>,
    /// Rows of the group.
    group: usize,
    /// The batch: rows of the group.
    batch: Range<usize>,
    /// The row of the group that is returned next.
    next: usize,
    /// How many rows were returned in all.
    rows: u64,
    possible: PossibleRows,
    /// Whether the file is as it was written; none where it does not tell.
    is_as_written: Option<bool>,
}

impl std::fmt::Debug for ParquetLog {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("ParquetLog").field("path", &self.path).finish_non_exhaustive()
    }
}

impl ParquetLog {
    /// Opens the file and checks its columns.
    pub fn open(path: &Path) -> Result<Self> {
        let file = open(path)?;
        let columns = file.metadata().file_metadata().schema_descr().columns();
        let places = COLUMNS.map(|column| columns.iter().position(|known| column.is_named(known.name())));
        for (column, place) in COLUMNS.iter().zip(places) {
            let wrong = match place {
                Some(place) if columns[place].physical_type() == physical(column.column_type) => continue,
                Some(_) => "has another type than that of a log",
                None if column.presence == Presence::Required => "is missing",
                None => continue,
            };
            return Err(Error::content(path, format!("the column \"{}\" {wrong}", column.name)));
        }
        Ok(Self {
            path: path.to_owned(),
            places,
            wanted: COLUMNS.map(|column| column.presence != Presence::Snapshot),
            next_group: 0,
            columns: Vec::new(),
            group: 0,
            batch: 0..0,
            next: 0,
            rows: 0,
            possible: PossibleRows::default(),
            is_as_written: is_as_written(path, &file)?,
            file,
        })
    }

    /// Reads the snapshots as well, where the file has them.
    pub fn read_snapshots(&mut self) {
        self.wanted = [true; COLUMNS.len()];
    }

    /// Reads these columns alone, if the file is known to be as it was written: its rows were checked then.
    pub fn read_only(&mut self, columns: &[&str]) {
        if self.is_as_written == Some(true) {
            self.wanted = COLUMNS.map(|column| columns.contains(&column.name));
        }
    }

    /// Whether the file is not as its run wrote it.
    pub fn is_changed(&self) -> bool {
        self.is_as_written == Some(false)
    }

    /// Demands that the margins are below 0, as a run logs them unless its options say otherwise.
    pub fn demand_margins_below_zero(&mut self) {
        self.possible.margins_below_zero = true;
    }

    /// The columns, without the labels of a sweep.
    pub fn columns(&self) -> Vec<String> {
        let there = COLUMNS.iter().zip(&self.places).filter(|(_, place)| place.is_some());
        there.map(|(column, _)| column.name.to_owned()).collect()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next conflict; none after the last.
    pub fn read(&mut self) -> Result<Option<LoggedConflict>> {
        if !self.advance()? {
            return Ok(None);
        }
        let conflict = self.row(self.wanted)?;
        self.check(&conflict)?;
        Ok(Some(conflict))
    }

    /// Puts the next conflict into `row`; false after the last. Faster than [`read`](Self::read) where few columns are read,
    /// as the others of the row stay.
    pub fn read_into(&mut self, row: &mut Option<LoggedConflict>) -> Result<bool> {
        if !self.advance()? {
            return Ok(false);
        }
        let conflict = match row {
            Some(conflict) => {
                let place = self.next - 1 - self.batch.start;
                for ((column, read), is_wanted) in COLUMNS.iter().zip(&self.columns).zip(self.wanted) {
                    let Some(read) = read.as_ref().filter(|_| is_wanted) else { continue };
                    let set = read.value(place).and_then(|value| (column.set)(conflict, value));
                    set.map_err(|why| self.unfit(&format!("{}: {why}", column.name)))?;
                }
                conflict
            }
            none => none.insert(self.row(self.wanted)?),
        };
        self.check(conflict)?;
        Ok(true)
    }

    /// Goes on to the next row; false after the last.
    fn advance(&mut self) -> Result<bool> {
        while self.next == self.batch.end {
            if self.batch.end == self.group && !self.open_group()? {
                return Ok(false);
            }
            self.batch = self.batch.end..self.group.min(self.batch.end + BATCH);
            self.read_batch(self.wanted)?;
        }
        self.next += 1;
        self.rows += 1;
        Ok(true)
    }

    /// Checks that a run can have written the row, unless it was checked when the file was written.
    fn check(&mut self, conflict: &LoggedConflict) -> Result<()> {
        if self.is_as_written == Some(true) {
            return Ok(());
        }
        self.possible.check(conflict).map_err(|message| self.unfit(&message))
    }

    /// The conflict that was read last, with all columns but the snapshots.
    pub fn whole(&mut self) -> Result<LoggedConflict> {
        let all = COLUMNS.map(|column| column.presence != Presence::Snapshot);
        self.read_batch(all)?;
        self.row(all)
    }

    /// The conflict that was read last, with the columns that are wanted.
    fn row(&self, wanted: [bool; COLUMNS.len()]) -> Result<LoggedConflict> {
        let row = self.next - 1 - self.batch.start;
        let cell = |column: usize| match &self.columns[column] {
            Some(read) if wanted[column] => read.value(row),
            _ => Ok(unread(&COLUMNS[column])),
        };
        LoggedConflict::from_cells(cell).map_err(|message| self.unfit(&message))
    }

    /// The error that the row that was read last is not one of a log.
    fn unfit(&self, message: &str) -> Error {
        Error::content(&self.path, format!("row {}: {message}", self.rows))
    }

    /// Begins the next row group; whether there is one.
    fn open_group(&mut self) -> Result<bool> {
        if self.next_group == self.file.num_row_groups() {
            return Ok(false);
        }
        self.columns = self.places.map(|place| place.map(GroupColumn::new)).into();
        let rows = self.file.metadata().row_group(self.next_group).num_rows();
        (self.group, self.batch, self.next) = (usize::try_from(rows).unwrap_or_default(), 0..0, 0);
        self.next_group += 1;
        Ok(true)
    }

    /// Reads the wanted columns of the batch.
    fn read_batch(&mut self, wanted: [bool; COLUMNS.len()]) -> Result<()> {
        guarded(&self.path, || {
            let group = self.file.get_row_group(self.next_group - 1)?;
            let columns = self.columns.iter_mut().zip(wanted).filter(|(_, is_wanted)| *is_wanted);
            columns.filter_map(|(column, _)| column.as_mut()).try_for_each(|column| column.read(&*group, &self.batch))
        })
    }
}

/// What stands in a row for a column that is not read.
fn unread(column: &Column) -> Value<'static> {
    match (column.presence, column.column_type) {
        (Presence::Required, ColumnType::Number) => Value::Number(f64::NAN),
        (Presence::Required, ColumnType::Count) => Value::Count(0),
        (Presence::Required, ColumnType::Flag) => Value::Flag(false),
        _ => Value::Missing,
    }
}

/// A column of a row group.
struct GroupColumn {
    place: usize,
    /// What was read last; none before its first rows.
    batch: Option<ColumnBatch>,
    /// Rows of the group that were read or passed over.
    rows: usize,
}

impl GroupColumn {
    fn new(place: usize) -> Self {
        Self { place, batch: None, rows: 0 }
    }

    /// Reads these rows of the group, unless they are those that were read last.
    fn read(&mut self, group: &dyn RowGroupReader, rows: &Range<usize>) -> std::result::Result<(), ParquetError> {
        let batch = match &mut self.batch {
            Some(batch) => batch,
            none => none.insert(ColumnBatch::new(group.get_column_reader(self.place)?)?),
        };
        if self.rows == rows.end {
            return Ok(());
        }
        let (before, wanted) = (rows.start - self.rows, rows.len());
        self.rows = rows.end;
        if batch.skip(before)? != before || batch.read(wanted)? != wanted {
            return Err(ParquetError::General("its columns differ in length".to_owned()));
        }
        Ok(())
    }

    /// The value in a row of the batch.
    fn value(&self, row: usize) -> std::result::Result<Value<'_>, String> {
        self.batch.as_ref().map_or(Ok(Value::Missing), |batch| batch.value(row))
    }
}

/// The reader of a column, and its values in the batch.
enum ColumnBatch {
    Count(Batch<Int64Type>),
    Text(Batch<ByteArrayType>),
    Number(Batch<DoubleType>),
    Flag(Batch<BoolType>),
}

impl ColumnBatch {
    fn new(reader: ColumnReader) -> std::result::Result<Self, ParquetError> {
        Ok(match reader {
            ColumnReader::Int64ColumnReader(reader) => Self::Count(Batch::new(reader)),
            ColumnReader::ByteArrayColumnReader(reader) => Self::Text(Batch::new(reader)),
            ColumnReader::DoubleColumnReader(reader) => Self::Number(Batch::new(reader)),
            ColumnReader::BoolColumnReader(reader) => Self::Flag(Batch::new(reader)),
            _ => return Err(ParquetError::General("a column has another type than that of a log".to_owned())),
        })
    }

    fn skip(&mut self, rows: usize) -> std::result::Result<usize, ParquetError> {
        match self {
            Self::Count(batch) => batch.skip(rows),
            Self::Text(batch) => batch.skip(rows),
            Self::Number(batch) => batch.skip(rows),
            Self::Flag(batch) => batch.skip(rows),
        }
    }

    fn read(&mut self, rows: usize) -> std::result::Result<usize, ParquetError> {
        match self {
            Self::Count(batch) => batch.read(rows),
            Self::Text(batch) => batch.read(rows),
            Self::Number(batch) => batch.read(rows),
            Self::Flag(batch) => batch.read(rows),
        }
    }

    /// The value in a row of the batch.
    fn value(&self, row: usize) -> std::result::Result<Value<'_>, String> {
        let value = match self {
            Self::Count(batch) => batch
                .get(row)
                .map(|&count| u64::try_from(count).map(Value::Count).map_err(|_| format!("{count} is below 0"))),
            Self::Text(batch) => {
                batch.get(row).map(|text| text.as_utf8().map(Value::Text).map_err(|_| "it is not UTF-8".to_owned()))
            }
            Self::Number(batch) => batch.get(row).map(|&number| Value::finite(number)),
            Self::Flag(batch) => batch.get(row).map(|&flag| Ok(Value::Flag(flag))),
        };
        value.unwrap_or(Ok(Value::Missing))
    }
}

fn open(path: &Path) -> Result<SerializedFileReader<File>> {
    let file = input_file::file(path)?;
    parquet_column::open(path, file)
}
