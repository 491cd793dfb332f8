//! fcd-output in CSV: one row per road user and step, the time in each.

use std::path::{Path, PathBuf};

use super::clock;
use super::columns::{Columns, NamedColumn};
use super::fcd_attributes::{Fields, Scope};
use super::names::Users;
use super::recorded_step::{RecordedStep, cut_short, in_order};
use super::source::{ByteWindow, find_all};
use crate::util::input_file::longer;
use crate::{Error, Result};
use closecall::util::limits::LINE;
use closecall::util::units::Second;

/// What may stand between values (`--output.column-separator`), in the order in which it is looked for.
const SEPARATORS: [u8; 3] = *b";\t,";

/// A CSV recording being read.
pub(super) struct CsvRecording {
    path: PathBuf,
    source: ByteWindow,
    scope: Scope,
    separator: u8,
    columns: Columns,
    /// The number of columns up to the last one that matters.
    columns_read: usize,
    /// The ends of the values of the current row.
    ends: Vec<usize>,
    /// The time of the current step as it is written: most rows repeat it.
    time_text: Vec<u8>,
    last: Option<Second>,
}

impl CsvRecording {
    pub fn new(path: &Path, mut source: ByteWindow, scope: Scope) -> Result<Self> {
        source.look_out_for(b'"');
        let unusable = |error| Error::file(path, error);
        let header = loop {
            match next_row(&mut source).map_err(unusable)? {
                NextRow::Whole(length) if is_empty(&source.rest()[..length]) => source.consume(length),
                NextRow::Whole(length) => break length,
                NextRow::Incomplete => break source.rest().len(),
                NextRow::TooLong => return Err(too_long(path, &source)),
                NextRow::None => return Err(Error::content(path, "the file is empty")),
            }
        };
        let line = trimmed(&source.rest()[..header]);
        let separator = SEPARATORS.into_iter().find(|separator| line.contains(separator)).unwrap_or(b',');
        let names = quoted(line, separator).map_err(|error| Error::content(path, error))?;
        let names = names.iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect::<Vec<_>>();
        let columns = Columns::of(path, &names, scope)?;
        let columns_read = 1 + columns.named.last().map_or(0, |last| last.place).max(columns.time);
        source.consume(header);
        Ok(Self {
            path: path.to_owned(),
            source,
            scope,
            separator,
            columns,
            columns_read,
            ends: Vec::new(),
            time_text: Vec::new(),
            last: None,
        })
    }

    pub fn next_step(&mut self, step: &mut RecordedStep, users: &mut Users) -> Result<bool> {
        let mut begun = false;
        loop {
            let cut = |message: &str| cut_short(&self.path, self.last, message);
            let length = match next_row(&mut self.source).map_err(|error| cut(&error.to_string()))? {
                NextRow::Whole(length) => length,
                NextRow::Incomplete => return Err(cut("the last row is incomplete")),
                NextRow::TooLong => return Err(too_long(&self.path, &self.source)),
                NextRow::None => break,
            };
            let line = trimmed(&self.source.rest()[..length]);
            if line.is_empty() {
                self.source.consume(length);
                continue;
            }
            let wrong = |message| Error::line(&self.path, self.source.line(), message);
            let quoted = match self.source.is_marked() && line.contains(&b'"') {
                true => Some(quoted(line, self.separator).map_err(wrong)?),
                false => {
                    split(self.source.rest(), line.len(), self.separator, self.columns_read, &mut self.ends);
                    None
                }
            };
            let plain = Values { line, ends: &self.ends };
            let value = |place: usize| quoted.as_ref().map_or_else(|| plain.get(place), |values| values.get(place));
            let time_text = value(self.columns.time).unwrap_or_default();
            if !begun || time_text != self.time_text {
                let time = clock::time(time_text);
                let message = || format!("timestep_time is \"{}\"", String::from_utf8_lossy(time_text));
                let time = time.ok_or_else(|| wrong(message()))?;
                if begun && time != step.time {
                    break;
                }
                if !begun {
                    in_order(self.last, time).map_err(wrong)?;
                    step.begin(time, users);
                    begun = true;
                }
                self.time_text.clear();
                self.time_text.extend_from_slice(time_text);
            }
            let mut fields = self.scope.fields();
            set(&mut fields, &self.columns.named, value).map_err(wrong)?;
            if self.columns.shared {
                fields.tell_apart();
            }
            if fields.is_user().map_err(wrong)? {
                step.add(&fields, users, "value in column").map_err(wrong)?;
            }
            self.source.consume(length);
        }
        if begun {
            step.end(users);
            self.last = Some(step.time);
        }
        Ok(begun)
    }
}

