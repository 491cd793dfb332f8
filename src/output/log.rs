//! The log of a run: `conflicts.csv`, `series.csv` on request, `run.json`.
//!
//! Rows are written as conflicts close, those of a step in one call, so that a kill loses no conflict that had closed. A
//! kill during that call may cut the last row short (Linux then ends a write between two pages);
//! [`crate::analysis::logged`] ignores that row.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::input_hash::Hasher;
use super::record::RunRecord;
use super::schema::{COLUMNS, Column, Context, LoggedConflict, Value};
use super::series;
use crate::events::Conflict;
use crate::options::measures::Measures;
use crate::options::{ENCOUNTERS, Options, SERIES};
use crate::traffic::net::Net;
use crate::traffic::roster::Roster;
use crate::util::csv_safe::safe;
use crate::{Error, Result};

/// The name of the conflicts' file.
pub const CONFLICTS: &str = "conflicts.csv";
/// The name of the file that records how the run was made.
pub const RUN: &str = "run.json";

/// The columns of a log with these added measures.
fn columns(measures: Measures) -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(move |column| column.is_in(measures))
}

/// The files of the log in a folder.
pub(crate) fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    [CONFLICTS, SERIES, ENCOUNTERS, RUN].into_iter().map(|name| folder.join(name))
}

/// The log of one run.
#[derive(Debug)]
pub struct Log {
    folder: PathBuf,
    made_folder: bool,
    conflicts: CsvFile,
    series: Option<CsvFile>,
    measures: Measures,
    written: u64,
}

impl Log {
    /// Makes the folder if it does not exist, and in it the files that the options ask for, with their first lines.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written.
    pub fn create(folder: &Path, options: &Options) -> Result<Self> {
        let made_folder = !folder.exists();
        fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
        // An earlier run's files would be taken for this run's.
        for name in [RUN, SERIES, ENCOUNTERS] {
            let path = folder.join(name);
            if path.is_file() {
                fs::remove_file(&path).map_err(|source| Error::file(&path, source))?;
            }
        }
        let measures = options.measures;
        let series = options.series_file().map(|name| CsvFile::create(folder.join(name), series::names(measures)));
        Ok(Self {
            conflicts: CsvFile::create(folder.join(CONFLICTS), columns(measures).map(|column| column.name))?,
            series: series.transpose()?,
            measures,
            folder: folder.to_owned(),
            made_folder,
            written: 0,
        })
    }

    /// Appends conflicts that have closed, and their steps if the log has a series.
    ///
    /// # Errors
    /// [`Error::File`] where the file cannot be written, as on a full disk.
    pub fn append_conflicts(&mut self, conflicts: &[Conflict], net: Option<&Net>, roster: &Roster) -> Result<()> {
        for conflict in conflicts {
            self.written += 1;
            let logged = LoggedConflict::new(conflict, Context { number: self.written, net, roster });
            self.conflicts.write_row(columns(self.measures).map(|column| (column.get)(&logged)))?;
            if let Some(series) = &mut self.series {
                for step in &conflict.steps {
                    let logged = LoggedConflict::new(step, Context { number: self.written, net, roster });
                    series.write_row(series::values(&logged, self.measures))?;
                }
            }
        }
        self.series.as_mut().map_or(Ok(()), CsvFile::flush)?;
        self.conflicts.flush()
    }

    /// Writes texts so that no spreadsheet runs them as formulas.
    pub fn set_csv_safe(&mut self) {
        self.conflicts.is_safe = true;
        self.series.iter_mut().for_each(|table| table.is_safe = true);
    }

    /// The SHA-256 of `conflicts.csv`.
    pub fn digest(&self) -> String {
        self.conflicts.rows.get_ref().hasher.clone().digits()
    }

