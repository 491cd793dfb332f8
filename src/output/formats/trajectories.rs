//! Trajectories in the format of FHWA's Surrogate Safety Assessment Model (Open Source SSAM File Format 3.0).
//!
//! FORMAT, DIMENSIONS, then for each step TIMESTEP and a VEHICLE record per vehicle, little-endian, in metres. Each
//! vehicle has its own length and width, and its acceleration is that between its last two steps. Its rear is behind its
//! front along its heading. Persons are omitted because SSAM does not know them.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::file::OutputFile;
use crate::Result;
use crate::geometry::Point;
use crate::geometry::rectangle::direction;
use crate::traffic::frame::{Frame, Row};
use crate::traffic::net::{LaneIndex, Net};
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{MetrePerSecond, Second};

/// The first byte of each record.
const FORMAT: u8 = 0;
const DIMENSIONS: u8 = 1;
const TIMESTEP: u8 = 2;
const VEHICLE: u8 = 3;
/// The version of the format.
const VERSION: f32 = 3.0;
/// `DIMENSIONS` in metres, one per unit.
const METRIC: u8 = 1;
const SCALE: f32 = 1.0;
/// The link of a vehicle that is not on a lane.
const NO_LINK: i32 = -1;

/// The trajectory file, and the state of the previous step that the next one needs.
#[derive(Debug)]
pub struct Trajectories {
    pub(super) file: OutputFile,
    /// By the roster's index.
    vehicles: Vec<Option<PreviousStep>>,
    next_number: i32,
    /// The lanes of the rows that were placed in this step.
    placed: FxHashMap<u32, LaneIndex>,
    record: Vec<u8>,
}

/// A vehicle in the previous step.
#[derive(Debug)]
struct PreviousStep {
    number: i32,
    time: Second,
    speed: MetrePerSecond,
}

impl Trajectories {
    /// Creates the file with its first two records.
    pub fn create(path: &Path, net: &Net) -> Result<Self> {
        let mut file = OutputFile::create(path)?;
        file.write(&[FORMAT, b'L'])?;
        file.write(&VERSION.to_le_bytes())?;
        // The flag that records have heights.
        file.write(&[1])?;
        let points = || net.lanes.iter().flat_map(|lane| &lane.shape);
        let (left, low) = points().fold((0.0, 0.0), |(x, y), point| (point.x.min(x), point.y.min(y)));
        let (right, high) = points().fold((0.0, 0.0), |(x, y), point| (point.x.max(x), point.y.max(y)));
        file.write(&[DIMENSIONS, METRIC])?;
        file.write(&SCALE.to_le_bytes())?;
        for bound in [f64::floor(left), f64::floor(low), f64::ceil(right), f64::ceil(high)] {
            file.write(&(bound as i32).to_le_bytes())?;
        }
        Ok(Self { file, vehicles: Vec::new(), next_number: 0, placed: FxHashMap::default(), record: Vec::new() })
    }

    /// Notes on which lane the vehicle of a row is. A vehicle without a note gets the nearest lane.
    pub fn place(&mut self, row: u32, lane: LaneIndex) {
        self.placed.insert(row, lane);
    }

    /// Forgets a vehicle that has left: its index may be reused.
    pub fn forget(&mut self, user: UserIndex) {
        if let Some(slot) = self.vehicles.get_mut(user.0 as usize) {
            *slot = None;
        }
    }

    /// Appends a step.
    pub fn write_step(&mut self, frame: &Frame, roster: &Roster, net: &Net) -> Result<()> {
        self.record.clear();
        self.record.push(TIMESTEP);
        self.record.extend((frame.time as f32).to_le_bytes());
        self.vehicles.resize_with(roster.len(), || None);
        for (row, Row { user, state }) in (0..).zip(frame.rows()) {
            let profile = roster.profile_of(user);
            if profile.category != Category::Vehicle {
                continue;
            }
            let slot = &mut self.vehicles[user.0 as usize];
            let before = slot.take();
            let acceleration =
                before.as_ref().map_or(0.0, |before| (state.speed - before.speed) / (frame.time - before.time));
            let number = before.map_or(self.next_number, |before| before.number);
            self.next_number = self.next_number.max(number + 1);
            *slot = Some(PreviousStep { number, time: frame.time, speed: state.speed });
            let front = Point::new(state.x, state.y);
            let rear = front - direction(state.heading) * profile.length;
            let lane =
                self.placed.get(&row).copied().or_else(|| net.lane_at(front)).map(|lane| &net.lanes[lane.0 as usize]);
            let link = lane.map_or(NO_LINK, |lane| lane.edge.0 as i32);
            self.record.push(VEHICLE);
            self.record.extend(number.to_le_bytes());
            self.record.extend(link.to_le_bytes());
            self.record.push(lane.map_or(0, |lane| lane.index.min(u8::MAX.into()) as u8));
            let numbers = [front.x, front.y, rear.x, rear.y, profile.length, profile.width, state.speed, acceleration];
            for number in numbers.into_iter().chain([state.z, state.z]) {
                self.record.extend((number as f32).to_le_bytes());
            }
        }
        self.placed.clear();
        self.file.write(&self.record)
    }

    /// Completes the file.
    pub fn finish(&mut self) -> Result<()> {
        self.file.flush()
    }
}
