//! The tags of an XML file, found in place: the text between `<` and `>`.

use std::path::Path;

use super::source::{ByteWindow, find};
use crate::Error;
use crate::util::input_file::longer;
use closecall::util::limits::ELEMENT;

/// A tag without its `<` and `>`.
pub(super) enum Tag<'a> {
    /// The name of an element that begins, and its attributes, with a final slash if the element is empty.
    Start(&'a [u8], &'a [u8]),
    /// The name of an element that ends.
    End(&'a [u8]),
    /// A comment, a declaration or a processing instruction.
    Other,
}

impl<'a> Tag<'a> {
    #[inline]
    pub fn of(text: &'a [u8]) -> Self {
        match text {
            [b'!' | b'?', ..] => Self::Other,
            [b'/', name @ ..] => Self::End(name.trim_ascii_end()),
            _ => {
                let name = text.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'/');
                let (name, attributes) = text.split_at(name.unwrap_or(text.len()));
                Self::Start(name, attributes)
            }
        }
    }
}

/// Why the next tag is missing, though the file has not ended.
pub(super) enum TagFault {
    /// The file ends within it, or cannot be read on.
    CutShort(String),
    /// It has no end within the length of an element.
    TooLong,
}

impl TagFault {
    /// The fault as the error of a line.
    pub fn at(self, path: &Path, line: u64) -> Error {
        let message = match self {
            Self::CutShort(message) => message,
            Self::TooLong => longer("a tag or comment", &ELEMENT),
        };
        Error::line(path, line, message)
    }
}

/// Moves on to the next tag; returns the position of its `>` in the rest, none at the end of the file.
#[inline]
pub(super) fn next_tag(source: &mut ByteWindow) -> Result<Option<usize>, TagFault> {
    loop {
        // Text between tags has no meaning here.
        let rest = source.rest();
        let text = find(rest, b'<').unwrap_or(rest.len());
        source.consume(text);
        if let Some(end) = end_of(source.rest()) {
            return Ok(Some(end));
        }
        if source.rest().len() > ELEMENT.count() {
            return Err(TagFault::TooLong);
        }
        match source.more() {
            Ok(true) => {}
            Ok(false) if source.rest().is_empty() => return Ok(None),
            Ok(false) => return Err(TagFault::CutShort("the file ends within a tag".to_owned())),
            Err(error) => return Err(TagFault::CutShort(error.to_string())),
        }
    }
}

/// The position of the `>` of the tag that begins here; none if that needs more bytes.
#[inline]
fn end_of(rest: &[u8]) -> Option<usize> {
    let close = |ending: &[u8]| memchr::memmem::find(rest, ending).map(|place| place + ending.len() - 1);
    match rest {
        [_, b'?', ..] => close(b"?>"),
        [_, b'!', b'-', b'-', ..] => memchr::memmem::find(rest.get(4..)?, b"-->").map(|place| place + 6),
        [_, b'!', b'[', ..] => close(b"]]>"),
        _ => {
            let mut end = memchr::memchr2(b'>', b'\'', rest)?;
            // A value may contain a > too; then the quotation marks must be matched.
            if rest[end] == b'\'' || rest[..end].ends_with(b"=\"") || !is_value_end(rest, end) {
                end = end_outside_values(rest)?;
            }
            Some(end)
        }
    }
}

/// Whether a `>` follows the end of a value, or no value precedes it.
#[inline]
fn is_value_end(rest: &[u8], end: usize) -> bool {
    let before = rest[..end].strip_suffix(b"/").unwrap_or(&rest[..end]);
    before.ends_with(b"\"") || !before.contains(&b'"')
}

#[cold]
fn end_outside_values(rest: &[u8]) -> Option<usize> {
    let mut quote = None;
    rest.iter().position(|byte| {
        match (quote, *byte) {
            (None, b'>') => return true,
            (None, b'"' | b'\'') => quote = Some(*byte),
            (Some(mark), byte) if mark == byte => quote = None,
            _ => {}
        }
        false
    })
}
