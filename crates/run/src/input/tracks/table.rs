//! A table of trajectories, row by row: CSV, plain or gzipped, or Parquet.

use std::borrow::Cow;
use std::io::{BufRead, Read};
use std::path::Path;

use crate::util::header::Wanted;
use crate::util::input_file::{self, ShortRows, longer};
use crate::util::parquet_rows::ParquetRows;
use crate::util::parquet_values::Value;
use crate::{Error, Result};
use closecall::util::limits::LINE;

/// What may stand between values, in the order in which it is looked for.
const SEPARATORS: [u8; 3] = *b";\t,";
/// The first bytes of a Parquet file.
const PARQUET: &[u8; 4] = b"PAR1";

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell<'a> {
    Text(Cow<'a, str>),
    Number(f64),
    Missing,
}

impl Cell<'_> {
    /// Its number; none if the value is missing.
    pub fn number(&self) -> std::result::Result<Option<f64>, String> {
        let number = match self {
            Self::Missing => return Ok(None),
            Self::Number(number) => Some(*number),
            Self::Text(text) => match text.trim() {
                "" => return Ok(None),
                text => text.parse().ok(),
            },
        };
        number
            .filter(|number| number.is_finite())
            .map(Some)
            .ok_or_else(|| format!("\"{}\" is not a number", self.text()))
    }

    /// Its text; empty if the value is missing.
    pub fn text(&self) -> Cow<'_, str> {
        match self {
            Self::Missing => Cow::Borrowed(""),
            Self::Text(text) => Cow::Borrowed(text.trim()),
            Self::Number(number) => Cow::Owned(number.to_string()),
        }
    }
}

/// The names of the columns of a table.
///
/// # Errors
/// [`Error::File`] where it cannot be read; [`Error::Line`] where it is not a table.
pub(super) fn names(path: &Path) -> Result<Vec<String>> {
    if let Some(rows) = parquet_of(path)? {
        return Ok(rows.names());
    }
    csv_names(path, &mut csv_of(path)?)
}

/// Reads a table: `begin` gets the names of its columns and returns the places of those that are read, `row` gets their values and
/// returns whether to read on. Returns what is doubtful.
///
/// # Errors
/// Those of [`names`], and what `begin` and `row` return, with the row.
pub(super) fn read(
    path: &Path,
    begin: impl FnOnce(&[String]) -> std::result::Result<Vec<(usize, Wanted)>, String>,
    mut row: impl FnMut(&[Cell]) -> std::result::Result<bool, String>,
) -> Result<Option<String>> {
    if let Some(mut rows) = parquet_of(path)? {
        let columns = begin(&rows.names()).map_err(|why| Error::content(path, why))?;
        rows.want(&columns)?;
        while rows.has_row()? {
            let cells = (0..columns.len()).map(|column| cell(rows.value(column)));
            let done = cells.collect::<std::result::Result<Vec<_>, _>>().and_then(|cells| row(&cells));
            if !done.map_err(|why| Error::content(path, format!("row {}: {why}", rows.number())))? {
                break;
            }
            rows.use_row();
        }
        return Ok(None);
    }
    let mut reader = csv_of(path)?;
    let columns = begin(&csv_names(path, &mut reader)?).map_err(|why| Error::line(path, 1, why))?;
    let mut record = csv::StringRecord::new();
    loop {
        let line = reader.position().line();
        reader.get_mut().begin_row();
        if !reader.read_record(&mut record).map_err(|error| unreadable(path, line, &error))? {
            return Ok((!reader.get_ref().has_ended()).then(|| maybe_cut(path)));
        }
        let text = |place: usize| record.get(place).map_or(Cell::Missing, |text| Cell::Text(Cow::Borrowed(text)));
        let cells = columns.iter().map(|(place, _)| text(*place)).collect::<Vec<_>>();
        if !row(&cells).map_err(|why| Error::line(path, line, why))? {
            return Ok(None);
        }
    }
}

/// The warning about a last row without a line break.
pub(super) fn maybe_cut(path: &Path) -> String {
    format!("{}: its last row has no line break; where the file was cut short, the last value is wrong", path.display())
}

fn csv_of(path: &Path) -> Result<csv::Reader<ShortRows<impl Read>>> {
    const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
    let fault = |source| Error::file(path, source);
    let mut source = input_file::open(path)?;
    let first = source.fill_buf().map_err(fault)?;
    let line = first.split(|byte| *byte == b'\n').next().unwrap_or_default();
    if line.len() > LINE.count() {
        return Err(Error::line(path, 1, longer("the row", &LINE)));
    }
    let separator = SEPARATORS.into_iter().find(|separator| line.contains(separator)).unwrap_or(b',');
    if first.starts_with(BYTE_ORDER_MARK) {
        source.consume(BYTE_ORDER_MARK.len());
    }
    Ok(csv::ReaderBuilder::new().delimiter(separator).from_reader(ShortRows::new(source)))
}

fn csv_names(path: &Path, reader: &mut csv::Reader<ShortRows<impl Read>>) -> Result<Vec<String>> {
    let names = reader.headers().map_err(|error| unreadable(path, 1, &error))?;
    Ok(names.iter().map(|name| name.trim().to_owned()).collect())
}

fn unreadable(path: &Path, line: u64, error: &csv::Error) -> Error {
    let line = error.position().map_or(line, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            Error::line(path, line, format!("the row has {len} cells, not {expected_len}"))
        }
        csv::ErrorKind::Io(source) => Error::line(path, line, source.to_string()),
        csv::ErrorKind::Utf8 { err, .. } => Error::line(path, line, err.to_string()),
        _ => Error::line(path, line, error.to_string()),
    }
}

fn parquet_of(path: &Path) -> Result<Option<ParquetRows>> {
    let mut file = input_file::file(path)?;
    let mut first = [0; PARQUET.len()];
    let is_one = file.read(&mut first).map_err(|source| Error::file(path, source))? == first.len() && first == *PARQUET;
    if is_one { ParquetRows::open(path, file).map(Some) } else { Ok(None) }
}

fn cell(value: Value<'_>) -> std::result::Result<Cell<'_>, String> {
    Ok(match value {
        Value::Missing => Cell::Missing,
        Value::Number(number) => Cell::Number(number),
        Value::Text(text) => Cell::Text(Cow::Borrowed(std::str::from_utf8(text).map_err(|error| error.to_string())?)),
    })
}
