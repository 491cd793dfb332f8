//! Frame in, encounters out: both phases, one after the other.
//!
//! A pure function of the frames and placements it was given so far: no clock, no randomness, no input or output.

mod measure;
mod ways;

use std::sync::Arc;

use crate::accurate::{self, Cover, Meeting, side};
use crate::braking::{self, stopping_distance};
use crate::encounter::{Encounter, Placement};
use crate::frame::{Frame, Roster, UserIndex};
use crate::geometry::rectangle::{self, direction};
use crate::geometry::{Bounds, Point, Vector};
use crate::net::{EdgeIndex, Net};
use crate::options::{Mode, Options, PathModel};
use crate::path::lanes::{LanePath, Start};
use crate::path::{Pose, arc, turn};
use crate::precollision::{Circle, Search};
use crate::profile::{Category, Profile};
use crate::scene::Exclusions;
use crate::units::{Metre, Radian};

/// Two road users further apart in height than this are no pair, in m: one is on a bridge.
pub const LEVEL: Metre = 2.5;
/// What stands: slower than SUMO's own threshold for halting would be too coarse, so exactly 0.
const STANDS: f64 = 0.0;

/// How much each part of the detector had to do since the run began, and what it could leave out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Work {
    /// Road users, counted in every step.
    pub rows: u64,
    /// Pairs that phase 1 lets through.
    pub pairs: u64,
    /// Pairs left out because their circles do not meet.
    pub circles_apart: u64,
    /// Of these, left out because both stand.
    pub both_stand: u64,
    /// Of these, left out because one is on a bridge above the other.
    pub other_level: u64,
    /// Of these, left out because both are persons.
    pub both_persons: u64,
    /// Left out because the boxes around both ways do not meet.
    pub ways_apart: u64,
    /// Settled in one dimension.
    pub in_line: u64,
    /// Swept.
    pub swept: u64,
    /// Road users in pairs that were still on the path laid before.
    pub known_paths: u64,
    /// Road users with the heading of the last step.
    pub known_directions: u64,
}

/// Finds the encounters of one step after the other.
pub struct Detector {
    work: Work,
    options: Options,
    leaves_out: Exclusions,
    net: Option<Arc<Net>>,
    routes_may_change: bool,
    sublane: bool,
    search: Search,
    memory: Vec<Memory>,
    circles: Vec<Circle>,
    briefs: Vec<Brief>,
    rows: Vec<Row>,
    pairs: Vec<(u32, u32)>,
    unplaced: Vec<u32>,
    poses: Vec<Pose>,
    covers: Vec<Cover>,
    scratch: [Vec<Pose>; 2],
    encounters: Vec<Encounter>,
}

/// What is remembered of a road user from step to step.
#[derive(Clone, Debug, Default)]
struct Memory {
    path: LanePath,
    last: Option<(Point, Vector)>,
    curvature: f64,
}

/// What decides, before anything else, whether a pair is one.
#[derive(Clone, Copy, Debug)]
struct Brief {
    z: Metre,
    moves: bool,
    category: Category,
}

/// What is known of a frame's row in the step under way.
#[derive(Clone, Copy, Debug)]
struct Row {
    heading: Radian,
    axis: Vector,
    stop: Metre,
    in_pair: bool,
    on_lanes: bool,
    poses: (u32, u32),
    straight: bool,
    /// The box around all that it covers on the way.
    bounds: Bounds,
    /// Where its covers begin, that of the whole way and those from pose to pose; none as long as nobody asked.
    covers: Option<u32>,
}

impl Detector {
    /// A detector for a scene; without a net every path is straight (or an arc, if so chosen).
    pub fn new(options: &Options, net: Option<Arc<Net>>) -> Self {
        Self {
            work: Work::default(),
            options: options.clone(),
            leaves_out: Exclusions::of(options),
            net,
            routes_may_change: true,
            sublane: false,
            search: Search::default(),
            memory: Vec::new(),
            circles: Vec::new(),
            briefs: Vec::new(),
            rows: Vec::new(),
            pairs: Vec::new(),
            unplaced: Vec::new(),
            poses: Vec::new(),
            covers: Vec::new(),
            scratch: [Vec::new(), Vec::new()],
            encounters: Vec::new(),
        }
    }

