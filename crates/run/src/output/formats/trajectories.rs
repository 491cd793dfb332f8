//! Trajectories in the format of FHWA's Surrogate Safety Assessment Model (Open Source SSAM File Format 3.0).
//!
//! FORMAT, DIMENSIONS, then for each step TIMESTEP and a VEHICLE record per vehicle, little-endian, in metres. Each
//! vehicle has its own length and width, and its acceleration is that between its last two steps. Its rear is behind its
//! front along its heading. Persons are omitted because SSAM does not know them.
//!
//! All numbers are f32, which have 24 bits: a UTM northing would be rounded to half a metre. The format has no origin:
//! the bounds in DIMENSIONS are in the coordinates of the vehicles, and SSAM ignores vehicles outside (`ValidateVehicle`
//! and `ZoneGrid` of its source). So where a net is far from SUMO's origin, bounds and vehicles are both given relative to
//! its low corner; times are relative to midnight before the first step. Up to 131 km and 36 hours they are right to 4 mm
//! and 4 ms.

use std::path::Path;

use rustc_hash::FxHashMap;
use typed_index_collections::TiVec;

use crate::Result;
use crate::util::output_file::OutputFile;
use closecall::geometry::rectangle::direction;
use closecall::geometry::{Bounds, Point, Vector};
use closecall::traffic::frame::{Frame, Row};
use closecall::traffic::net::{LaneIndex, Net};
use closecall::traffic::profile::Category;
use closecall::traffic::roster::{Roster, UserIndex};
use closecall::util::units::{Metre, MetrePerSecond, Second};

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
/// An f32 of up to this is right to 4 mm, in m.
pub const FAR: Metre = 131_072.0;
/// A vehicle's middle is at most this far outside the lanes' bounds, in m.
const MARGIN: Metre = 20.0;
const DAY: Second = 86_400.0;
/// The link of a vehicle that is not on a lane.
const NO_LINK: i32 = -1;

/// The trajectory file, and the state of the previous step that the next one needs.
#[derive(Debug)]
pub(crate) struct Trajectories {
    file: OutputFile,
    origin: Vector,
    /// Midnight before the first step; none before it.
    midnight: Option<Second>,
    /// By the roster's index.
    vehicles: TiVec<UserIndex, Option<PreviousStep>>,
    next_number: i32,
    /// The lanes of the rows that were placed in this step.
    placed: FxHashMap<u32, LaneIndex>,
    record: Vec<u8>,
}

fn bounds(net: &Net) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    net.lanes.iter().flat_map(|lane| &lane.shape).for_each(|point| bounds.include(*point));
    bounds
}

