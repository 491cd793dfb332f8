//! The rows of a `conflicts.parquet`, batch by batch: a sweep writes one file per run, with its `run.json` inside.

use std::fs::File;
use std::ops::Range;
use std::path::{Path, PathBuf};

use parquet::file::reader::{FileReader, SerializedFileReader};

use super::group_column::GroupColumn;
use super::packed::{is_as_written, open};
use super::plausible::PlausibleRows;
use crate::{Error, Result};
use closecall_run::output::parquet_columns::physical;
use closecall_run::output::schema::{COLUMNS, Column, ColumnType, LoggedConflict, Presence, Value};
use closecall_run::util::parquet_column::guarded;

/// Rows in memory at once: few, so that all of their columns stay in a core's cache.
const BATCH: usize = 256;

/// The rows of a `conflicts.parquet`; memory is that of one batch and of the pages that it is in.
pub(crate) struct ParquetLog {
    path: PathBuf,
    file: SerializedFileReader<File>,
    /// Where in the file each of the [`COLUMNS`] is; none where the file lacks it.
    places: [Option<usize>; COLUMNS.len()],
    /// Which of the [`COLUMNS`] are read with each batch.
    wanted: [bool; COLUMNS.len()],
    next_group: usize,
    /// Each of the [`COLUMNS`] in the group; none where the file lacks it.
    columns: Vec<Option<GroupColumn>>,
    /// The numbers of those that the file has and that are wanted.
    read: Vec<usize>,
    /// Rows of the group.
    group: usize,
    /// The batch: rows of the group.
    batch: Range<usize>,
    /// The row of the group that is returned next.
    next: usize,
    /// How many rows were returned in all.
    rows: u64,
    plausible: PlausibleRows,
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
            read: Vec::new(),
            group: 0,
            batch: 0..0,
            next: 0,
            rows: 0,
            plausible: PlausibleRows::default(),
            is_as_written: is_as_written(path, &file)?,
            file,
        })
    }

    /// Reads the snapshots as well, where the file has them.
    pub(crate) fn read_snapshots(&mut self) {
        self.wanted = [true; COLUMNS.len()];
    }

    /// Reads these columns alone, if the file is known to be as it was written: its rows were checked then.
    pub(crate) fn read_only(&mut self, columns: &[&str]) {
        if self.is_as_written == Some(true) {
            self.wanted = COLUMNS.map(|column| columns.contains(&column.name));
        }
    }

    /// Whether columns are left out that are not snapshots.
    pub(crate) fn reads_only_some(&self) -> bool {
        COLUMNS.iter().zip(self.wanted).any(|(column, is_wanted)| !is_wanted && column.presence != Presence::Snapshot)
    }

    /// Whether the file is not as its run wrote it.
    pub(crate) fn is_changed(&self) -> bool {
        self.is_as_written == Some(false)
    }

    /// Demands that the margins are below 0, as a run logs them unless its options say otherwise.
    pub(crate) fn demand_margins_below_zero(&mut self) {
        self.plausible.margins_below_zero = true;
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
    pub(crate) fn read_into(&mut self, row: &mut Option<LoggedConflict>) -> Result<bool> {
        if !self.advance()? {
            return Ok(false);
        }
        let conflict = match row {
            Some(conflict) => {
                let place = self.next - 1 - self.batch.start;
                for &number in &self.read {
                    let (column, Some(read)) = (&COLUMNS[number], &self.columns[number]) else { continue };
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
        self.plausible.check(conflict).map_err(|message| self.unfit(&message))
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
        self.read = (0..COLUMNS.len()).filter(|&number| self.wanted[number] && self.places[number].is_some()).collect();
        let rows = self.file.metadata().row_group(self.next_group).num_rows();
        (self.group, self.batch, self.next) = (usize::try_from(rows).unwrap_or_default(), 0..0, 0);
        self.next_group += 1;
        Ok(true)
    }

    /// Reads the wanted columns of the batch.
    fn read_batch(&mut self, wanted: [bool; COLUMNS.len()]) -> Result<()> {
        let read = guarded(&self.path, || {
            let group = self.file.get_row_group(self.next_group - 1)?;
            let columns = self.columns.iter_mut().zip(wanted).filter(|(_, is_wanted)| *is_wanted);
            columns.filter_map(|(column, _)| column.as_mut()).try_for_each(|column| column.read(&*group, &self.batch))
        });
        Ok(read?)
    }
}

/// A row's value in a column that is not read.
fn unread(column: &Column) -> Value<'static> {
    match (column.presence, column.column_type) {
        (Presence::Required, ColumnType::Number) => Value::Number(f64::NAN),
        (Presence::Required, ColumnType::Count) => Value::Count(0),
        (Presence::Required, ColumnType::Flag) => Value::Flag(false),
        _ => Value::Missing,
    }
}
