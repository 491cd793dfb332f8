//! How the first bytes of a file, and the columns of a table, tell the formats of recordings apart.

use std::io::Read;
use std::path::Path;

use super::format::RecordingFormat;
use super::layouts::LAYOUTS;
use super::{table, trj};
use crate::Error;
use crate::Result;
use crate::util::input_file;

/// The format that a file shows. A table with the columns of a known layout has that layout.
///
/// # Errors
/// [`Error::File`] where it cannot be read.
pub(super) fn format_of(path: &Path) -> Result<RecordingFormat> {
    let mut first = Vec::new();
    let read = input_file::open(path)?.take(4096).read_to_end(&mut first);
    read.map_err(|source| Error::file(path, source))?;
    if trj::is_trj(&first) {
        return Ok(RecordingFormat::Trj);
    }
    let text = String::from_utf8_lossy(&first);
    let is_markup = text.trim_start_matches('\u{feff}').trim_start().starts_with('<');
    if is_markup || first.is_empty() {
        return Ok(RecordingFormat::Fcd);
    }
    if text.contains("$VEHICLE") {
        return Ok(RecordingFormat::Fzp);
    }
    // A file without a table is not a recording; replay names what it lacks.
    let Ok(names) = table::names(path) else { return Ok(RecordingFormat::Fcd) };
    let layout = LAYOUTS.iter().find(|layout| layout.fits(&names));
    Ok(layout.map_or(RecordingFormat::Fcd, |layout| layout.format))
}
