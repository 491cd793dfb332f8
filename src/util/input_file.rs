//! Opens a text file that may be gzipped, and counts its lines as they are read: messages name them.

use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use crate::{Error, Result};

/// A file that may be gzipped, to be read from its beginning; a pipe is refused.
pub fn open(path: &Path) -> Result<Box<dyn BufRead>> {
    let is_regular = std::fs::metadata(path).map(|it| it.is_file() || it.is_dir());
    if !is_regular.map_err(|source| Error::file(path, source))? {
        // Checked before opening, because opening a pipe waits for its writer.
        return Err(Error::content(path, "a pipe or device; it is read more than once, so it has to be a file"));
    }
    let mut file = File::open(path).map_err(|source| Error::file(path, source))?;
    let mut magic = [0; 2];
    let length = file.read(&mut magic).map_err(|source| Error::file(path, source))?;
    file.seek(SeekFrom::Start(0)).map_err(|source| Error::file(path, source))?;
    let file = BufReader::with_capacity(1 << 16, file);
    Ok(if magic[..length] == [0x1f, 0x8b] {
        Box::new(BufReader::with_capacity(1 << 16, MultiGzDecoder::new(file)))
    } else {
        Box::new(file)
    })
}

/// A message of quick-xml in one line.
pub fn xml_message(error: &quick_xml::Error) -> String {
    error.to_string().replace('\n', " ")
}

/// Counts lines as they are read: messages name them.
pub struct LineCounter {
    source: Box<dyn BufRead>,
    lines: u64,
}

impl LineCounter {
    /// Counts from 1.
    pub fn new(source: Box<dyn BufRead>) -> Self {
        Self { source, lines: 1 }
    }

    /// The line that is read next.
    pub fn line(&self) -> u64 {
        self.lines
    }
}

impl Read for LineCounter {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let length = self.source.read(buffer)?;
        self.lines += count_lines(&buffer[..length]);
        Ok(length)
    }
}

impl BufRead for LineCounter {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        self.source.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        if let Ok(buffer) = self.source.fill_buf() {
            self.lines += count_lines(&buffer[..amount.min(buffer.len())]);
        }
        self.source.consume(amount);
    }
}

fn count_lines(bytes: &[u8]) -> u64 {
    bytes.iter().filter(|byte| **byte == b'\n').count() as u64
}
