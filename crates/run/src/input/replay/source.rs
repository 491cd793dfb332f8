//! A file's bytes in large blocks, so that a recording is read in place without copying.

use std::fs::File;
use std::io::{self, BufRead, Read, Write};

use crate::util::input_file::longer;
use closecall::util::limits::ELEMENT;

/// The number of bytes read at once: they fit into a core's own cache.
const BLOCK: usize = 1 << 18;

/// A window that moves along a file; its memory does not grow with the file.
pub(super) struct ByteWindow {
    reader: Box<dyn BufRead + Send>,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    lines_before: u64,
    mark: u8,
    marked: bool,
}

impl ByteWindow {
    pub fn new(reader: Box<dyn BufRead + Send>) -> Self {
        Self { reader, buffer: Vec::new(), start: 0, end: 0, lines_before: 0, mark: 0, marked: false }
    }

    /// The bytes that were read and not yet consumed.
    #[inline]
    pub fn rest(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }

    /// Consumes the first `length` bytes of the rest.
    #[inline]
    pub fn consume(&mut self, length: usize) {
        self.start = (self.start + length).min(self.end);
    }

    /// Extends the rest; `false` at the end of the file.
    pub fn more(&mut self) -> io::Result<bool> {
        self.lines_before += lines(&self.buffer[..self.start]);
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        if self.end > ELEMENT.count() {
            return Err(io::Error::new(io::ErrorKind::InvalidData, longer("a line, tag or comment", &ELEMENT)));
        }
        if self.end + BLOCK / 2 > self.buffer.len() {
            self.buffer.resize((2 * self.end).max(BLOCK), 0);
        }
        let length = loop {
            match self.reader.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                read => break read?,
            }
        };
        let read = &self.buffer[self.end..self.end + length];
        self.marked = self.marked || memchr::memchr(self.mark, read).is_some();
        self.end += length;
        Ok(length > 0)
    }

    /// All that is not consumed, in a temporary file.
    pub(crate) fn into_file(mut self) -> io::Result<File> {
        let mut file = tempfile::tempfile()?;
        loop {
            file.write_all(self.rest())?;
            self.consume(self.rest().len());
            if !self.more()? {
                return Ok(file);
            }
        }
    }

    /// Sets the byte that [`ByteWindow::is_marked`] reports.
    pub(crate) fn look_out_for(&mut self, mark: u8) {
        self.mark = mark;
        self.marked = memchr::memchr(mark, self.rest()).is_some();
    }

    /// Whether the byte set by [`ByteWindow::look_out_for`] has occurred so far, the rest included.
    #[inline]
    pub(crate) fn is_marked(&self) -> bool {
        self.marked
    }

    /// The number of the line in which the rest begins, from 1.
    pub fn line(&self) -> u64 {
        1 + self.lines_before + lines(&self.buffer[..self.start])
    }
}

fn lines(bytes: &[u8]) -> u64 {
    memchr::memchr_iter(b'\n', bytes).count() as u64
}

/// The first position of a byte. Meant for near positions: compares eight bytes at a time, without a call.
#[inline]
pub(super) fn find(bytes: &[u8], wanted: u8) -> Option<usize> {
    const LOW: u64 = u64::from_ne_bytes([0x01; 8]);
    const HIGH: u64 = u64::from_ne_bytes([0x80; 8]);
    let pattern = u64::from_ne_bytes([wanted; 8]);
    let mut at = 0;
    while let Some(eight) = bytes[at..].first_chunk::<8>() {
        // The lowest zero byte of `other` is the first whose high bit is set in `found`.
        let other = u64::from_le_bytes(*eight) ^ pattern;
        let found = other.wrapping_sub(LOW) & !other & HIGH;
        if found != 0 {
            return Some(at + (found.trailing_zeros() / 8) as usize);
        }
        at += 8;
    }
    bytes[at..].iter().position(|byte| *byte == wanted).map(|place| at + place)
}

/// The number of bytes compared at once.
const COMPARED: usize = 64;

/// Calls `found` with each position of a byte in the first `length` bytes, in order, until it returns `false`. Bytes after
/// these may be read but do not count.
// The nine values of a row of 62 bytes take 18 ns, with `memchr_iter` 41 ns, because they are near each other.
#[inline]
pub(super) fn find_all(bytes: &[u8], length: usize, wanted: u8, mut found: impl FnMut(usize) -> bool) {
    let mut at = 0;
    while at < length {
        let mut places = match bytes[at..].first_chunk::<COMPARED>() {
            Some(block) => places(block, wanted),
            None => {
                let mut block = [!wanted; COMPARED];
                block[..bytes.len() - at].copy_from_slice(&bytes[at..]);
                places(&block, wanted)
            }
        };
        if length - at < COMPARED {
            places &= (1 << (length - at)) - 1;
        }
        while places != 0 {
            if !found(at + places.trailing_zeros() as usize) {
                return;
            }
            places &= places - 1;
        }
        at += COMPARED;
    }
}

/// A bit per byte that tells whether it is the wanted one.
#[inline]
fn places(block: &[u8; COMPARED], wanted: u8) -> u64 {
    const ALL_BUT_HIGH: u64 = u64::from_ne_bytes([0x7f; 8]);
    /// Collects the highest bits of eight bytes in one byte.
    const GATHER: u64 = 0x0002_0408_1020_4081;
    let pattern = u64::from_ne_bytes([wanted; 8]);
    let (eights, _) = block.as_chunks::<8>();
    eights.iter().rev().fold(0, |places, eight| {
        let other = u64::from_le_bytes(*eight) ^ pattern;
        let same = !(((other & ALL_BUT_HIGH) + ALL_BUT_HIGH) | other | ALL_BUT_HIGH);
        places << 8 | same.wrapping_mul(GATHER) >> 56
    })
}

#[cfg(test)]
mod tests {
    use crate::input::replay::source::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_byte_is_found_everywhere(
            bytes in proptest::collection::vec(prop_oneof![Just(b';'), Just(b':'), any::<u8>()], 0..200),
            part in 0.0..1.0_f64,
            most in 1..300_usize,
        ) {
            let length = (bytes.len() as f64 * part).round() as usize;
            let mut found = Vec::new();
            find_all(&bytes, length, b';', |place| {
                found.push(place);
                found.len() < most
            });
            let all = (0..length).filter(|place| bytes[*place] == b';');
            prop_assert_eq!(found, all.take(most).collect::<Vec<_>>());
        }
    }
}
