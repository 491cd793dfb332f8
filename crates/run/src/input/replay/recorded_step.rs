//! One step of a recording, row by row: what the readers of both formats return.

use std::path::Path;

use super::fcd_attributes::{Fields, SPEED_PLACE, Scope, are_plausible};
use super::names::{Numbers, Users};
use crate::Error;
use crate::net::projection::Projection;
use crate::util::decimal::Written;
use closecall::util::limits::{TIME, is_noise};
use closecall::util::units::{Metre, MetrePerSecond, Second};

/// One road user in one step of a recording, in SUMO's own terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedRow {
    /// The road user: a number that is unique while it is in the scene. [`Recording::id`](super::recording::Recording::id) is SUMO's id.
    pub user: u32,
    /// Whether it is a person.
    pub person: bool,
    /// Its type: see [`Recording::type_name`](super::recording::Recording::type_name).
    pub type_name: u32,
    /// Its lane, or a person's edge: see [`Recording::lane`](super::recording::Recording::lane).
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
    pub(super) left_out: LeftOut,
}

/// Counts of data that was changed or left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LeftOut {
    /// Elements that are neither vehicles nor persons.
    pub elements: u64,
    /// Speeds below 0 that are noise.
    pub below_zero: u64,
}

impl std::ops::AddAssign for LeftOut {
    fn add_assign(&mut self, other: Self) {
        self.elements += other.elements;
        self.below_zero += other.below_zero;
    }
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
        self.left_out = LeftOut::default();
        users.begin();
    }

    pub(super) fn end(&mut self, users: &mut Users) {
        self.gone.clear();
        self.gone.extend_from_slice(users.end());
    }

    /// Adds a row; `holder` is what the format calls the holder of a value.
    #[inline]
    pub(super) fn add(&mut self, fields: &Fields, users: &mut Users, holder: &str) -> std::result::Result<(), String> {
        let [id, type_name, lane, edge] = fields.texts;
        let lane = if fields.person && !edge.is_empty() { edge } else { lane };
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
        if !are_plausible(&values) {
            if is_noise(values[SPEED_PLACE]) {
                values[SPEED_PLACE] = 0.0;
                self.left_out.below_zero += 1;
            }
            fields.check(&values, holder)?;
        }
        let [x, y, angle, speed, z, position, lateral_speed] = values;
        let Numbers { user, type_name, lane, .. } = numbers;
        let person = fields.person;
        self.persons += usize::from(person);
        self.rows.push(RecordedRow { user, person, type_name, lane, x, y, z, angle, speed, position, lateral_speed });
        Ok(())
    }
}

/// Checks that times increase.
pub(super) fn in_order(last: Option<Second>, time: Second) -> std::result::Result<(), String> {
    match last {
        Some(last) if time <= last => Err(format!("time {} s follows {} s", Written(time), Written(last))),
        _ => TIME.check("time", time).map(|_| ()),
    }
}

/// The error for a file that ends within a step.
pub(super) fn cut_short(path: &Path, last: Option<Second>, message: &str) -> Error {
    Error::CutShort { path: path.to_owned(), time: last.unwrap_or(f64::NAN), message: message.replace('\n', " ") }
}
