//! Reads the conflicts of a log one by one, from CSV or Parquet.

use std::path::Path;

use super::csv::CsvLog;
use super::parquet::{PARQUET, ParquetLog};
use super::run::LoggedRun;
use crate::Result;
use crate::output::log::CONFLICTS;
use crate::output::schema::LoggedConflict;

/// The conflicts of one log folder, one by one, in the order of the file. Memory does not grow with their number.
#[derive(Debug)]
pub struct ConflictReader {
    file: LogFile,
    failed: bool,
}

/// The file that holds them.
#[derive(Debug)]
enum LogFile {
    Csv(Box<CsvLog>),
    Parquet(Box<ParquetLog>),
}

impl ConflictReader {
    /// Opens the `conflicts.csv` of a log folder, or else its `conflicts.parquet`. Ignores a last row that is cut short if
    /// the run was killed or is still going on.
    ///
    /// # Errors
    /// [`crate::Error::File`] where it cannot be read; [`crate::Error::Content`] where it is empty or cut short;
    /// [`crate::Error::Line`] where its first line lacks a column.
    pub fn open(folder: &Path) -> Result<Self> {
        let csv = folder.join(CONFLICTS);
        let parquet = folder.join(PARQUET);
        let is_csv = csv.exists() || !parquet.exists();
        let file = if is_csv {
            let has_no_result = || LoggedRun::read(folder).is_ok_and(|run| run.summary.steps == 0);
            LogFile::Csv(Box::new(CsvLog::open(&csv, has_no_result)?))
        } else {
            LogFile::Parquet(Box::new(ParquetLog::open(&parquet)?))
        };
        Ok(Self { file, failed: false })
    }

    /// Reads the snapshots as well, where the log has them.
    #[must_use]
    pub fn with_snapshots(mut self) -> Self {
        match &mut self.file {
            LogFile::Csv(log) => log.read_snapshots(),
            LogFile::Parquet(log) => log.read_snapshots(),
        }
        self
    }

    /// The columns of the file, without the labels of a sweep.
    pub fn columns(&self) -> Vec<String> {
        match &self.file {
            LogFile::Csv(log) => log.columns(),
            LogFile::Parquet(log) => log.columns(),
        }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        match &self.file {
            LogFile::Csv(log) => log.path(),
            LogFile::Parquet(log) => log.path(),
        }
    }
}

impl Iterator for ConflictReader {
    type Item = Result<LoggedConflict>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let read = match &mut self.file {
            LogFile::Csv(log) => log.read(),
            LogFile::Parquet(log) => log.read(),
        };
        self.failed = read.is_err();
        read.transpose()
    }
}