    /// Writes `run.json`, whole or not at all.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be written.
    pub fn write_record(&self, record: &RunRecord) -> Result<()> {
        let path = self.folder.join(RUN);
        let draft = self.folder.join(format!("{RUN}.tmp"));
        let text = serde_json::to_string_pretty(record).map_err(|error| Error::content(&path, error.to_string()))?;
        fs::write(&draft, text + "\n").map_err(|source| Error::file(&draft, source))?;
        fs::rename(&draft, &path).map_err(|source| Error::file(&path, source))
    }

    /// Removes what was written: the input could not be used after all.
    pub fn discard(self) {
        // A file that cannot be removed stays: the error to report is the one that led here.
        for path in [Some(&self.conflicts.path), self.series.as_ref().map(|table| &table.path)].into_iter().flatten() {
            let _ = fs::remove_file(path);
        }
        let _ = fs::remove_file(self.folder.join(RUN));
        if self.made_folder {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

/// One CSV file.
#[derive(Debug)]
struct CsvFile {
    path: PathBuf,
    rows: csv::Writer<WholeRows>,
    /// The text of the cell that is being written.
    text: String,
    is_safe: bool,
}

impl CsvFile {
    fn create<'a>(path: PathBuf, columns: impl Iterator<Item = &'a str>) -> Result<Self> {
        let file = File::create(&path).map_err(|source| Error::file(&path, source))?;
        let rows = WholeRows { file, written: 0, waiting: Vec::new(), hasher: Hasher::default() };
        let mut table = Self { path, rows: csv::Writer::from_writer(rows), text: String::new(), is_safe: false };
        table.write_row(columns.map(Value::Text))?;
        table.flush()?;
        Ok(table)
    }

    fn write_row<'a>(&mut self, values: impl IntoIterator<Item = Value<'a>>) -> Result<()> {
        let Self { rows, text, is_safe, .. } = self;
        let written = values.into_iter().try_for_each(|value| match value {
            Value::Text(cell) if *is_safe => rows.write_field(safe(cell, text)),
            value => rows.write_field(value.text(text)),
        });
        let written = written.and_then(|()| rows.write_record(None::<&[u8]>));
        written.map_err(|error| self.unwritable(error.into()))
    }

    fn flush(&mut self) -> Result<()> {
        self.rows.flush().map_err(|source| self.unwritable(source))
    }

    fn unwritable(&self, source: std::io::Error) -> Error {
        Error::file(&self.path, source)
    }
}

/// A file that gets the rows waiting at a flush in one call, so that it holds whole rows only.
#[derive(Debug)]
struct WholeRows {
    file: File,
    /// Bytes on disk.
    written: u64,
    waiting: Vec<u8>,
    /// Of what is on disk.
    hasher: Hasher,
}

impl Write for WholeRows {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.waiting.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        let done = self.file.write_all(&self.waiting);
        match done {
            Ok(()) => {
                self.written += self.waiting.len() as u64;
                self.hasher.add(&self.waiting);
            }
            Err(_) => self.take_back(),
        }
        // The buffer of a step with many rows would stay for the rest of the run.
        self.waiting = Vec::new();
        done
    }
}

impl WholeRows {
    /// Removes a row that a full disk cut short, so that the next row follows the last whole one.
    fn take_back(&mut self) {
        // The error of the write itself is reported already.
        let _ = self.file.set_len(self.written);
        let _ = self.file.seek(SeekFrom::Start(self.written));
    }
}

#[cfg(test)]
mod tests {
    use crate::output::log::*;

    #[test]
    fn the_row_after_a_half_written_one_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        let file = File::create(&path).unwrap();
        let mut rows = WholeRows { file, written: 0, waiting: b"first\n".to_vec(), hasher: Hasher::default() };
        rows.flush().unwrap();
        rows.file.write_all(b"sec").unwrap();
        rows.take_back();
        rows.write_all(b"third\n").unwrap();
        rows.flush().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "first\nthird\n");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let message = Log::create(Path::new("/proc/closecall"), &Options::default()).unwrap_err().to_string();
        assert!(message.starts_with("/proc/closecall: "), "{message}");
    }
}
