//! Reads the conflicts of a log one by one, from CSV or Parquet.

use std::path::{Path, PathBuf};

use super::csv::CsvLog;
use super::folders::PARQUET;
use super::parquet::ParquetLog;
use super::run::LoggedRun;
use crate::output::log::CONFLICTS;
use crate::output::schema::LoggedConflict;
use crate::{Error, Result};

/// The conflicts of one log folder, one by one, in the order of the file. Memory does not grow with their number.
#[derive(Debug)]
pub struct ConflictReader {
    file: LogFile,
    read: u64,
    /// How many conflicts the run counted.
    counted: Option<u64>,
    failed: bool,
}

/// A file that has not the rows that its run counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostRows {
    /// The file.
    pub file: PathBuf,
    /// The rows that it has.
    pub read: u64,
    /// The rows that its run counted.
    pub counted: u64,
}

impl std::fmt::Display for LostRows {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let Self { file, read, counted } = self;
        write!(f, "{}: it has {read} rows, but its run counted {counted} conflicts", file.display())
    }
}

/// Nothing where no rows are lost.
///
/// # Errors
/// [`Error::Lost`] that names the first file and how many others there are.
pub fn check_none_lost(lost: &[LostRows]) -> Result<()> {
    let others = match lost.len() {
        0 => return Ok(()),
        1 => String::new(),
        all => format!(" (and so have {} other logs)", all - 1),
    };
    Err(Error::Lost(format!("{}{others}", lost[0])))
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
        let run = LoggedRun::read(folder).ok();
        let has_result = run.as_ref().is_none_or(|run| run.summary.steps > 0);
        let mut file = if is_csv {
            LogFile::Csv(Box::new(CsvLog::open(&csv, !has_result)?))
        } else {
            LogFile::Parquet(Box::new(ParquetLog::open(&parquet)?))
        };
        if run.as_ref().is_some_and(LoggedRun::logs_margins_below_zero) {
            match &mut file {
                LogFile::Csv(log) => log.demand_margins_below_zero(),
                LogFile::Parquet(log) => log.demand_margins_below_zero(),
            }
        }
        let counted = run.filter(|_| has_result).map(|run| run.conflicts());
        Ok(Self { file, read: 0, counted, failed: false })
    }

    /// Whether rows are gone, once all were read: how many, and how many the run counted; none where all are there, and
    /// where the run was killed before it counted them.
    pub fn lost(&self) -> Option<LostRows> {
        let counted = self.counted.filter(|counted| *counted != self.read)?;
        Some(LostRows { file: self.path().to_owned(), read: self.read, counted })
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
        self.read += u64::from(matches!(read, Ok(Some(_))));
        read.transpose()
    }
}
