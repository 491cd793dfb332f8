//! Reads the conflicts of a log one by one, from CSV or Parquet.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::conflicts_csv::CsvLog;
use super::folders::PARQUET;
use super::parquet::ParquetLog;
use super::run::LoggedRun;
use crate::{Error, Result};
use closecall_run::output::log::CONFLICTS;
use closecall_run::output::schema::{COLUMNS, Column, LoggedConflict, Presence};

/// The conflicts of one log folder, one by one, in the order of the file. Memory does not grow with their number.
#[derive(Debug)]
pub struct ConflictReader {
    file: LogFile,
    read: u64,
    /// How many conflicts the run counted.
    counted: Option<u64>,
    /// The SHA-256 of what the run wrote.
    digest: Option<String>,
    failed: bool,
    /// The conflict that [`ConflictReader::next_row`] returned last.
    row: Option<LoggedConflict>,
}

/// A file that has not the rows that its run wrote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LostRows {
    /// The file.
    pub file: PathBuf,
    /// What its rows are instead.
    pub why: Lost,
}

/// What is wrong with the rows of a file as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// There are more or fewer of them.
    Rows {
        /// The rows that it has.
        read: u64,
        /// The rows that its run counted.
        counted: u64,
    },
    /// Their bytes are others.
    Changed,
}

impl std::fmt::Display for LostRows {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let file = self.file.display();
        match self.why {
            Lost::Rows { read, counted } => {
                write!(f, "{file}: it has {read} rows, but its run counted {counted} conflicts")
            }
            Lost::Changed => write!(f, "{file}: it was changed since its run wrote it (its SHA-256 differs)"),
        }
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
    /// [`closecall_run::Error::File`] where it cannot be read; [`closecall_run::Error::Content`] where it is empty or cut short;
    /// [`closecall_run::Error::Line`] where its first line lacks a column.
    pub fn open(folder: &Path) -> Result<Self> {
        match LoggedRun::read(folder) {
            Ok(run) => Self::of(folder, Some(&run)),
            Err(Error::Run(closecall_run::Error::File { path, source })) if source.kind() != ErrorKind::NotFound => {
                Err(Error::file(&path, source))
            }
            Err(_) => Self::of(folder, None),
        }
    }

    /// The same, with the record of the run if it can be read.
    pub(crate) fn of(folder: &Path, run: Option<&LoggedRun>) -> Result<Self> {
        let csv = folder.join(CONFLICTS);
        let parquet = folder.join(PARQUET);
        let is_csv = csv.exists() || !parquet.exists();
        let has_result = run.is_none_or(|run| run.summary.steps > 0);
        let mut file = if is_csv {
            LogFile::Csv(Box::new(CsvLog::open(&csv, !has_result)?))
        } else {
            LogFile::Parquet(Box::new(ParquetLog::open(&parquet)?))
        };
        if run.is_some_and(LoggedRun::logs_margins_below_zero) {
            match &mut file {
                LogFile::Csv(log) => log.demand_margins_below_zero(),
                LogFile::Parquet(log) => log.demand_margins_below_zero(),
            }
        }
        if let (LogFile::Csv(log), true) = (&mut file, run.is_some_and(|run| run.csv_safe)) {
            log.undo_csv_safe();
        }
        let run = run.filter(|_| has_result);
        let counted = run.map(LoggedRun::conflicts);
        let digest = run.and_then(|run| run.conflicts_sha256.clone());
        Ok(Self { file, read: 0, counted, digest, failed: false, row: None })
    }

    /// What is wrong with the rows as a whole, once all were read; none where they are those that the run wrote, and where
    /// the run was killed before it counted them.
    pub fn lost(&self) -> Option<LostRows> {
        let file = self.path().to_owned();
        if let Some(counted) = self.counted.filter(|counted| *counted != self.read) {
            return Some(LostRows { file, why: Lost::Rows { read: self.read, counted } });
        }
        let is_another = match (&self.file, &self.digest) {
            (LogFile::Csv(log), Some(digest)) => log.digest() != *digest,
            (LogFile::Csv(_), None) => false,
            (LogFile::Parquet(log), _) => log.is_changed(),
        };
        is_another.then_some(LostRows { file, why: Lost::Changed })
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

    /// Reads these columns alone where that is enough: in a Parquet file that is known to be as it was written. The others of
    /// a row are missing then, or not a number.
    #[must_use]
    pub fn only(mut self, columns: &[&str]) -> Self {
        if let LogFile::Parquet(log) = &mut self.file {
            log.read_only(columns);
        }
        self
    }

    /// Whether each row has all columns but the snapshots.
    pub(crate) fn reads_whole_rows(&self) -> bool {
        match &self.file {
            LogFile::Csv(_) => true,
            LogFile::Parquet(log) => !log.reads_only_some(),
        }
    }

    /// The next conflict, in the memory of the last one; none after the last.
    ///
    /// # Errors
    /// As those of the iterator.
    pub(crate) fn next_row(&mut self) -> Result<Option<&LoggedConflict>> {
        let is_there = match &mut self.file {
            LogFile::Csv(log) => {
                self.row = log.read()?;
                self.row.is_some()
            }
            LogFile::Parquet(log) => log.read_into(&mut self.row)?,
        };
        self.read += u64::from(is_there);
        Ok(self.row.as_ref().filter(|_| is_there))
    }

    /// The conflict that [`next_row`](Self::next_row) returned last, with all columns but the snapshots.
    ///
    /// # Errors
    /// As those of the iterator.
    pub(crate) fn whole_row(&mut self) -> Result<Option<LoggedConflict>> {
        match &mut self.file {
            LogFile::Csv(_) => Ok(self.row.clone()),
            LogFile::Parquet(log) => log.whole().map(Some),
        }
    }

    /// The columns of the file, without the labels of a sweep.
    pub fn columns(&self) -> Vec<String> {
        match &self.file {
            LogFile::Csv(log) => log.columns(),
            LogFile::Parquet(log) => log.columns(),
        }
    }

    /// The columns of the schema without those that its run was not told to add.
    pub fn columns_of_schema(&self) -> Vec<&'static Column> {
        let logged = self.columns();
        let is_there =
            |column: &&Column| column.presence != Presence::Chosen || logged.iter().any(|name| name == column.name);
        COLUMNS.iter().filter(is_there).collect()
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
