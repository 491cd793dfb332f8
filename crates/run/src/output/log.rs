//! The log of a run: `conflicts.csv`, `series.csv` or `series.parquet` on request, `clips.jsonl.gz`,
//! `net_faults.csv` where there are any, `run.json`.
//!
//! Rows of a CSV file are written as conflicts close, those of a step in one call, so that a kill loses no conflict that had
//! closed. A kill during that call may cut the last row short (Linux then ends a write between two pages);
//! `closecall_analysis::logged` ignores that row. A crash of the machine loses at most what was written in the last
//! `SYNC_EVERY`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::clips::{CLIPS, ClipsFile};
use super::csv_file::CsvFile;
use super::net_faults_csv::{self, NET_FAULTS, NetFault};
use super::parquet_file::ParquetFile;
use super::record::RunRecord;
use super::schema::{COLUMNS, Column, Context, LoggedConflict};
use super::series;
use crate::options::RunOptions;
use crate::options::{SERIES_FILES, SeriesFormat};
use crate::util::output_file;
use crate::{Error, Result};
use closecall::events::{Clip, Conflict};
use closecall::options::measures::Measures;
use closecall::traffic::net::Net;
use closecall::traffic::roster::Roster;

/// The name of the conflicts' file.
pub const CONFLICTS: &str = "conflicts.csv";
/// The name of the conflicts' file in a sweep, and where a run was told so.
pub const PARQUET: &str = "conflicts.parquet";
/// The name of the file that records how the run was made.
pub const RUN: &str = "run.json";

/// How long rows may wait before they are forced to disk (docs/log.md). Each time takes 1.5 ms on an SSD.
const SYNC_EVERY: Duration = Duration::from_secs(5);

/// The columns of a log with these added measures.
fn columns(measures: Measures) -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(move |column| column.is_in(measures))
}

/// The files of the log in a folder.
pub fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    [CONFLICTS, PARQUET].into_iter().chain(SERIES_FILES).chain([CLIPS, NET_FAULTS, RUN]).map(|name| folder.join(name))
}

/// The log of one run.
#[derive(Debug)]
pub struct Log {
    folder: PathBuf,
    conflicts: CsvFile,
    series: Option<Series>,
    clips: ClipsFile,
    written: u64,
    /// When rows were last forced to disk.
    synced: Instant,
}

