//! Opens input files, whatever they claim to be: a pipe or a device is refused, a text that may be gzipped is unpacked
//! only as far as its limits allow, and its lines are counted, as messages name them.

use std::fs::File;
use std::io::{BufRead, BufReader, Error as IoError, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::bufread::MultiGzDecoder;

use super::read_ahead::ReadAhead;
use crate::{Error, Result};
use closecall::util::limits::{ELEMENT, INFLATION, LINE, Limit, TEXT};
use closecall::util::threads::processors;

/// Bytes that are read at once.
const BLOCK: usize = 1 << 16;
/// The first bytes that tell how a file is packed.
const MAGIC: u64 = 6;
/// Packings that are not read: the first bytes, the name, and what unpacks it.
const PACKINGS: [(&[u8], &str, &str); 6] = [
    (&[0x28, 0xb5, 0x2f, 0xfd], "zstd", "zstd -d"),
    (&[0xfd, b'7', b'z', b'X', b'Z', 0], "xz", "xz -d"),
    (b"BZh", "bzip2", "bzip2 -d"),
    (&[0x04, 0x22, 0x4d, 0x18], "lz4", "lz4 -d"),
    (b"PK\x03\x04", "zip", "unzip"),
    (b"7z\xbc\xaf\x27\x1c", "7-Zip", "7z x"),
];
/// Up to this size, in bytes, a gzipped file may unpack to whatever it wants.
const SMALL: u64 = 1 << 24;

/// A file that is open, from its beginning; a pipe or a device is refused.
///
/// # Errors
/// [`Error::File`] where it cannot be opened, [`Error::Content`] where it is a pipe or a device.
pub fn file(path: &Path) -> Result<File> {
    let is_file = std::fs::metadata(path).map(|it| it.is_file() || it.is_dir());
    if !is_file.map_err(|source| Error::file(path, source))? {
        // Checked before opening, because opening a pipe waits for its writer.
        return Err(Error::content(path, "a pipe or device; it is read more than once, so it has to be a file"));
    }
    File::open(path).map_err(|source| Error::file(path, source))
}

/// The text of a file that is read as a whole.
///
/// # Errors
/// Those of [`file()`], and where it is too long or not UTF-8.
pub fn text(path: &Path) -> Result<String> {
    let mut text = String::new();
    let most = TEXT.count() as u64;
    file(path)?.take(most + 1).read_to_string(&mut text).map_err(|source| Error::file(path, source))?;
    if text.len() as u64 > most { Err(Error::content(path, longer("it", &TEXT))) } else { Ok(text) }
}

/// A file that may be gzipped, to be read from its beginning; a thread of its own unpacks it where the machine has several
/// processors.
///
/// # Errors
/// Those of [`file()`].
pub fn open(path: &Path) -> Result<Box<dyn BufRead + Send>> {
    let mut file = file(path)?;
    let mut magic = Vec::new();
    (&mut file).take(MAGIC).read_to_end(&mut magic).map_err(|source| Error::file(path, source))?;
    file.seek(SeekFrom::Start(0)).map_err(|source| Error::file(path, source))?;
    if let Some((_, packing, program)) = PACKINGS.iter().find(|(first, ..)| magic.starts_with(first)) {
        let message = format!("it is packed by {packing}, and closecall reads gzip alone: unpack it first ({program})");
        return Err(Error::content(path, message));
    }
    let file = BufReader::with_capacity(BLOCK, file);
    if !magic.starts_with(&[0x1f, 0x8b]) {
        return Ok(Box::new(file));
    }
    let unpacked = MultiGzDecoder::new(file);
    Ok(if processors() > 1 {
        Box::new(ReadAhead::new(unpacked).map_err(|source| Error::file(path, source))?)
    } else {
        Box::new(BufReader::with_capacity(BLOCK, unpacked))
    })
}

/// A message of quick-xml in one line.
pub(crate) fn xml_message(error: &quick_xml::Error) -> String {
    match error {
        quick_xml::Error::Io(error) => error.to_string(),
        _ => error.to_string().replace('\n', " "),
    }
}

/// That something is longer than its limit allows.
pub fn longer(what: &str, limit: &Limit) -> String {
    format!("{what} is longer than {} {}", limit.count(), limit.unit)
}

/// The next line with its end; none after the last.
///
/// # Errors
/// Those of reading; where it is not UTF-8, or longer than the limit.
pub fn next_line(source: &mut dyn BufRead, limit: &Limit) -> std::io::Result<Option<String>> {
    let mut line = String::new();
    let most = limit.count();
    let read = source.take(most as u64 + 1).read_line(&mut line)?;
    if read > most {
        return Err(IoError::new(ErrorKind::InvalidData, longer("the line", limit)));
    }
    Ok(Some(line).filter(|_| read > 0))
}

/// The rows of a table, each of which has to end: a quotation mark that is not closed makes one row of all that follow.
#[derive(Debug)]
pub struct ShortRows<R> {
    source: R,
    /// Bytes read since the row began.
    row: usize,
    /// Whether the last byte read is a line break, or none was read.
    has_ended: bool,
}

impl<R: Read> ShortRows<R> {
    /// The rows of this source.
    pub fn new(source: R) -> Self {
        Self { source, row: 0, has_ended: true }
    }

    /// A row ends, the next one begins.
    pub fn begin_row(&mut self) {
        self.row = 0;
    }

    /// Whether what was read so far ends with a line break.
    pub(crate) fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// The source.
    pub fn source(&self) -> &R {
        &self.source
    }
}

impl<R: Read> Read for ShortRows<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.row > LINE.count() {
            let why = longer("the row", &LINE) + ": a quotation mark that is not closed?";
            return Err(IoError::new(ErrorKind::InvalidData, why));
        }
        let read = self.source.read(buffer)?;
        self.row += read;
        if let Some(last) = buffer[..read].last() {
            self.has_ended = matches!(last, b'\n' | b'\r');
        }
        Ok(read)
    }
}