/// Sets the fields of a row from its values by position.
#[inline]
fn set<'a>(
    fields: &mut Fields<'a>,
    columns: &[NamedColumn],
    value: impl Fn(usize) -> Option<&'a [u8]>,
) -> std::result::Result<(), String> {
    for column in columns {
        let Some(value) = value(column.place) else { break };
        if !value.is_empty() {
            fields.person |= column.person;
            if let Some(attribute) = column.attribute {
                fields.set(attribute, value)?;
            }
        }
    }
    Ok(())
}

/// The values of a row that has no quotation marks.
struct Values<'a> {
    line: &'a [u8],
    ends: &'a [usize],
}

impl<'a> Values<'a> {
    #[inline]
    fn get(&self, place: usize) -> Option<&'a [u8]> {
        let start = if place == 0 { 0 } else { self.ends.get(place - 1)? + 1 };
        self.line.get(start..*self.ends.get(place)?)
    }
}

/// Finds the ends of the first `most` values of a row, which is the first `length` bytes.
#[inline]
fn split(rest: &[u8], length: usize, separator: u8, most: usize, ends: &mut Vec<usize>) {
    ends.clear();
    find_all(rest, length, separator, |end| {
        ends.push(end);
        ends.len() < most
    });
    if ends.len() < most {
        ends.push(length);
    }
}

/// The values of a row that has quotation marks.
fn quoted(line: &[u8], separator: u8) -> std::result::Result<csv::ByteRecord, String> {
    let mut reader = csv::ReaderBuilder::new().delimiter(separator).has_headers(false).flexible(true).from_reader(line);
    let mut record = csv::ByteRecord::new();
    reader.read_byte_record(&mut record).map_err(|error| error.to_string())?;
    Ok(record)
}

/// The length of the next row, line end included.
enum NextRow {
    Whole(usize),
    /// The file ends within the row.
    Incomplete,
    /// The row has no end within the length of a line.
    TooLong,
    None,
}

#[inline]
fn next_row(source: &mut ByteWindow) -> std::io::Result<NextRow> {
    let mut from = 0;
    let mut is_quoted = false;
    loop {
        let rest = source.rest();
        let end = memchr::memchr(b'\n', &rest[from..]).map(|place| from + place + 1);
        if end.unwrap_or(rest.len()) > LINE.count() {
            return Ok(NextRow::TooLong);
        }
        match end {
            Some(end) => {
                // A line end between quotation marks is part of a value.
                is_quoted ^= source.is_marked() && memchr::memchr_iter(b'"', &rest[from..end]).count() % 2 == 1;
                if !is_quoted {
                    return Ok(NextRow::Whole(end));
                }
                from = end;
            }
            None if source.more()? => {}
            None => return Ok(if is_empty(source.rest()) { NextRow::None } else { NextRow::Incomplete }),
        }
    }
}

fn too_long(path: &Path, source: &ByteWindow) -> Error {
    let why = if source.is_marked() { ": a quotation mark that is not closed?" } else { "" };
    Error::line(path, source.line(), format!("{}{why}", longer("the row", &LINE)))
}

fn trimmed(line: &[u8]) -> &[u8] {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    line.strip_suffix(b"\r").unwrap_or(line)
}

fn is_empty(line: &[u8]) -> bool {
    trimmed(line).is_empty()
}