impl Log {
    /// Makes the folder if it does not exist, and in it the files that the options ask for, with their first lines.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written.
    pub fn create(folder: &Path, options: &RunOptions) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
        // An earlier run's files would be taken for this run's; what a link leads to is not its own.
        for path in files(folder).filter(|path| path.is_file() || path.is_symlink()) {
            fs::remove_file(&path).map_err(|source| Error::file(&path, source))?;
        }
        let measures = options.model.measures;
        let series = options.log.series_file().map(|name| Series::create(folder.join(name), options));
        Ok(Self {
            conflicts: CsvFile::create(folder.join(CONFLICTS), columns(measures).copied())?,
            series: series.transpose()?,
            clips: ClipsFile::new(folder.join(CLIPS)),
            folder: folder.to_owned(),
            written: 0,
            synced: Instant::now(),
        })
    }

    /// Appends conflicts that have closed, and their steps if the log has a series.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written, as on a full disk.
    pub(crate) fn append_conflicts(
        &mut self,
        conflicts: &[Conflict],
        net: Option<&Net>,
        roster: &Roster,
    ) -> Result<()> {
        for (number, conflict) in (self.written + 1..).zip(conflicts) {
            let logged = LoggedConflict::new(conflict, Context { number, net, roster });
            self.conflicts.write_row(&logged)?;
            if let Some(series) = &mut self.series {
                for step in &conflict.steps {
                    series.write_row(LoggedConflict::new(step, Context { number, net, roster }))?;
                }
            }
        }
        self.conflicts.flush()?;
        self.written += conflicts.len() as u64;
        self.series.as_mut().and_then(Series::csv).map_or(Ok(()), CsvFile::flush)
    }

    /// Appends clips that are whole.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written.
    pub(crate) fn append_clips(&mut self, clips: &[Clip]) -> Result<()> {
        clips.iter().try_for_each(|clip| self.clips.append(clip))
    }

    /// The number of its clips.
    pub fn clips(&self) -> u64 {
        self.clips.count()
    }

    /// The number of whole rows in `conflicts.csv`.
    pub fn rows(&self) -> u64 {
        self.written
    }

    /// Forces rows to disk if the last time was long ago.
    ///
    /// # Errors
    /// [`Error::File`] where the disk fails.
    pub(crate) fn sync_now_and_then(&mut self) -> Result<()> {
        if self.synced.elapsed() < SYNC_EVERY { Ok(()) } else { self.sync() }
    }

    /// Forces all rows to disk.
    ///
    /// # Errors
    /// [`Error::File`] where the disk fails.
    pub fn sync(&mut self) -> Result<()> {
        self.conflicts.sync()?;
        self.series.as_mut().and_then(Series::csv).map_or(Ok(()), CsvFile::sync)?;
        self.synced = Instant::now();
        Ok(())
    }

    /// Forces all rows to disk and completes the series and the clips: no more follow.
    ///
    /// # Errors
    /// [`Error::File`] or [`Error::Content`] that names what cannot be written.
    pub fn finish(&mut self) -> Result<()> {
        self.sync()?;
        self.clips.finish()?;
        match self.series.take() {
            Some(Series::Parquet(file)) => file.finish(),
            series => {
                self.series = series;
                Ok(())
            }
        }
    }

    /// Writes texts so that no spreadsheet runs them as formulas.
    pub(crate) fn set_csv_safe(&mut self) {
        self.conflicts.is_safe = true;
        self.series.iter_mut().filter_map(Series::csv).for_each(|table| table.is_safe = true);
    }

    /// The SHA-256 of `conflicts.csv`.
    pub fn digest(&self) -> String {
        self.conflicts.digest()
    }

    /// Writes `net_faults.csv`, unless there are none.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be written.
    pub(crate) fn write_net_faults(&self, faults: &[NetFault]) -> Result<()> {
        if faults.is_empty() { Ok(()) } else { net_faults_csv::write(&self.folder, faults, self.conflicts.is_safe) }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Writes `run.json`, whole or not at all.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be written.
    pub fn write_record(&self, record: &RunRecord) -> Result<()> {
        let path = self.folder.join(RUN);
        let text = serde_json::to_string_pretty(record).map_err(|error| Error::content(&path, error.to_string()))?;
        output_file::write(&path, (text + "\n").as_bytes())
    }

    /// Removes what was written: the input could not be used after all.
    pub fn discard(mut self) {
        // A file that cannot be removed stays: the error to report is the one that led here.
        for table in [Some(&mut self.conflicts), self.series.as_mut().and_then(Series::csv)].into_iter().flatten() {
            let _ = fs::remove_file(&table.path);
        }
        let _ = fs::remove_file(self.folder.join(RUN));
    }
}

/// The file with each step of each conflict.
#[derive(Debug)]
enum Series {
    Csv(Box<CsvFile>),
    Parquet(Box<ParquetFile>),
}

impl Series {
    fn create(path: PathBuf, options: &RunOptions) -> Result<Self> {
        let columns = series::columns(options.model.measures);
        match options.log.log_series {
            Some(SeriesFormat::Parquet) => ParquetFile::create(&path, columns).map(Box::new).map(Self::Parquet),
            Some(SeriesFormat::Csv) | None => CsvFile::create(path, columns).map(Box::new).map(Self::Csv),
        }
    }

    fn write_row(&mut self, row: LoggedConflict) -> Result<()> {
        match self {
            Self::Csv(file) => file.write_row(&row),
            Self::Parquet(file) => file.write_row(row),
        }
    }

    fn csv(&mut self) -> Option<&mut CsvFile> {
        match self {
            Self::Csv(file) => Some(file),
            Self::Parquet(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::options::LogOptions;
    use crate::output::log::*;

    #[cfg(unix)]
    #[test]
    fn a_log_is_never_written_through_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let mine = folder.path().join("mine");
        for is_there in [true, false] {
            let log = folder.path().join(format!("log-{is_there}"));
            fs::create_dir(&log).unwrap();
            files(&log).for_each(|file| std::os::unix::fs::symlink(&mine, file).unwrap());
            if is_there {
                fs::write(&mine, "mine").unwrap();
            }
            let options = RunOptions {
                log: LogOptions { log_series: Some(SeriesFormat::Csv), ..LogOptions::default() },
                ..RunOptions::default()
            };
            let created = Log::create(&log, &options).unwrap();
            created.write_record(&RunRecord::new(PathBuf::new(), options)).unwrap();
            assert_eq!(fs::read_to_string(&mine).ok().as_deref(), is_there.then_some("mine"));
            let _ = fs::remove_file(&mine);
        }
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let message = Log::create(Path::new("/proc/closecall"), &RunOptions::default()).unwrap_err().to_string();
        assert!(message.starts_with("/proc/closecall: "), "{message}");
    }
}
