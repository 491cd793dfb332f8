//! One CSV file of the log, which holds whole rows only, whatever happens to the disk.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::PathBuf;

use super::input_hash::Hasher;
use super::schema::{Column, LoggedConflict, Value};
use crate::util::csv_safe::safe;
use crate::{Error, Result};

/// One CSV file.
#[derive(Debug)]
pub(super) struct CsvFile {
    pub path: PathBuf,
    columns: Vec<Column>,
    rows: csv::Writer<WholeRows>,
    /// The text of the cell that is being written.
    text: String,
    /// Whether no cell is one that a spreadsheet would run.
    pub is_safe: bool,
    is_synced: bool,
}

impl CsvFile {
    pub fn create(path: PathBuf, columns: impl Iterator<Item = Column>) -> Result<Self> {
        // Never through a link: what is there was removed.
        let file = File::create_new(&path).map_err(|source| Error::file(&path, source))?;
        let rows = csv::Writer::from_writer(WholeRows::new(file));
        let (columns, text) = (columns.collect(), String::new());
        let mut table = Self { path, columns, rows, text, is_safe: false, is_synced: false };
        table.write_cells(|column| Value::Text(column.name))?;
        table.flush()?;
        Ok(table)
    }

    pub(crate) fn write_row(&mut self, row: &LoggedConflict) -> Result<()> {
        self.write_cells(|column| (column.get)(row))
    }

    fn write_cells<'a>(&mut self, value: impl Fn(&Column) -> Value<'a>) -> Result<()> {
        let Self { columns, rows, text, is_safe, .. } = self;
        let written = columns.iter().try_for_each(|column| match value(column) {
            Value::Text(cell) if *is_safe => rows.write_field(safe(cell, text)),
            value => rows.write_field(value.text(text)),
        });
        let written = written.and_then(|()| rows.write_record(None::<&[u8]>));
        written.map_err(|error| self.unwritable(error.into()))
    }

    pub fn flush(&mut self) -> Result<()> {
        self.is_synced = false;
        self.rows.flush().map_err(|source| self.unwritable(source))
    }

    pub fn sync(&mut self) -> Result<()> {
        if !self.is_synced {
            self.rows.get_ref().file.sync_data().map_err(|source| self.unwritable(source))?;
        }
        self.is_synced = true;
        Ok(())
    }

    /// The SHA-256 of what is on disk.
    pub fn digest(&self) -> String {
        self.rows.get_ref().hasher.clone().digits()
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
    /// After a write that failed nothing more is written: rows would be missing in between.
    is_over: bool,
}

impl Write for WholeRows {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.waiting.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        if self.is_over {
            return Err(std::io::Error::other("an earlier write failed"));
        }
        let done = self.file.write_all(&self.waiting);
        match done {
            Ok(()) => {
                self.written += self.waiting.len() as u64;
                self.hasher.add(&self.waiting);
            }
            Err(_) => {
                self.is_over = true;
                self.take_back();
            }
        }
        // The buffer of a step with many rows would stay for the rest of the run.
        self.waiting = Vec::new();
        done
    }
}

impl WholeRows {
    fn new(file: File) -> Self {
        Self { file, written: 0, waiting: Vec::new(), hasher: Hasher::default(), is_over: false }
    }

    /// Removes a row that a full disk cut short, so that the file ends with the last whole one.
    fn take_back(&mut self) {
        // The error of the write itself is reported already.
        let _ = self.file.set_len(self.written);
        let _ = self.file.seek(SeekFrom::Start(self.written));
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use crate::output::csv_file::*;

    #[test]
    fn a_half_written_row_is_taken_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        let mut rows = WholeRows::new(File::create(&path).unwrap());
        rows.write_all(b"first\n").unwrap();
        rows.flush().unwrap();
        rows.file.write_all(b"sec").unwrap();
        rows.take_back();
        assert_eq!(fs::read_to_string(&path).unwrap(), "first\n");
    }

    #[cfg(unix)]
    #[test]
    fn after_a_failed_write_nothing_more_is_written() {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let mut rows = WholeRows::new(full);
        rows.write_all(b"first\n").unwrap();
        assert!(rows.flush().unwrap_err().to_string().contains("No space left"));
        // The disk has room again.
        rows.file = File::options().write(true).open("/dev/null").unwrap();
        rows.write_all(b"second\n").unwrap();
        assert!(rows.flush().is_err());
    }
}
