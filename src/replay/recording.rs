//! SUMO's fcd-output, step by step: XML or CSV, plain or gzipped, in memory that does not grow with the file.

use std::borrow::Cow;
use std::io::BufRead;
use std::path::Path;

use super::csv::CsvRecording;
use super::names::Users;
use super::number::number;
use super::source::Source;
use super::xml::XmlRecording;
use crate::units::{Metre, MetrePerSecond, Second};
use crate::{Error, Result};

/// What a recording says of one road user in one step, in SUMO's own terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Who it is: a number that nobody else has while it is in the scene. [`Recording::id`] is SUMO's id.
    pub user: u32,
    /// Whether it is a person.
    pub person: bool,
    /// Its type: see [`Recording::type_name`].
    pub type_name: u32,
    /// Its lane: see [`Recording::lane`].
    pub lane: u32,
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
    /// The way from the lane's beginning, in m.
    pub position: Metre,
    /// Speed to the left, in m/s; 0 where it is not given.
    pub lateral_speed: MetrePerSecond,
}

/// One step of a recording; its memory is used again for the next.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// Simulated time in s.
    pub time: Second,
    rows: Vec<Row>,
    gone: Vec<u32>,
}

impl Step {
    /// Who is in the scene.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Who was there in the step before and is not in this one, by [`Row::user`], in ascending order.
    pub fn gone(&self) -> &[u32] {
        &self.gone
    }

    pub(super) fn begin(&mut self, time: Second, users: &mut Users) {
        self.time = time;
        self.rows.clear();
        users.begin();
    }

    pub(super) fn end(&mut self, users: &mut Users) {
        self.gone.clear();
        self.gone.extend_from_slice(users.end());
    }

    /// Adds a row; `place` is what its format calls a place for a value.
    #[inline]
    pub(super) fn add(&mut self, fields: &Fields, users: &mut Users, place: &str) -> std::result::Result<(), String> {
        if let Some(missing) = fields.missing() {
            return Err(format!("\"{}\" has no {place} {missing}", String::from_utf8_lossy(&fields.id)));
        }
        let known = users.know(&fields.id, fields.person, &fields.type_name, &fields.lane)?;
        let Fields { person, x, y, z, angle, speed, position, lateral_speed, .. } = *fields;
        let (user, type_name, lane) = (known.user, known.type_name, known.lane);
        self.rows.push(Row { user, person, type_name, lane, x, y, z, angle, speed, position, lateral_speed });
        Ok(())
    }
}

/// The attributes or columns that matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attribute {
    Id,
    Type,
    Lane,
    X,
    Y,
    Z,
    Angle,
    Speed,
    Position,
    LateralSpeed,
}

impl Attribute {
    pub const ALL: [(Self, &str); 10] = [
        (Self::Id, "id"),
        (Self::X, "x"),
        (Self::Y, "y"),
        (Self::Z, "z"),
        (Self::Angle, "angle"),
        (Self::Type, "type"),
        (Self::Speed, "speed"),
        (Self::Position, "pos"),
        (Self::Lane, "lane"),
        (Self::LateralSpeed, "speedLat"),
    ];

    pub fn named(name: &[u8]) -> Option<Self> {
        Self::ALL.iter().find(|(_, known)| known.as_bytes() == name).map(|(attribute, _)| *attribute)
    }
}

/// A row as its text is read.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    pub id: Cow<'a, [u8]>,
    pub person: bool,
    type_name: Cow<'a, [u8]>,
    lane: Cow<'a, [u8]>,
    x: Metre,
    y: Metre,
    z: Metre,
    angle: f64,
    speed: MetrePerSecond,
    position: Metre,
    lateral_speed: MetrePerSecond,
}

impl<'a> Fields<'a> {
    pub const EMPTY: Self = Self {
        id: Cow::Borrowed(b""),
        person: false,
        type_name: Cow::Borrowed(b""),
        lane: Cow::Borrowed(b""),
        x: f64::NAN,
        y: f64::NAN,
        z: 0.0,
        angle: f64::NAN,
        speed: f64::NAN,
        position: 0.0,
        lateral_speed: 0.0,
    };

