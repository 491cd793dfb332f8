//! Detects a recording's format from its first bytes or its columns.

use std::io::Read;
use std::path::Path;

use super::format::RecordingFormat;
use super::layouts::Layout;
use super::{table, trj};
use crate::Error;
use crate::Result;
use crate::util::input_file;

/// The format that a file shows. A table with the columns of a known layout has that layout.
///
/// # Errors
/// [`Error::File`] where it cannot be read.
pub(super) fn format_of(path: &Path) -> Result<RecordingFormat> {
    let first = first_bytes(path)?;
    if trj::is_trj(&first) {
        return Ok(RecordingFormat::Trj);
    }
    let text = String::from_utf8_lossy(&first);
    if begins_markup(&text) || first.is_empty() {
        return Ok(RecordingFormat::Fcd);
    }
    if text.contains("$VEHICLE") {
        return Ok(RecordingFormat::Fzp);
    }
    // A file without a table is not a recording; replay names what it lacks.
    let Ok(names) = table::names(path) else { return Ok(RecordingFormat::Fcd) };
    Ok(Layout::known(&names).map_or(RecordingFormat::Fcd, |layout| layout.format))
}

/// Whether a file is XML.
pub(super) fn is_markup(path: &Path) -> Result<bool> {
    first_bytes(path).map(|first| begins_markup(&String::from_utf8_lossy(&first)))
}

fn begins_markup(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}

fn first_bytes(path: &Path) -> Result<Vec<u8>> {
    let mut first = Vec::new();
    let read = input_file::open(path)?.take(4096).read_to_end(&mut first);
    read.map_err(|source| Error::file(path, source))?;
    Ok(first)
}
