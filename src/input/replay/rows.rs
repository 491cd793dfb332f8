//! One step of a recording, row by row: what the readers of both formats return.

use std::path::Path;

use super::names::{Numbers, Users};
use super::number::number;
use crate::Error;
use crate::traffic::frame::is_nowhere;
use crate::traffic::net::projection::Projection;
use crate::util::limits::{ANGLE, HEIGHT, LANE_LENGTH, Limit, POSITION, SPEED, TIME};
use crate::util::units::{Metre, MetrePerSecond, Second};

/// One road user in one step of a recording, in SUMO's own terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedRow {
    /// The road user: a number that is unique while it is in the scene. [`Recording::id`](super::recording::Recording::id) is SUMO's id.
    pub user: u32,
    /// Whether it is a person.
    pub person: bool,
    /// Its type: see [`Recording::type_name`](super::recording::Recording::type_name).
    pub type_name: u32,
    /// Its lane: see [`Recording::lane`](super::recording::Recording::lane).
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
    /// Distance from the lane's beginning, in m; NaN if it is not given.
    pub position: Metre,
    /// Speed to the left, in m/s; 0 if it is not given.
    pub lateral_speed: MetrePerSecond,
}

/// One step of a recording; its memory is reused for the next.
#[derive(Clone, Debug, Default)]
pub struct RecordedStep {
    /// Simulated time in s.
    pub time: Second,
    rows: Vec<RecordedRow>,
    persons: usize,
    gone: Vec<u32>,
}

impl RecordedStep {
    /// The road users in the scene.
    pub fn rows(&self) -> &[RecordedRow] {
        &self.rows
    }

    /// The number of persons among them.
    pub fn persons(&self) -> usize {
        self.persons
    }

    /// The road users of the previous step that are not in this one, by [`RecordedRow::user`], in ascending order.
    pub fn gone(&self) -> &[u32] {
        &self.gone
    }

    /// Moves all road users from degrees to metres.
    ///
    /// # Errors
    /// A message that names a position without a place in the net.
    pub(super) fn project(&mut self, projection: &Projection) -> Result<(), String> {
        for row in &mut self.rows {
            let place = projection.place(row.x, row.y);
            let place =
                place.ok_or_else(|| format!("({}, {}) are not degrees of longitude and latitude", row.x, row.y))?;
            (row.x, row.y) = (place.x, place.y);
        }
        Ok(())
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

    /// Adds a row; `holder` is what the format calls the holder of a value.
    #[inline]
    pub(super) fn add(&mut self, fields: &Fields, users: &mut Users, holder: &str) -> std::result::Result<(), String> {
        let [id, type_name, lane, _] = fields.texts;
        if id.is_empty() {
            fields.check(&fields.numbers, holder)?;
        }
        let numbers = users.number(id, fields.person, type_name, lane)?;
        let mut values = fields.numbers;
        if fields.scope == Scope::Lanes {
            if numbers.keeps_lane {
                return Ok(());
            }
            fields.parse(&mut values)?;
        }
        let [x, y, angle, speed, z, position, lateral_speed] = values;
        if !are_possible(&values) {
            fields.check(&values, holder)?;
        }
        let Numbers { user, type_name, lane, .. } = numbers;
        let person = fields.person;
        self.persons += usize::from(person);
        self.rows.push(RecordedRow { user, person, type_name, lane, x, y, z, angle, speed, position, lateral_speed });
        Ok(())
    }
}

/// An attribute or column that matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Attribute {
    /// The index of one of [`TEXTS`].
    Text(u8),
    /// The index of one of [`NUMBERS`].
    Number(u8),
}

const TEXTS: [&str; 4] = ["id", "type", "lane", "edge"];

/// The first four are required.
const NUMBERS: [&str; 7] = ["x", "y", "angle", "speed", "z", "pos", "speedLat"];

/// The limits of [`NUMBERS`].
const LIMITS: [Limit; 7] = [POSITION, POSITION, ANGLE, SPEED, HEIGHT, ALONG, ASIDE];
/// The position along a lane, also of a vehicle that is just before its beginning.
const ALONG: Limit = Limit { least: -LANE_LENGTH.most, ..LANE_LENGTH };
/// A speed to either side.
const ASIDE: Limit = Limit { least: -SPEED.most, ..SPEED };

/// Whether all values are within their limits, or not given where that is possible.
#[inline]
fn are_possible([x, y, angle, speed, z, position, lateral_speed]: &[f64; 7]) -> bool {
    POSITION.holds(*x)
        & POSITION.holds(*y)
        & ANGLE.holds(*angle)
        & SPEED.holds(*speed)
        & HEIGHT.holds(*z)
        & (ALONG.holds(*position) | position.is_nan())
        & ASIDE.holds(*lateral_speed)
}

/// The first of [`NUMBERS`] tell where a road user is and where it heads.
const PLACE: usize = 3;

/// How much of every row is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    All,
    /// Only the id, the lane, the place and the angle, and only for road users that entered the scene or changed lanes.
    Lanes,
}

impl Scope {
    const ID: Attribute = Attribute::Text(0);
    const LANE: Attribute = Attribute::Text(2);
    const EDGE: Attribute = Attribute::Text(3);

