//! SUMO's fcd-output, step by step: XML or CSV, plain or gzipped, in memory that does not grow with the file.

use std::io::BufRead;
use std::path::Path;

use super::csv::CsvRecording;
use super::xml::XmlRecording;
use crate::units::{Metre, MetrePerSecond, Second};
use crate::{Error, Result};

/// What a recording says of one road user in one step, in SUMO's own terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// SUMO's id.
    pub id: String,
    /// Whether it is a person.
    pub person: bool,
    /// SUMO's type id; empty where it is not given.
    pub type_name: String,
    /// Front-bumper centre, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// The same, z in m.
    pub z: Metre,
    /// Degrees clockwise from north.
    pub angle: f64,
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// The lane's id; empty where it is not given.
    pub lane: String,
    /// The way from the lane's beginning, in m.
    pub position: Metre,
    /// Speed to the left, in m/s; 0 where it is not given.
    pub lateral_speed: MetrePerSecond,
}

impl Row {
    pub(super) const EMPTY: Self = Self {
        id: String::new(),
        person: false,
        type_name: String::new(),
        x: f64::NAN,
        y: f64::NAN,
        z: 0.0,
        angle: f64::NAN,
        speed: f64::NAN,
        lane: String::new(),
        position: 0.0,
        lateral_speed: 0.0,
    };

    /// Makes it an empty row again; its memory is kept.
    pub(super) fn clear(&mut self) {
        self.id.clear();
        self.type_name.clear();
        self.lane.clear();
        self.person = false;
        (self.x, self.y, self.z, self.angle, self.speed) = (f64::NAN, f64::NAN, 0.0, f64::NAN, f64::NAN);
        (self.position, self.lateral_speed) = (0.0, 0.0);
    }

    /// Sets what an attribute or column of this name says; one that does not matter is passed over.
    pub(super) fn set(&mut self, name: &str, value: &str) -> std::result::Result<(), String> {
        let number = |value: &str| value.parse::<f64>().map_err(|_| format!("{name} is \"{value}\", not a number"));
        match name {
            "id" => self.id.push_str(value),
            "type" => self.type_name.push_str(value),
            "lane" => self.lane.push_str(value),
            "x" => self.x = number(value)?,
            "y" => self.y = number(value)?,
            "z" => self.z = number(value)?,
            "angle" => self.angle = number(value)?,
            "speed" => self.speed = number(value)?,
            "pos" => self.position = number(value)?,
            "speedLat" => self.lateral_speed = number(value)?,
            _ => {}
        }
        Ok(())
    }

    /// What is missing in it, if anything is.
    pub(super) fn missing(&self) -> Option<&'static str> {
        let given = [
            ("id", !self.id.is_empty()),
            ("x", !self.x.is_nan()),
            ("y", !self.y.is_nan()),
            ("angle", !self.angle.is_nan()),
        ];
        given.into_iter().chain([("speed", !self.speed.is_nan())]).find(|(_, given)| !given).map(|(name, _)| name)
    }
}

/// One step of a recording; its memory is used again for the next.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// Simulated time in s.
    pub time: Second,
    rows: Vec<Row>,
    used: usize,
}

impl Step {
    /// Who is in the scene.
    pub fn rows(&self) -> &[Row] {
        &self.rows[..self.used]
    }

    pub(super) fn begin(&mut self, time: Second) {
        self.time = time;
        self.used = 0;
    }

    /// A further row, empty.
    pub(super) fn add(&mut self) -> &mut Row {
        if self.used == self.rows.len() {
            self.rows.push(Row::EMPTY);
        }
        let row = &mut self.rows[self.used];
        row.clear();
        self.used += 1;
        row
    }

    /// Takes the last row back.
    pub(super) fn take_back(&mut self) {
        self.used -= 1;
    }
}

/// A recording that is being read.
pub enum Recording {
    /// `<fcd-export>`.
    Xml(Box<XmlRecording>),
    /// Rows with a header.
    Csv(Box<CsvRecording>),
}

impl Recording {
    /// Opens a recording; its first bytes say whether it is XML or CSV.
    ///
    /// # Errors
    /// An error that names the file: unreadable, empty, no fcd-output, a column that is missing.
    pub fn open(path: &Path) -> Result<Self> {
        Self::from_source(path, crate::net::open(path)?)
    }

    /// The recording in a text; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`Recording::open`] has them.
    pub fn parse(path: &Path, text: impl Into<Vec<u8>>) -> Result<Self> {
        Self::from_source(path, Box::new(std::io::Cursor::new(text.into())))
    }

    fn from_source(path: &Path, mut source: Box<dyn BufRead>) -> Result<Self> {
        let start = source.fill_buf().map_err(|error| Error::file(path, error))?;
        let first = start.iter().find(|byte| !byte.is_ascii_whitespace() && !b"\xef\xbb\xbf".contains(byte));
        match first {
            None => Err(Error::content(path, "the file is empty")),
            Some(b'<') => XmlRecording::new(path, source).map(|recording| Self::Xml(Box::new(recording))),
            Some(_) => CsvRecording::new(path, source).map(|recording| Self::Csv(Box::new(recording))),
        }
    }

    /// Reads the next step; `false` where the recording ends.
    ///
    /// # Errors
    /// [`Error::CutShort`] where the file ends before its format does, [`Error::Line`] for what is not as it should be.
    pub fn next_step(&mut self, step: &mut Step) -> Result<bool> {
        match self {
            Self::Xml(recording) => recording.next_step(step),
            Self::Csv(recording) => recording.next_step(step),
        }
    }
}

/// Times must not go back.
pub(super) fn in_order(last: Option<Second>, time: Second) -> std::result::Result<(), String> {
    match last {
        Some(last) if time <= last => Err(format!("time {time} s follows on {last} s")),
        _ if !time.is_finite() => Err(format!("time is {time}")),
        _ => Ok(()),
    }
}