    #[inline]
    pub fn set(&mut self, attribute: Attribute, value: Cow<'a, [u8]>) -> std::result::Result<(), String> {
        let place = match attribute {
            Attribute::Id => return set(&mut self.id, value),
            Attribute::Type => return set(&mut self.type_name, value),
            Attribute::Lane => return set(&mut self.lane, value),
            Attribute::X => &mut self.x,
            Attribute::Y => &mut self.y,
            Attribute::Z => &mut self.z,
            Attribute::Angle => &mut self.angle,
            Attribute::Speed => &mut self.speed,
            Attribute::Position => &mut self.position,
            Attribute::LateralSpeed => &mut self.lateral_speed,
        };
        match number(&value) {
            Some(number) => *place = number,
            None => return Err(no_number(attribute, &value)),
        }
        Ok(())
    }

    /// What is missing in it, if anything is.
    #[inline]
    fn missing(&self) -> Option<&'static str> {
        let given = [
            ("id", !self.id.is_empty()),
            ("x", !self.x.is_nan()),
            ("y", !self.y.is_nan()),
            ("angle", !self.angle.is_nan()),
            ("speed", !self.speed.is_nan()),
        ];
        given.into_iter().find(|(_, given)| !given).map(|(name, _)| name)
    }
}

#[inline]
fn set<'a>(place: &mut Cow<'a, [u8]>, value: Cow<'a, [u8]>) -> std::result::Result<(), String> {
    *place = value;
    Ok(())
}

#[cold]
fn no_number(attribute: Attribute, value: &[u8]) -> String {
    let name = Attribute::ALL.iter().find(|(known, _)| *known == attribute).map_or("", |(_, name)| name);
    format!("{name} is \"{}\", not a number", String::from_utf8_lossy(value))
}

/// A recording that is being read.
pub struct Recording {
    format: Format,
    users: Users,
}

enum Format {
    Xml(Box<XmlRecording>),
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

    fn from_source(path: &Path, reader: Box<dyn BufRead>) -> Result<Self> {
        const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
        let mut source = Source::new(reader);
        let first = loop {
            let rest = source.rest();
            let text = rest.strip_prefix(BYTE_ORDER_MARK).unwrap_or(rest);
            let first = text.iter().copied().find(|byte| !byte.is_ascii_whitespace());
            if first.is_some() && rest.len() >= BYTE_ORDER_MARK.len() {
                break first;
            }
            if !source.more().map_err(|error| Error::file(path, error))? {
                break first;
            }
        };
        if source.rest().starts_with(BYTE_ORDER_MARK) {
            source.consume(BYTE_ORDER_MARK.len());
        }
        let format = match first {
            None => return Err(Error::content(path, "the file is empty")),
            Some(b'<') => Format::Xml(Box::new(XmlRecording::new(path, source)?)),
            Some(_) => Format::Csv(Box::new(CsvRecording::new(path, source)?)),
        };
        Ok(Self { format, users: Users::default() })
    }

    /// Reads the next step; `false` where the recording ends.
    ///
    /// # Errors
    /// [`Error::CutShort`] where the file ends before its format does, [`Error::Line`] for what is not as it should be.
    pub fn next_step(&mut self, step: &mut Step) -> Result<bool> {
        match &mut self.format {
            Format::Xml(recording) => recording.next_step(step, &mut self.users),
            Format::Csv(recording) => recording.next_step(step, &mut self.users),
        }
    }

    /// SUMO's id of a road user of the last step read, or of those who had just gone then.
    pub fn id(&self, user: u32) -> &str {
        self.users.id(user)
    }

    /// SUMO's id of a type; empty where it is not given.
    pub fn type_name(&self, row: &Row) -> &str {
        self.users.types.text(row.type_name)
    }

    /// The id of a lane by [`Row::lane`]; empty where it is not given.
    pub fn lane(&self, lane: u32) -> &str {
        self.users.lanes.text(lane)
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

/// The error of a file that ends in mid-step.
pub(super) fn cut_short(path: &Path, last: Option<Second>, message: &str) -> Error {
    Error::CutShort { path: path.to_owned(), time: last.unwrap_or(f64::NAN), message: message.replace('\n', " ") }
}
