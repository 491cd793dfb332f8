//! fcd-output in CSV: one row per road user and step, the time in each; vehicles and persons have columns of their own.

use std::path::{Path, PathBuf};

use super::names::Users;
use super::number::number;
use super::recording::{Attribute, Extent, Fields, Step, cut_short, in_order};
use super::source::{Source, find};
use crate::units::Second;
use crate::{Error, Result};

/// A CSV recording that is being read.
pub(super) struct CsvRecording {
    path: PathBuf,
    source: Source,
    extent: Extent,
    separator: u8,
    time: usize,
    /// What each column says, up to the last that says something.
    columns: Vec<Option<Column>>,
    /// The time of the step under way, as it is written: most rows have the same.
    time_text: Vec<u8>,
    last: Option<Second>,
}

#[derive(Clone, Copy, Debug)]
struct Column {
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
        let mut columns = names.iter().map(|name| column(name, extent)).collect::<Vec<_>>();
        columns.truncate(columns.iter().rposition(Option::is_some).map_or(0, |last| last + 1));
        source.consume(header);
        Ok(Self { path: path.to_owned(), source, extent, separator, time, columns, time_text: Vec::new(), last: None })
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
                false => None,
            };
            let time_text = match &quoted {
                Some(values) => values.get(self.time),
                None => Values { rest: Some(line), separator: self.separator }.nth(self.time),
            };
            let time_text = time_text.unwrap_or_default();
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
            let fields = match &quoted {
                Some(values) => fields(values.iter(), &self.columns, self.extent),
                None => fields(Values { rest: Some(line), separator: self.separator }, &self.columns, self.extent),
            };
            let fields = fields.map_err(wrong)?;
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

fn column(name: &str, extent: Extent) -> Option<Column> {
    let (person, attribute) = match name.split_once('_') {
        Some(("vehicle", attribute)) => (false, attribute),
        Some(("person", attribute)) => (true, attribute),
        _ => return None,
    };
    let attribute = extent.attribute(attribute.as_bytes());
    // A person's column says that it is a person, if nothing else.
    (person || attribute.is_some()).then_some(Column { attribute, person })
}

/// What a row says.
#[inline]
fn fields<'a>(
    values: impl Iterator<Item = &'a [u8]>,
    columns: &[Option<Column>],
    extent: Extent,
) -> std::result::Result<Fields<'a>, String> {
    let mut fields = extent.fields();
    for (column, value) in columns.iter().zip(values) {
        let Some(column) = column else { continue };
        if !value.is_empty() {
            fields.person |= column.person;
            if let Some(attribute) = column.attribute {
                fields.set(attribute, value)?;
            }
        }
    }
    Ok(fields)
}

/// The values of a row without quotation marks.
struct Values<'a> {
    rest: Option<&'a [u8]>,
    separator: u8,
}

impl<'a> Iterator for Values<'a> {
    type Item = &'a [u8];

    #[inline]
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        match find(rest, self.separator) {
            Some(end) => {
                self.rest = Some(&rest[end + 1..]);
                Some(&rest[..end])
            }
            None => self.rest.take(),
        }
    }
}

/// The values of a row with quotation marks.
struct Quoted(csv::ByteRecord);

impl Quoted {
    fn get(&self, index: usize) -> Option<&[u8]> {
        self.0.get(index)
    }

    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        self.0.iter()
    }
}

fn quoted(line: &[u8], separator: u8) -> std::result::Result<Quoted, String> {
    let mut reader = csv::ReaderBuilder::new().delimiter(separator).has_headers(false).flexible(true).from_reader(line);
    let mut record = csv::ByteRecord::new();
    reader.read_byte_record(&mut record).map_err(|error| error.to_string())?;
    Ok(Quoted(record))
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
