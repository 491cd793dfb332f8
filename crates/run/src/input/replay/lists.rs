//! Lists of numbers in a temporary file, so that only those in use are in memory.

use std::io::{BufWriter, Read, Seek, SeekFrom, Write};

use tempfile::{SpooledTempFile, spooled_tempfile};

use crate::{Error, Result};

/// Up to this size, in bytes, a temporary file stays in memory.
const IN_MEMORY: usize = 1 << 14;
/// The size of a number, in bytes.
const SIZE: usize = 4;

/// Where a list is: its first byte, and its number of bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    pub start: u64,
    pub length: u64,
}

/// Lists being written.
pub(super) struct ListWriter {
    file: BufWriter<SpooledTempFile>,
    length: u64,
}

impl Default for ListWriter {
    fn default() -> Self {
        Self { file: BufWriter::new(temporary()), length: 0 }
    }
}

impl ListWriter {
    /// Writes a list.
    ///
    /// # Errors
    /// [`Error::File`] if the temporary file cannot be written.
    pub fn write(&mut self, numbers: impl IntoIterator<Item = u32>) -> Result<Place> {
        let start = self.length;
        for number in numbers {
            self.file.write_all(&number.to_le_bytes()).map_err(unusable)?;
            self.length += SIZE as u64;
        }
        Ok(Place { start, length: self.length - start })
    }

    /// The lists, to be read.
    ///
    /// # Errors
    /// [`Error::File`] if the temporary file cannot be written.
    pub fn finish(self) -> Result<Lists> {
        self.file.into_inner().map(|file| Lists { file }).map_err(|error| unusable(error.into_error()))
    }
}

/// Lists that are read back.
pub(super) struct Lists {
    file: SpooledTempFile,
}

impl Lists {
    /// The list at a place.
    ///
    /// # Errors
    /// [`Error::File`] if the temporary file cannot be read.
    pub fn read(&mut self, place: Place) -> Result<Vec<u32>> {
        let mut bytes = vec![0; place.length as usize];
        self.file.seek(SeekFrom::Start(place.start)).map_err(unusable)?;
        self.file.read_exact(&mut bytes).map_err(unusable)?;
        let (numbers, _) = bytes.as_chunks::<SIZE>();
        Ok(numbers.iter().map(|number| u32::from_le_bytes(*number)).collect())
    }
}

/// A temporary file, in memory while it is small.
pub(super) fn temporary() -> SpooledTempFile {
    spooled_tempfile(IN_MEMORY)
}

/// The error for a temporary file.
pub(super) fn unusable(error: std::io::Error) -> Error {
    Error::file(&std::env::temp_dir(), error)
}
