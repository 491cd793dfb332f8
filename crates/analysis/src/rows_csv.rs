//! Tables of rows that name their own columns.

use std::path::Path;

use serde::Serialize;

use crate::{Error, Result};
use closecall_run::util::output_file::OutputFile;

/// Writes the rows with a header.
///
/// # Errors
/// [`Error::File`](closecall_run::Error::File) that names the file.
pub fn write<Row: Serialize>(path: &Path, rows: &[Row]) -> Result<()> {
    let failed = |error: csv::Error| Error::content(path, error.to_string());
    let mut table = OutputFile::create(path)?;
    let mut writer = csv::Writer::from_writer(&mut table);
    rows.iter().try_for_each(|row| writer.serialize(row)).map_err(failed)?;
    writer.flush().map_err(|source| Error::file(path, source))?;
    drop(writer);
    Ok(table.finish()?)
}
