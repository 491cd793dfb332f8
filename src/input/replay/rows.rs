//! One step of a recording, row by row: what both formats give out.

use std::path::Path;

use super::names::Users;
use super::number::number;
use crate::Error;
use crate::util::units::{Metre, MetrePerSecond, Second};

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
