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
    /// Creates the file, and its folder if that does not exist.
    pub fn create(path: &Path) -> Result<Self> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
        }
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
