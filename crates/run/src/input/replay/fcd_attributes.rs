//! The values of a row of a recording while it is read: which matter, and whether they are possible.

use super::number::number;
use closecall::traffic::frame::is_nowhere;
use closecall::util::limits::{ANGLE, HEIGHT, LANE_LENGTH, Limit, POSITION, SPEED};

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
pub(super) fn are_plausible([x, y, angle, speed, z, position, lateral_speed]: &[f64; 7]) -> bool {
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
pub(super) const SPEED_PLACE: usize = 3;

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
    pub scope: Scope,
    pub person: bool,
    pub texts: [&'a [u8]; 4],
    pub numbers: [f64; 7],
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
    pub(crate) fn set_number(&mut self, attribute: Attribute, value: f64) -> std::result::Result<(), String> {
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
    pub fn parse(&self, numbers: &mut [f64; 7]) -> std::result::Result<(), String> {
        let mut given = self.unparsed.iter().enumerate().filter(|(_, text)| !text.is_empty());
        given.try_for_each(|(place, text)| parse(place, text).map(|number| numbers[place] = number))
    }

    /// Decides whether the row is a person's: SUMO gives vehicles a lane and persons an edge.
    #[inline]
    pub(crate) fn tell_apart(&mut self) {
        let [_, _, lane, edge] = self.texts;
        if lane.is_empty() != edge.is_empty() {
            self.person = lane.is_empty();
        }
    }

    /// Whether the row is a road user's. SUMO writes a row without an id, and without anything else but the time, for a step
    /// without road users.
    ///
    /// # Errors
    /// Where the row has no id, but other values.
    #[inline]
    pub(crate) fn is_user(&self) -> std::result::Result<bool, String> {
        if self.has_id() { Ok(true) } else { self.is_blank().map(|()| false) }
    }

    #[cold]
    fn is_blank(&self) -> std::result::Result<(), String> {
        let texts = TEXTS.iter().zip(&self.texts).find(|(_, text)| !text.is_empty());
        let texts = texts.map(|(name, text)| format!("{name} is \"{}\"", String::from_utf8_lossy(text)));
        let given =
            |(name, number): (&&str, &f64)| (!number.is_nan() && *number != 0.0).then(|| format!("{name} is {number}"));
        let blank = match self.scope {
            Scope::All => texts.or_else(|| NUMBERS.iter().zip(&self.numbers).find_map(given)),
            // The rows are read once more.
            Scope::Lanes => None,
        };
        blank.map_or(Ok(()), |value| Err(format!("a row without id, but {value}: whose is it?")))
    }

    fn has_id(&self) -> bool {
        !self.texts[0].is_empty()
    }

    /// Checks that the required values are given, and all of them possible.
    #[cold]
    pub fn check(&self, numbers: &[f64; 7], holder: &str) -> std::result::Result<(), String> {
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