/// An XML file whose elements stay in memory: it counts lines, and fails where the file unpacks to far more than a net or
/// a demand does, or where an element does not end.
pub(crate) struct ElementSource {
    source: Box<dyn BufRead + Send>,
    lines: u64,
    /// Bytes read in all and since the element began, and how many there may be.
    read: u64,
    element: u64,
    most: u64,
}

impl ElementSource {
    /// Opens a file.
    ///
    /// # Errors
    /// Those of [`open`].
    pub fn open(path: &Path) -> Result<Self> {
        let source = open(path)?;
        let size = std::fs::metadata(path).map_err(|source| Error::file(path, source))?.len();
        Ok(Self { most: SMALL.max(size.saturating_mul(INFLATION.count() as u64)), ..Self::new(source) })
    }

    /// A source in memory; its lines count from 1.
    pub fn new(source: Box<dyn BufRead + Send>) -> Self {
        Self { source, lines: 1, read: 0, element: 0, most: u64::MAX }
    }

    /// The line that is read next, in which an element begins.
    pub(crate) fn begin_element(&mut self) -> u64 {
        self.element = 0;
        self.lines
    }

    fn check(&self) -> std::io::Result<()> {
        let wrong = |message| Err(IoError::new(ErrorKind::InvalidData, message));
        if self.read > self.most {
            return wrong(format!(
                "it unpacks to more than {} times its size, as no net or demand does",
                INFLATION.count()
            ));
        }
        if self.element > ELEMENT.count() as u64 {
            wrong(longer("an element, comment or text", &ELEMENT))
        } else {
            Ok(())
        }
    }

    fn count(&mut self, bytes: usize, lines: u64) {
        self.lines += lines;
        self.read += bytes as u64;
        self.element += bytes as u64;
    }
}

impl Read for ElementSource {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.check()?;
        let length = self.source.read(buffer)?;
        self.count(length, count_lines(&buffer[..length]));
        Ok(length)
    }
}

impl BufRead for ElementSource {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        self.check()?;
        self.source.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        let lines = self.source.fill_buf().map_or(0, |buffer| count_lines(&buffer[..amount.min(buffer.len())]));
        self.count(amount, lines);
        self.source.consume(amount);
    }
}

fn count_lines(bytes: &[u8]) -> u64 {
    memchr::memchr_iter(b'\n', bytes).count() as u64
}

#[cfg(test)]
mod tests {
    use crate::util::input_file::*;
    use std::io::Write;

    fn gzipped(text: impl Iterator<Item = &'static [u8]>) -> tempfile::NamedTempFile {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        let mut gzip = flate2::write::GzEncoder::new(&mut file, flate2::Compression::fast());
        text.for_each(|part| gzip.write_all(part).unwrap());
        gzip.finish().unwrap();
        file
    }

    #[test]
    fn a_file_that_unpacks_to_far_more_is_refused() {
        let bomb = gzipped(std::iter::repeat_n(&[b'\n'; 1 << 20][..], 40));
        let mut source = ElementSource::open(bomb.path()).unwrap();
        let mut read = 0;
        let fault = loop {
            source.begin_element();
            match source.fill_buf().map(<[u8]>::len) {
                Ok(0) => panic!("{read} bytes were read"),
                Ok(length) => {
                    read += length;
                    source.consume(length);
                }
                Err(fault) => break fault.to_string(),
            }
        };
        assert!(fault.contains("25 times its size") && read < 20 << 20, "{fault} {read}");
    }

    #[test]
    fn an_element_that_does_not_end_is_refused() {
        let mut source = ElementSource::new(Box::new(std::io::Cursor::new(vec![b'x'; 3 << 20])));
        let mut text = Vec::new();
        let fault = source.read_to_end(&mut text).unwrap_err().to_string();
        assert!(fault.contains("longer than 1048576 bytes") && text.len() < 3 << 20, "{fault}");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_refused_without_being_read() {
        let fault = text(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(fault.starts_with("/dev/zero: a pipe or device"), "{fault}");
    }
}
