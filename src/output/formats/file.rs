//! An output file being written, whose errors name it.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::{Error, Result};

/// A file being written.
#[derive(Debug)]
pub(super) struct OutputFile {
    pub path: PathBuf,
    pub writer: BufWriter<File>,
}

impl OutputFile {
    pub fn create(path: &Path) -> Result<Self> {
        let file = File::create(path).map_err(|source| Error::file(path, source))?;
        Ok(Self { path: path.to_owned(), writer: BufWriter::new(file) })
    }

    pub fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.writer.write_all(bytes).map_err(|source| Error::file(&self.path, source))
    }

    pub fn flush(&mut self) -> Result<()> {
        self.writer.flush().map_err(|source| Error::file(&self.path, source))
    }
}
