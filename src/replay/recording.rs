//! SUMO's fcd-output, step by step: XML or CSV, plain or gzipped, in memory that does not grow with the file.

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
    persons: usize,
    gone: Vec<u32>,
}

impl Step {
    /// Who is in the scene.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// How many of them are persons.
    pub fn persons(&self) -> usize {
        self.persons
    }

    /// Who was there in the step before and is not in this one, by [`Row::user`], in ascending order.
    pub fn gone(&self) -> &[u32] {
        &self.gone
    }

    pub(super) fn begin(&mut self, time: Second, users: &mut Users) {
        self.time = time;
        self.rows.clear();
        self.persons = 0;
        users.begin();
    }

    pub(super) fn end(&mut self, users: &mut Users) {
        self.gone.clear();
        self.gone.extend_from_slice(users.end());
    }

    /// Adds a row; `place` is what its format calls a place for a value.
    #[inline]
    pub(super) fn add(&mut self, fields: &Fields, users: &mut Users, place: &str) -> std::result::Result<(), String> {
        let [id, type_name, lane, _] = fields.texts;
        let [x, y, angle, speed, z, position, lateral_speed] = fields.numbers;
        if id.is_empty() || (x + y + angle + speed).is_nan() {
            fields.check(place)?;
        }
        let known = users.know(id, fields.person, type_name, lane)?;
        if fields.extent == Extent::Lanes && known.keeps_lane {
            return Ok(());
        }
        let (user, type_name, lane) = (known.user, known.type_name, known.lane);
        let person = fields.person;
        self.persons += usize::from(person);
        self.rows.push(Row { user, person, type_name, lane, x, y, z, angle, speed, position, lateral_speed });
        Ok(())
    }
}

/// An attribute or column that matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attribute {
    /// Of [`TEXTS`].
    Text(u8),
    /// Of [`NUMBERS`].
    Number(u8),
}

const TEXTS: [&str; 4] = ["id", "type", "lane", "edge"];
/// The first four have to be given.
const NUMBERS: [&str; 7] = ["x", "y", "angle", "speed", "z", "pos", "speedLat"];

/// What is read of every row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    All,
    /// Of those who came into the scene or onto another lane: who, and which lane.
    Lanes,
}

impl Extent {
    const ID: Attribute = Attribute::Text(0);
    const LANE: Attribute = Attribute::Text(2);
    const EDGE: Attribute = Attribute::Text(3);

    pub fn attribute(self, name: &[u8]) -> Option<Attribute> {
        let place = |names: &[&str]| names.iter().position(|known| known.as_bytes() == name).map(|place| place as u8);
        let attribute = place(&TEXTS).map(Attribute::Text).or_else(|| place(&NUMBERS).map(Attribute::Number));
        attribute.filter(|attribute| self == Self::All || [Self::ID, Self::LANE, Self::EDGE].contains(attribute))
    }

    #[inline]
    pub fn fields<'a>(self) -> Fields<'a> {
        let given = if self == Self::All { f64::NAN } else { 0.0 };
        Fields { extent: self, person: false, texts: [b""; 4], numbers: [given, given, given, given, 0.0, 0.0, 0.0] }
    }
}

impl Attribute {
    /// Another bit for each.
    #[inline]
    pub fn bit(self) -> u32 {
        match self {
            Self::Text(text) => 1 << text,
            Self::Number(number) => 1 << 8 << number,
        }
    }
}

/// A row as its text is read.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    extent: Extent,
    pub person: bool,
    texts: [&'a [u8]; 4],
    numbers: [f64; 7],
}

impl<'a> Fields<'a> {
    #[inline]
    pub fn set(&mut self, attribute: Attribute, value: &'a [u8]) -> std::result::Result<(), String> {
        match attribute {
            Attribute::Text(text) => self.texts[usize::from(text)] = value,
            Attribute::Number(place) => match number(value) {
                Some(number) => self.numbers[usize::from(place)] = number,
                None => return Err(no_number(NUMBERS[usize::from(place)], value)),
            },
        }
        Ok(())
    }

    /// Says by where it is whether it is a person: SUMO has vehicles on a lane and persons on an edge.
    #[inline]
    pub fn tell_apart(&mut self) {
        let [_, _, lane, edge] = self.texts;
        if lane.is_empty() != edge.is_empty() {
            self.person = lane.is_empty();
        }
    }

    pub fn is_of_nobody(&self) -> bool {
        self.texts[0].is_empty()
    }

    /// Whether all is given that has to be.
    #[cold]
    fn check(&self, place: &str) -> std::result::Result<(), String> {
        let missing = NUMBERS.iter().zip(&self.numbers).take(4).find(|(_, number)| number.is_nan());
        match missing.map(|(name, _)| *name).filter(|_| !self.is_of_nobody()) {
            None if !self.is_of_nobody() => Ok(()),
            missing => {
                let id = String::from_utf8_lossy(self.texts[0]);
                Err(format!("\"{id}\" has no {place} {}", missing.unwrap_or(TEXTS[0])))
            }
        }
    }
}

#[cold]
fn no_number(name: &str, value: &[u8]) -> String {
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
        Self::from_source(path, crate::net::open(path)?, Extent::All)
    }

    /// Opens a recording for its lanes only: a step has rows of those who came into the scene or onto another lane, and
    /// all types and numbers in them are empty.
    pub(super) fn open_for_lanes(path: &Path) -> Result<Self> {
        Self::from_source(path, crate::net::open(path)?, Extent::Lanes)
    }

    /// The recording in a text; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`Recording::open`] has them.
    pub fn parse(path: &Path, text: impl Into<Vec<u8>>) -> Result<Self> {
        Self::from_source(path, Box::new(std::io::Cursor::new(text.into())), Extent::All)
    }

    fn from_source(path: &Path, reader: Box<dyn BufRead>, extent: Extent) -> Result<Self> {
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
            Some(b'<') => Format::Xml(Box::new(XmlRecording::new(path, source, extent)?)),
            Some(_) => Format::Csv(Box::new(CsvRecording::new(path, source, extent)?)),
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