    pub fn attribute(self, name: &[u8]) -> Option<Attribute> {
        let place = |names: &[&str]| names.iter().position(|known| known.as_bytes() == name).map(|place| place as u8);
        let attribute = place(&TEXTS).map(Attribute::Text).or_else(|| place(&NUMBERS).map(Attribute::Number));
        attribute.filter(|attribute| match attribute {
            _ if self == Self::All => true,
            Attribute::Text(_) => [Self::ID, Self::LANE, Self::EDGE].contains(attribute),
            Attribute::Number(number) => usize::from(*number) < PLACE,
        })
    }

    #[inline]
    pub fn fields<'a>(self) -> Fields<'a> {
        let speed = if self == Self::All { f64::NAN } else { 0.0 };
        Fields {
            scope: self,
            person: false,
            texts: [b""; 4],
            numbers: [f64::NAN, f64::NAN, f64::NAN, speed, 0.0, f64::NAN, 0.0],
            unparsed: [b""; PLACE],
        }
    }
}

impl Attribute {
    /// A bit of its own for each attribute.
    #[inline]
    pub fn bit(self) -> u32 {
        match self {
            Self::Text(text) => 1 << text,
            Self::Number(number) => 1 << 8 << number,
        }
    }
}

/// The values of a row while it is read.
#[derive(Debug)]
pub(super) struct Fields<'a> {
    scope: Scope,
    pub person: bool,
    texts: [&'a [u8]; 4],
    numbers: [f64; 7],
    /// The place in [`Scope::Lanes`]: it is parsed only in the few rows that are returned.
    unparsed: [&'a [u8]; PLACE],
}

impl<'a> Fields<'a> {
    #[inline]
    pub fn set(&mut self, attribute: Attribute, value: &'a [u8]) -> std::result::Result<(), String> {
        match attribute {
            Attribute::Text(text) => self.texts[usize::from(text)] = value,
            Attribute::Number(place) if self.scope == Scope::Lanes => self.unparsed[usize::from(place)] = value,
            Attribute::Number(place) => self.numbers[usize::from(place)] = parse(usize::from(place), value)?,
        }
        Ok(())
    }

    /// Sets a field that is a number in the file.
    #[cfg_attr(not(feature = "parquet"), allow(dead_code))]
    pub fn set_number(&mut self, attribute: Attribute, value: f64) -> std::result::Result<(), String> {
        match attribute {
            Attribute::Number(place) if value.is_finite() => self.numbers[usize::from(place)] = value,
            Attribute::Number(place) => {
                return Err(not_a_number(NUMBERS[usize::from(place)], value.to_string().as_bytes()));
            }
            Attribute::Text(place) => return Err(format!("{} is a number", TEXTS[usize::from(place)])),
        }
        Ok(())
    }

    /// Parses the place.
    fn parse(&self, numbers: &mut [f64; 7]) -> std::result::Result<(), String> {
        let mut given = self.unparsed.iter().enumerate().filter(|(_, text)| !text.is_empty());
        given.try_for_each(|(place, text)| parse(place, text).map(|number| numbers[place] = number))
    }

    /// Decides whether the row is a person's: SUMO gives vehicles a lane and persons an edge.
    #[inline]
    pub fn tell_apart(&mut self) {
        let [_, _, lane, edge] = self.texts;
        if lane.is_empty() != edge.is_empty() {
            self.person = lane.is_empty();
        }
    }

    pub fn has_id(&self) -> bool {
        !self.texts[0].is_empty()
    }

    /// Checks that the required values are given, and all of them possible.
    #[cold]
    fn check(&self, numbers: &[f64; 7], holder: &str) -> std::result::Result<(), String> {
        let missing = NUMBERS.iter().zip(numbers).take(4).find(|(_, number)| number.is_nan());
        match missing.map(|(name, _)| *name).filter(|_| self.has_id()) {
            None if self.has_id() => {
                let mut given = NUMBERS.iter().zip(numbers).zip(&LIMITS).filter(|((_, number), _)| !number.is_nan());
                let id = String::from_utf8_lossy(self.texts[0]);
                given.try_for_each(|((name, number), limit)| {
                    if is_nowhere(*number) {
                        return Ok(());
                    }
                    limit.check(name, *number).map(|_| ()).map_err(|why| format!("\"{id}\": {why}"))
                })
            }
            missing => {
                let id = String::from_utf8_lossy(self.texts[0]);
                Err(format!("\"{id}\" has no {holder} {}", missing.unwrap_or(TEXTS[0])))
            }
        }
    }
}

#[inline]
fn parse(place: usize, text: &[u8]) -> std::result::Result<f64, String> {
    number(text).ok_or_else(|| not_a_number(NUMBERS[place], text))
}

#[cold]
fn not_a_number(name: &str, value: &[u8]) -> String {
    format!("{name} is \"{}\", not a number", String::from_utf8_lossy(value))
}

/// Checks that times increase.
pub(super) fn in_order(last: Option<Second>, time: Second) -> std::result::Result<(), String> {
    match last {
        Some(last) if time <= last => Err(format!("time {time} s follows {last} s")),
        _ => TIME.check("time", time).map(|_| ()),
    }
}

/// The error for a file that ends within a step.
pub(super) fn cut_short(path: &Path, last: Option<Second>, message: &str) -> Error {
    Error::CutShort { path: path.to_owned(), time: last.unwrap_or(f64::NAN), message: message.replace('\n', " ") }
}