/// What places in the file are relative to: the corner of a net that is far from SUMO's origin.
pub fn origin(net: &Net) -> Vector {
    let bounds = bounds(net);
    let is_far = bounds.low.coords.amax().max(bounds.high.coords.amax()) > FAR;
    if is_far { bounds.low.coords.map(f64::floor) } else { Vector::zeros() }
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
        file.append(&[FORMAT, b'L'])?;
        file.append(&VERSION.to_le_bytes())?;
        // The flag that records have heights.
        file.append(&[1])?;
        let (bounds, origin) = (bounds(net), origin(net));
        let (low, high) = (bounds.low - origin, bounds.high - origin);
        file.append(&[DIMENSIONS, METRIC])?;
        file.append(&SCALE.to_le_bytes())?;
        for bound in [low.x - MARGIN, low.y - MARGIN, high.x + MARGIN, high.y + MARGIN] {
            file.append(&(bound.round() as i32).to_le_bytes())?;
        }
        Ok(Self {
            file,
            origin,
            midnight: None,
            vehicles: TiVec::new(),
            next_number: 0,
            placed: FxHashMap::default(),
            record: Vec::new(),
        })
    }

    /// Notes on which lane the vehicle of a row is. A vehicle without a note gets the nearest lane.
    pub fn place(&mut self, row: u32, lane: LaneIndex) {
        self.placed.insert(row, lane);
    }

    /// Forgets a vehicle that has left: its index may be reused.
    pub(crate) fn forget(&mut self, user: UserIndex) {
        if let Some(slot) = self.vehicles.get_mut(user) {
            *slot = None;
        }
    }

    /// Appends a step.
    pub(crate) fn write_step(&mut self, frame: &Frame, roster: &Roster, net: &Net) -> Result<()> {
        self.record.clear();
        self.record.push(TIMESTEP);
        let midnight = *self.midnight.get_or_insert((frame.time / DAY).floor() * DAY);
        self.record.extend(((frame.time - midnight) as f32).to_le_bytes());
        self.vehicles.resize_with(roster.len(), || None);
        for (row, Row { user, state }) in (0..).zip(frame.rows()) {
            let profile = roster.profile_of(user);
            if profile.category != Category::Vehicle {
                continue;
            }
            let slot = &mut self.vehicles[user];
            let before = slot.take();
            let acceleration =
                before.as_ref().map_or(0.0, |before| (state.speed - before.speed) / (frame.time - before.time));
            let number = before.map_or(self.next_number, |before| before.number);
            self.next_number = self.next_number.max(number + 1);
            *slot = Some(PreviousStep { number, time: frame.time, speed: state.speed });
            let front = Point::new(state.x, state.y);
            let rear = front - direction(state.heading) * profile.length;
            let lane = self.placed.get(&row).copied().or_else(|| net.lane_at(front)).map(|lane| &net.lanes[lane]);
            let link = lane.map_or(NO_LINK, |lane| lane.edge.0 as i32);
            let (front, rear) = (front - self.origin, rear - self.origin);
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
        self.file.append(&self.record)
    }

    /// Completes the file.
    pub fn finish(self) -> Result<()> {
        self.file.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::options::Options;
    use closecall::traffic::frame::State;
    use closecall::traffic::profile::Profile;
    use closecall::traffic::sumo_type::SumoType;

    /// The bounds, the time and the front of the only vehicle in the only step, of a net with a lane between two places.
    fn written([from, to]: [(f64, f64); 2], time: Second, at: (f64, f64)) -> ([i32; 4], f32, (f32, f32)) {
        let shape = format!("{},{} {},{}", from.0, from.1, to.0, to.1);
        let text = format!(r#"<net><edge id="e"><lane id="e_0" length="300" shape="{shape}"/></edge></net>"#);
        let net = crate::net::parse(Path::new("e.net.xml"), text).unwrap();
        let mut roster = Roster::default();
        let profile = roster.profile(Profile::vehicle(&SumoType::car("car"), &Options::default())).unwrap();
        let user = roster.enter("a", profile);
        let mut frame = Frame::default();
        frame.begin(time);
        frame.push(user, State { x: at.0, y: at.1, z: 0.0, heading: 0.0, speed: 9.0 });
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("e.trj");
        let mut file = Trajectories::create(&path, &net).unwrap();
        file.write_step(&frame, &roster, &net).unwrap();
        file.finish().unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        let float = |at| f32::from_le_bytes(word(at));
        // FORMAT has 7 bytes, DIMENSIONS 22, TIMESTEP 5; the front follows 10 bytes of VEHICLE.
        ([13, 17, 21, 25].map(|at| i32::from_le_bytes(word(at))), float(30), (float(44), float(48)))
    }

    #[test]
    fn places_of_a_utm_net_and_clock_times_keep_their_digits() {
        let (east, north) = (567_690.0, 5_431_900.0);
        let (bounds, time, front) =
            written([(east, north), (east + 400.0, north + 300.0)], 1_700_000_000.25, (east + 0.01, north + 0.02));
        assert_eq!(bounds, [-20, -20, 420, 320]);
        assert!((time - 80_000.25).abs() < 5e-3, "{time}");
        assert!((front.0 - 0.01).abs() < 5e-3 && (front.1 - 0.02).abs() < 5e-3, "{front:?}");
    }

    #[test]
    fn places_near_the_origin_are_those_of_sumo() {
        let (bounds, time, front) = written([(-300.0, 0.0), (4000.0, 0.0)], 25_200.5, (12.5, 0.0));
        assert_eq!((bounds, time, front), ([-320, -20, 4020, 20], 25_200.5, (12.5, 0.0)));
    }
}