    /// Says whether no road user's route changes while it is in the scene, so that a path once laid holds until the
    /// road user leaves it; without such word routes may change.
    pub fn set_fixed_routes(&mut self, fixed: bool) {
        self.routes_may_change = !fixed;
    }

    /// Whether no road user's route changes while it is in the scene.
    pub fn has_fixed_routes(&self) -> bool {
        !self.routes_may_change
    }

    /// Says whether road users move to the side without changing lanes (SUMO's sublane model).
    pub fn set_sublane(&mut self, sublane: bool) {
        self.sublane = sublane;
    }

    /// What is left out.
    pub fn leaves_out(&self) -> Exclusions {
        self.leaves_out
    }

    /// What was done so far.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Forgets a road user that has left the scene: its index may be given to another.
    pub fn forget(&mut self, user: UserIndex) {
        if let Some(memory) = self.memory.get_mut(user.0 as usize) {
            memory.path.clear();
            memory.last = None;
            memory.curvature = 0.0;
        }
    }

    /// Phase 1: which pairs may meet. Returns the frame's rows whose lane the detector has to know for phase 2;
    /// the caller says it with [`Detector::place`], and leaves out whom it cannot place.
    pub fn approach(&mut self, frame: &Frame, roster: &Roster) -> &[u32] {
        if self.memory.len() < roster.len() {
            self.memory.resize(roster.len(), Memory::default());
        }
        self.look(frame, roster);
        if self.leaves_out.circles_apart {
            self.search.pairs(&self.circles, &mut self.pairs);
        } else {
            let count = frame.len() as u32;
            self.pairs.clear();
            self.pairs.extend((0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))));
        }
        self.work.rows += frame.len() as u64;
        self.work.pairs += self.pairs.len() as u64;
        self.work.circles_apart += all_pairs(frame.len()) - self.pairs.len() as u64;
        let (briefs, work) = (&self.briefs, &mut self.work);
        self.pairs.retain(|&(a, b)| {
            let (a, b) = (&briefs[a as usize], &briefs[b as usize]);
            let is_obstacle = |brief: &Brief| brief.category == Category::Obstacle;
            let left_out = if !a.moves && !b.moves {
                &mut work.both_stand
            } else if (a.z - b.z).abs() > LEVEL && !is_obstacle(a) && !is_obstacle(b) {
                &mut work.other_level
            } else if a.category == Category::Person && b.category == Category::Person {
                &mut work.both_persons
            } else {
                return true;
            };
            *left_out += 1;
            false
        });
        self.unplaced.clear();
        for index in 0..self.pairs.len() {
            for row in [self.pairs[index].0, self.pairs[index].1] {
                if !std::mem::replace(&mut self.rows[row as usize].in_pair, true) {
                    self.follow(frame, row);
                }
            }
        }
        &self.unplaced
    }

    /// Every row's circle and what else follows from its state alone.
    fn look(&mut self, frame: &Frame, roster: &Roster) {
        self.circles.clear();
        self.briefs.clear();
        self.rows.truncate(frame.len());
        let arcs = self.options.path == PathModel::Arc;
        for (place, (&user, state)) in frame.users().iter().zip(frame.states()).enumerate() {
            let profile = roster.profile_of(user);
            // Most drive straight on, and most rows are the same road user's as in the last step.
            let axis = match self.rows.get(place) {
                Some(last) if self.leaves_out.known_directions && last.heading == state.heading => {
                    self.work.known_directions += 1;
                    last.axis
                }
                _ => direction(state.heading),
            };
            let front = Point::new(state.x, state.y);
            let moves = state.speed > STANDS;
            let stop = if moves { stopping_distance(state.speed, &profile.brakes) } else { 0.0 };
            self.circles.push(circle(roster, user, profile, front, axis, stop + self.options.epsilon));
            self.briefs.push(Brief { z: state.z, moves, category: profile.category });
            let row = Row {
                heading: state.heading,
                axis,
                stop,
                in_pair: false,
                on_lanes: false,
                poses: (0, 0),
                straight: false,
                bounds: Bounds::EMPTY,
                covers: None,
            };
            match self.rows.get_mut(place) {
                Some(last) => *last = row,
                None => self.rows.push(row),
            }
            if arcs {
                let memory = &mut self.memory[user.0 as usize];
                if let Some((last, last_axis)) = memory.last {
                    memory.curvature = arc::curvature(turn(&last_axis, &axis), (front - last).norm());
                }
                memory.last = Some((front, axis));
            }
        }
    }

    /// Follows a row's path along the lanes, or asks for its lane.
    fn follow(&mut self, frame: &Frame, row: u32) {
        let state = &frame.states()[row as usize];
        let by_lanes = self.options.path == PathModel::Lanes && self.options.mode == Mode::Closecall;
        let moving_vehicle =
            self.briefs[row as usize].moves && self.briefs[row as usize].category == Category::Vehicle && by_lanes;
        if !moving_vehicle || self.net.is_none() {
            return;
        }
        let memory = &mut self.memory[frame.users()[row as usize].0 as usize];
        self.rows[row as usize].on_lanes = memory.path.follow(Point::new(state.x, state.y));
        let is_known = self.leaves_out.known_paths && !self.routes_may_change && self.rows[row as usize].on_lanes;
        if is_known {
            self.work.known_paths += 1;
        } else {
            self.unplaced.push(row);
        }
    }

    /// Whether the road user of a row is still on the path that was laid for this route.
    pub fn keeps_path(&self, frame: &Frame, row: u32, route: &Arc<[EdgeIndex]>) -> bool {
        let user = frame.users()[row as usize];
        self.rows[row as usize].on_lanes && self.memory[user.0 as usize].path.is_for(route)
    }

    /// Where the road user of a row is on the net.
    pub fn place(&mut self, frame: &Frame, roster: &Roster, row: u32, placement: &Placement) {
        let Some(net) = &self.net else { return };
        if self.keeps_path(frame, row, &placement.route) {
            return;
        }
        let user = frame.users()[row as usize];
        let memory = &mut self.memory[user.0 as usize];
        let state = &frame.states()[row as usize];
        let start = Start {
            front: Point::new(state.x, state.y),
            axis: self.rows[row as usize].axis,
            length: roster.profile_of(user).chord,
            width: roster.profile_of(user).width,
            speed: state.speed,
            sublane: self.sublane,
        };
        memory.path.lay(net, &start, placement);
        self.rows[row as usize].on_lanes = memory.path.track.is_laid();
    }

    /// Phase 2: the pairs that would meet, in the order of the frame's rows.
    pub fn detect(&mut self, frame: &Frame, roster: &Roster) -> &[Encounter] {
        self.encounters.clear();
        self.poses.clear();
        self.covers.clear();
        for row in 0..self.rows.len() {
            if self.rows[row].in_pair {
                self.lay_poses(frame, roster, row);
            }
        }
        let pairs = std::mem::take(&mut self.pairs);
        for &(a, b) in &pairs {
            let met = match self.options.mode {
                Mode::Closecall => self.meet(frame, roster, a, b),
                Mode::Paper => self.meet_on_paper(frame, roster, a, b),
            };
            self.encounters.extend(met);
        }
        self.pairs = pairs;
        &self.encounters
    }

    /// The path of a row's front bumper from where it is until it stands and ε further, as the last phase 2 laid it;
    /// empty for an obstacle and for who was in no pair.
    pub fn path(&self, row: u32) -> Vec<Point> {
        let (start, end) = self.rows[row as usize].poses;
        self.poses[start as usize..end as usize].iter().map(|pose| pose.front).collect()
    }

    fn meet(&mut self, frame: &Frame, roster: &Roster, a: u32, b: u32) -> Option<Encounter> {
        if !self.rows[a as usize].bounds.meet(&self.rows[b as usize].bounds) {
            self.work.ways_apart += 1;
            return None;
        }
        let (first, second) = (self.mover(frame, roster, a), self.mover(frame, roster, b));
        let (first, second, a, b) = if first.shape.is_empty() { (first, second, a, b) } else { (second, first, b, a) };
        let a_is_smaller = || roster.user(frame.users()[a as usize]).id <= roster.user(frame.users()[b as usize]).id;
        if side::touch_now(&first, &second) {
            let ego_is_a = !second.shape.is_empty() || a_is_smaller();
            let (ego, foe) = if ego_is_a { (&first, &second) } else { (&second, &first) };
            let foe_axis = foe.shape.is_empty().then_some(foe.rectangle.axis);
            let meeting = Meeting { ego_way: 0.0, foe_way: 0.0, ego: ego.rectangle, foe_axis, leads: true };
            let rows = if ego_is_a { (a, b) } else { (b, a) };
            return Some(self.measure(frame, roster, rows, &meeting, true));
        }
        let in_line = accurate::drive_in_line(&first, &second);
        let met = if in_line && self.leaves_out.in_line {
            let met = accurate::meet_in_one_dimension(&first, &second, &a_is_smaller);
            self.work.in_line += 1;
            met
        } else {
            self.cover(frame, roster, a);
            self.cover(frame, roster, b);
            let (first, second) = (self.mover(frame, roster, a), self.mover(frame, roster, b));
            if !first.cover.meets(&second.cover) {
                self.work.ways_apart += 1;
                return None;
            }
            let met = accurate::meet_swept(&first, &second, in_line, &a_is_smaller);
            self.work.swept += 1;
            met
        };
        let (ego_is_a, meeting) = met?;
        let rows = if ego_is_a { (a, b) } else { (b, a) };
        Some(self.measure(frame, roster, rows, &meeting, false))
    }

    fn meet_on_paper(&mut self, frame: &Frame, roster: &Roster, a: u32, b: u32) -> Option<Encounter> {
        let (first, second) = (self.mover(frame, roster, a), self.mover(frame, roster, b));
        if !first.shape.is_empty() || !second.shape.is_empty() {
            return None;
        }
        let found = accurate::paper::measure(&first, &second, &self.options);
        let (ego, foe) = if found.ego_is_a { (&first, &second) } else { (&second, &first) };
        let between = (foe.rectangle.centre - ego.rectangle.centre).norm();
        let radius = braking::stopping_distance_paper(ego.speed, ego.brakes) + self.options.epsilon;
        // Eq. 4: the ego's detection radius reaches the foe's front.
        if between - foe.rectangle.half_length > radius || !found.distance.is_finite() {
            return None;
        }
        let collision = rectangle::touches(&ego.rectangle, &foe.rectangle);
        let rows = if found.ego_is_a { (a, b) } else { (b, a) };
        let mut encounter = self.measure(frame, roster, rows, &found.meeting, collision);
        encounter.kind = found.kind;
        encounter.gap = found.distance;
        encounter.margin = encounter.gap - encounter.mu;
        Some(encounter)
    }
}

/// How many pairs so many road users are.
fn all_pairs(count: usize) -> u64 {
    let count = count as u64;
    count * count.saturating_sub(1) / 2
}

/// The circle that holds all that a road user may cover within `reach` m of way.
fn circle(roster: &Roster, user: UserIndex, profile: &Profile, front: Point, axis: Vector, reach: Metre) -> Circle {
    if profile.category == Category::Obstacle {
        let mut bounds = Bounds::EMPTY;
        for part in roster.user(user).shape.iter() {
            bounds.join(&part.bounds);
        }
        let centre = nalgebra::center(&bounds.low, &bounds.high);
        return Circle { x: centre.x, y: centre.y, radius: (bounds.high - bounds.low).norm() / 2.0 };
    }
    let centre = front - axis * (profile.length / 2.0);
    let diagonal = (profile.length * profile.length + profile.width * profile.width).sqrt();
    Circle { x: centre.x, y: centre.y, radius: reach + diagonal / 2.0 }
}
