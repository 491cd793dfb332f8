//! A file's bytes in large blocks: what is read of a recording lies in place, and is not copied.

use std::io::{self, BufRead, Read};

/// How much is read at once, in bytes: it fits into a core's own cache.
const BLOCK: usize = 1 << 18;
/// A line or a tag that is longer than this, in bytes, is none.
const LONGEST: usize = 1 << 24;

/// A window on a file that moves on; its memory does not grow with the file.
pub(super) struct Source {
    reader: Box<dyn BufRead>,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    lines_before: u64,
    mark: u8,
    marked: bool,
}

impl Source {
    pub fn new(reader: Box<dyn BufRead>) -> Self {
        Self { reader, buffer: Vec::new(), start: 0, end: 0, lines_before: 0, mark: 0, marked: false }
    }

    /// What was read and not yet consumed.
    #[inline]
    pub fn rest(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }

    /// Goes on by `length` bytes of the rest.
    #[inline]
    pub fn consume(&mut self, length: usize) {
        self.start = (self.start + length).min(self.end);
    }

    /// Makes the rest longer; `false` where the file has ended.
    pub fn more(&mut self) -> io::Result<bool> {
        self.lines_before += lines(&self.buffer[..self.start]);
        self.buffer.copy_within(self.start..self.end, 0);
        (self.start, self.end) = (0, self.end - self.start);
        if self.end >= LONGEST {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a line or tag that does not end"));
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

    /// From now on [`Source::is_marked`] says whether this byte has come up.
    pub fn look_out_for(&mut self, mark: u8) {
        self.mark = mark;
        self.marked = memchr::memchr(mark, self.rest()).is_some();
    }

    /// Whether the byte that was looked out for is in the rest, or was in the file before it.
    #[inline]
    pub fn is_marked(&self) -> bool {
        self.marked
    }

    /// The line in which the rest begins, counted from 1.
    pub fn line(&self) -> u64 {
        1 + self.lines_before + lines(&self.buffer[..self.start])
    }
}

fn lines(bytes: &[u8]) -> u64 {
    memchr::memchr_iter(b'\n', bytes).count() as u64
}

/// Where a byte stands first, for places that are near: eight bytes at a time, without a call.
#[inline]
pub(super) fn find(bytes: &[u8], wanted: u8) -> Option<usize> {
    const LOW: u64 = u64::from_ne_bytes([0x01; 8]);
    const HIGH: u64 = u64::from_ne_bytes([0x80; 8]);
    let pattern = u64::from_ne_bytes([wanted; 8]);
    let mut at = 0;
    while let Some(eight) = bytes[at..].first_chunk::<8>() {
        // The lowest byte that is 0 in `other` is the first that has its high bit set here.
        let other = u64::from_le_bytes(*eight) ^ pattern;
        let found = other.wrapping_sub(LOW) & !other & HIGH;
        if found != 0 {
            return Some(at + (found.trailing_zeros() / 8) as usize);
        }
        at += 8;
    }
    bytes[at..].iter().position(|byte| *byte == wanted).map(|place| at + place)
}

/// So many bytes are compared at once.
const COMPARED: usize = 64;

/// Where a byte stands in the first `length` bytes, everywhere in order, until `found` has seen enough. What lies behind
/// them is read and not looked at.
// The nine values of a row of 62 bytes in 18 ns, by `memchr_iter` in 41: they are near each other.
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

/// A bit for each byte: whether it is the wanted one.
#[inline]
fn places(block: &[u8; COMPARED], wanted: u8) -> u64 {
    const ALL_BUT_HIGH: u64 = u64::from_ne_bytes([0x7f; 8]);
    /// Brings the highest bits of eight bytes together.
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
