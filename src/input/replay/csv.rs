//! fcd-output in CSV: one row per road user and step, the time in each.
//!
//! SUMO's xml2csv gives vehicles and persons columns of their own. SUMO itself gives both the same, and calls them after
//! whoever came first.

use std::path::{Path, PathBuf};

use super::names::Users;
use super::number::number;
use super::rows::{Attribute, Extent, Fields, Step, cut_short, in_order};
use super::source::{Source, find_all};
use crate::util::units::Second;
use crate::{Error, Result};

/// A CSV recording that is being read.
pub(super) struct CsvRecording {
    path: PathBuf,
    source: Source,
    extent: Extent,
    separator: u8,
    time: usize,
    /// The columns that say something.
    columns: Vec<Column>,
    /// Whether vehicles and persons share them.
    shared: bool,
    /// So many columns are looked at.
    looked_at: usize,
    /// Where the values of the row under way end.
    ends: Vec<usize>,
    /// The time of the step under way, as it is written: most rows have the same.
    time_text: Vec<u8>,
    last: Option<Second>,
}

#[derive(Clone, Copy, Debug)]
struct Column {
    /// Which one it is, from the left.
    place: usize,
    attribute: Option<Attribute>,
    person: bool,
}

impl CsvRecording {
    pub fn new(path: &Path, mut source: Source, extent: Extent) -> Result<Self> {
        source.look_out_for(b'"');
        let unusable = |error| Error::file(path, error);
        let header = loop {
            match record(&mut source).map_err(unusable)? {
                Record::Whole(length) if is_empty(&source.rest()[..length]) => source.consume(length),
                Record::Whole(length) => break length,
                Record::Incomplete => break source.rest().len(),
                Record::None => return Err(Error::content(path, "the file is empty")),
            }
        };
        let line = trimmed(&source.rest()[..header]);
        let separator = if line.contains(&b';') { b';' } else { b',' };
        let names = quoted(line, separator).map_err(|error| Error::content(path, error))?;
        let names = names.iter().map(|name| String::from_utf8_lossy(name)).collect::<Vec<_>>();
        let time = names.iter().position(|name| name == "timestep_time");
        let Some(time) = time else {
            return Err(Error::content(path, "it is no fcd-output: there is no column timestep_time"));
        };
        for needed in ["id", "x", "y", "angle", "speed"] {
            if !names.iter().any(|name| *name == format!("vehicle_{needed}") || *name == format!("person_{needed}")) {
                return Err(Error::content(path, format!("there is no column vehicle_{needed}")));
            }
        }
        let columns =
            names.iter().enumerate().filter_map(|(place, name)| column(place, name, extent)).collect::<Vec<_>>();
        let looked_at = 1 + columns.last().map_or(0, |last| last.place).max(time);
        let shared = ["vehicle_id", "person_id"].iter().any(|id| !names.iter().any(|name| name == id));
        source.consume(header);
        Ok(Self {
            path: path.to_owned(),
            source,
            extent,
            separator,
            time,
            columns,
            shared,
            looked_at,
            ends: Vec::new(),
            time_text: Vec::new(),
            last: None,
        })
    }

    pub fn next_step(&mut self, step: &mut Step, users: &mut Users) -> Result<bool> {
        let mut begun = false;
        loop {
            let cut = |message: &str| cut_short(&self.path, self.last, message);
            let length = match record(&mut self.source).map_err(|error| cut(&error.to_string()))? {
                Record::Whole(length) => length,
                Record::Incomplete => return Err(cut("the last row is incomplete")),
                Record::None => break,
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
                    split(self.source.rest(), line.len(), self.separator, self.looked_at, &mut self.ends);
                    None
                }
            };
            let plain = Values { line, ends: &self.ends };
            let value = |place: usize| quoted.as_ref().map_or_else(|| plain.get(place), |values| values.get(place));
            let time_text = value(self.time).unwrap_or_default();
            if !begun || time_text != self.time_text {
                let time = number(time_text);
                let said = || format!("timestep_time is \"{}\"", String::from_utf8_lossy(time_text));
                let time = time.ok_or_else(|| wrong(said()))?;
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
            let mut fields = self.extent.fields();
            set(&mut fields, &self.columns, value).map_err(wrong)?;
            if self.shared {
                fields.tell_apart();
            }
            // A step without anybody in it has a row of nobody.
            if !fields.is_of_nobody() {
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

fn column(place: usize, name: &str, extent: Extent) -> Option<Column> {
    let (person, attribute) = match name.split_once('_') {
        Some(("vehicle", attribute)) => (false, attribute),
        Some(("person", attribute)) => (true, attribute),
        _ => return None,
    };
    let attribute = extent.attribute(attribute.as_bytes());
    // A person's column says that it is a person, if nothing else.
    (person || attribute.is_some()).then_some(Column { place, attribute, person })
}

/// Sets what a row says, given its values by their places.
#[inline]
fn set<'a>(
    fields: &mut Fields<'a>,
    columns: &[Column],
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

/// The values of a row without quotation marks.
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

/// Where the first values of a row end, `most` of them; the row is the first `length` bytes.
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

/// The values of a row with quotation marks.
fn quoted(line: &[u8], separator: u8) -> std::result::Result<csv::ByteRecord, String> {
    let mut reader = csv::ReaderBuilder::new().delimiter(separator).has_headers(false).flexible(true).from_reader(line);
    let mut record = csv::ByteRecord::new();
    reader.read_byte_record(&mut record).map_err(|error| error.to_string())?;
    Ok(record)
}

/// How much of the rest is the next row, its line end included.
enum Record {
    Whole(usize),
    /// The file ends within it.
    Incomplete,
    None,
}

#[inline]
fn record(source: &mut Source) -> std::io::Result<Record> {
    let mut from = 0;
    loop {
        let rest = source.rest();
        let end = memchr::memchr(b'\n', &rest[from..]).map(|place| from + place + 1);
        match end {
            // A line end between quotation marks belongs to a value.
            Some(end) if source.is_marked() && memchr::memchr_iter(b'"', &rest[..end]).count() % 2 == 1 => from = end,
            Some(end) => return Ok(Record::Whole(end)),
            None => {
                from = if source.is_marked() { from } else { rest.len() };
                if !source.more()? {
                    return Ok(if is_empty(source.rest()) { Record::None } else { Record::Incomplete });
                }
            }
        }
    }
}

fn trimmed(line: &[u8]) -> &[u8] {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    line.strip_suffix(b"\r").unwrap_or(line)
}

fn is_empty(line: &[u8]) -> bool {
    trimmed(line).is_empty()
}
