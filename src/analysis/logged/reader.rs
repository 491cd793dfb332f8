//! Reads the conflicts of a log one by one, whatever file they are in.

use std::path::Path;

use super::conflicts::LoggedConflict;
use super::csv::CsvRows;
use super::parquet::{PARQUET, ParquetRows};
use super::run::LoggedRun;
use crate::Result;
use crate::output::log::CONFLICTS;

/// The conflicts of one log folder, one by one, in the order of the file; memory is bounded however many there are.
#[derive(Debug)]
pub struct ConflictReader {
    rows: Rows,
    failed: bool,
}

/// What the folder holds.
#[derive(Debug)]
enum Rows {
    Csv(Box<CsvRows>),
    Parquet(Box<ParquetRows>),
}

impl ConflictReader {
    /// Opens the `conflicts.csv` of a log folder, or its `conflicts.parquet` where there is no other. Of a run that was
    /// killed, or goes on, a last row that is half is left out.
    ///
    /// # Errors
    /// [`crate::Error::File`] where it cannot be read; [`crate::Error::Content`] where it is empty or cut short;
    /// [`crate::Error::Line`] where its first line is not that of a log.
    pub fn open(folder: &Path) -> Result<Self> {
        let (csv, parquet) = (folder.join(CONFLICTS), folder.join(PARQUET));
        let is_csv = csv.exists() || !parquet.exists();
        let rows = if is_csv {
            let has_no_result = || LoggedRun::read(folder).is_ok_and(|run| run.summary.steps == 0);
            Rows::Csv(Box::new(CsvRows::open(&csv, has_no_result)?))
        } else {
            Rows::Parquet(Box::new(ParquetRows::open(&parquet)?))
        };
        Ok(Self { rows, failed: false })
    }

    /// Reads the snapshots too, where the log has them.
    #[must_use]
    pub fn with_snapshots(mut self) -> Self {
        match &mut self.rows {
            Rows::Csv(rows) => rows.read_snapshots(),
            Rows::Parquet(rows) => rows.read_snapshots(),
        }
        self
    }

    /// The columns of the file, without those that tell the runs of a sweep apart.
    pub fn columns(&self) -> Vec<String> {
        match &self.rows {
            Rows::Csv(rows) => rows.columns(),
            Rows::Parquet(rows) => rows.columns(),
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        match &self.rows {
            Rows::Csv(rows) => rows.path(),
            Rows::Parquet(rows) => rows.path(),
        }
    }
}

impl Iterator for ConflictReader {
    type Item = Result<LoggedConflict>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let read = match &mut self.rows {
            Rows::Csv(rows) => rows.read(),
            Rows::Parquet(rows) => rows.read(),
        };
        self.failed = read.is_err();
        read.transpose()
    }
}
