//! fcd-output in CSV: one row per road user and step, the time in each; vehicles and persons have columns of their own.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use super::recording::{Row, Step, in_order};
use crate::units::Second;
use crate::{Error, Result};

/// A CSV recording that is being read.
pub struct CsvRecording {
    path: PathBuf,
    reader: csv::Reader<Whole>,
    record: csv::StringRecord,
    /// The row after `record`, if there is one: only then `record` is known to be whole.
    next: Option<csv::StringRecord>,
    /// Whether `record` holds a row that belongs to the next step.
    ahead: bool,
    time: usize,
    /// Per column the attribute that it stands for, and whether it is a person's.
    columns: Vec<Option<(String, bool)>>,
    last: Option<Second>,
}

impl CsvRecording {
    pub(super) fn new(path: &Path, mut source: Box<dyn BufRead>) -> Result<Self> {
        let start = source.fill_buf().map_err(|error| Error::file(path, error))?;
        let header = start.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let separator = if header.contains(&b';') { b';' } else { b',' };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .flexible(true)
            .from_reader(Whole { source, ends_in_row: false });
        let header = reader.headers().map_err(|error| Error::content(path, error.to_string()))?.clone();
        let time = header.iter().position(|name| name == "timestep_time");
        let Some(time) = time else {
            return Err(Error::content(path, "it is no fcd-output: there is no column timestep_time"));
        };
        let column = |name: &str| match name.split_once('_') {
            Some(("vehicle", attribute)) => Some((attribute.to_owned(), false)),
            Some(("person", attribute)) => Some((attribute.to_owned(), true)),
            _ => None,
        };
        for needed in ["id", "x", "y", "angle", "speed"] {
            if !header.iter().any(|name| name == format!("vehicle_{needed}") || name == format!("person_{needed}")) {
                return Err(Error::content(path, format!("there is no column vehicle_{needed}")));
            }
        }
        let columns = header.iter().map(column).collect();
        let (path, record, next) = (path.to_owned(), csv::StringRecord::new(), Some(csv::StringRecord::new()));
        let mut recording = Self { path, reader, record, next, ahead: false, time, columns, last: None };
        recording.look_ahead()?;
        Ok(recording)
    }

    pub(super) fn next_step(&mut self, step: &mut Step) -> Result<bool> {
        let mut begun = false;
        loop {
            if !self.ahead && !self.read()? {
                break;
            }
            self.ahead = false;
            let line = self.record.position().map_or(0, csv::Position::line);
            let wrong = |message: String| Error::line(&self.path, line, message);
            let text = self.record.get(self.time).unwrap_or_default();
            let time = text.parse::<f64>().map_err(|_| wrong(format!("timestep_time is \"{text}\"")))?;
            if begun && time != step.time {
                self.ahead = true;
                break;
            }
            if !begun {
                in_order(self.last, time).map_err(wrong)?;
                step.begin(time);
                begun = true;
            }
            let row = step.add();
            let filled = fill(row, &self.record, &self.columns);
            match filled {
                Ok(true) => {}
                Ok(false) => step.take_back(),
                Err(message) => return Err(wrong(message)),
            }
        }
        if begun {
            self.last = Some(step.time);
        }
        Ok(begun)
    }

    /// Goes on to the next row; `false` at the end of the file.
    fn read(&mut self) -> Result<bool> {
        let Some(next) = &mut self.next else { return Ok(false) };
        std::mem::swap(&mut self.record, next);
        self.look_ahead()?;
        if self.next.is_none() && self.reader.get_ref().ends_in_row {
            return Err(self.cut_short("the last row is incomplete"));
        }
        Ok(true)
    }

    fn look_ahead(&mut self) -> Result<()> {
        let Some(next) = &mut self.next else { return Ok(()) };
        match self.reader.read_record(next) {
            Ok(true) => {}
            Ok(false) => self.next = None,
            Err(error) if error.is_io_error() => return Err(self.cut_short(&error.to_string())),
            Err(error) => return Err(Error::content(&self.path, error.to_string())),
        }
        Ok(())
    }

    fn cut_short(&self, message: &str) -> Error {
        Error::CutShort { path: self.path.clone(), time: self.last.unwrap_or(f64::NAN), message: message.to_owned() }
    }
}

/// Fills a row; `false` where the record is of nobody (an empty step).
fn fill(
    row: &mut Row,
    record: &csv::StringRecord,
    columns: &[Option<(String, bool)>],
) -> std::result::Result<bool, String> {
    for (value, column) in record.iter().zip(columns) {
        let Some((name, person)) = column else { continue };
        if !value.is_empty() {
            row.person |= *person;
            row.set(name, value)?;
        }
    }
    match row.missing() {
        Some("id") => Ok(false),
        Some(missing) => Err(format!("\"{}\" has no value in column {missing}", row.id)),
        None => Ok(true),
    }
}

/// A source that knows whether its last byte ends a line.
struct Whole {
    source: Box<dyn BufRead>,
    ends_in_row: bool,
}

impl std::io::Read for Whole {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let length = self.source.read(buffer)?;
        if length > 0 {
            self.ends_in_row = buffer[length - 1] != b'\n';
        }
        Ok(length)
    }
}
