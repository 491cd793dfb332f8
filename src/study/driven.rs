//! Where the vehicles of a recording really drove, and which pairs were in conflict on those ways.
//!
//! Phase 2 is closecall's own; its poses are those that followed in the recording, so that what differs from a path
//! model's result is the path model's doing.

use std::path::Path;

use ecow::EcoString;
use rustc_hash::FxHashMap;

use crate::Result;
use crate::braking::{Brakes, MuModel, stopping_distance};
use crate::detection::broad_phase::{Area, Circle, Search};
use crate::detection::narrow_phase::{self, ConflictPoint, Participant, SweptBounds, side};
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::{Point, Vector, cross};
use crate::input::replay::recording::Recording;
use crate::input::replay::rows::RecordedStep;
use crate::options::Options;
use crate::traffic::frame::{Frame, Row, State};
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{Metre, MetrePerSecond, Second};

/// Two within this of the limit are left aside: steps and sizes are rounded in a recording.
const NEAR: Metre = 0.75;
/// Who moves further to the side than this in one step was moved, not driven.
const SIDEWAYS: Metre = 0.3;
/// Two positions nearer than this are one: a vehicle that stands.
const STANDS: Metre = 1e-3;

/// Everybody's front-bumper centre and heading, step by step.
pub(super) struct Driven {
    traces: FxHashMap<String, Vec<(Second, Point, Vector)>>,
}

/// What really was of a pair in a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Truth {
    /// In conflict, with this gap.
    Conflict(Metre),
    /// Not in conflict.
    None,
    /// Not known: one left, stood, was moved to the side, or it is a matter of centimetres.
    Aside,
}

/// Both ids, the smaller first.
pub(super) type Pair = (EcoString, EcoString);

/// The pair of two road users.
pub(super) fn pair(roster: &Roster, a: UserIndex, b: UserIndex) -> Pair {
    let (a, b) = (roster.id(a).clone(), roster.id(b).clone());
    if a <= b { (a, b) } else { (b, a) }
}

impl Driven {
    /// Reads a recording.
    pub fn read(path: &Path) -> Result<Self> {
        let (mut recording, mut step) = (Recording::open(path)?, RecordedStep::default());
        let mut traces: FxHashMap<String, Vec<_>> = FxHashMap::default();
        while recording.next_step(&mut step)? {
            for row in step.rows() {
                let axis = direction((90.0 - row.angle).to_radians());
                let place = (step.time, Point::new(row.x, row.y), axis);
                let id = recording.id(row.user);
                match traces.get_mut(id) {
                    Some(trace) => trace.push(place),
                    None => _ = traces.insert(id.to_owned(), vec![place]),
                }
            }
        }
        Ok(Self { traces })
    }

    /// What really was of all pairs of a step that are near each other.
    pub fn truth(&self, frame: &Frame, roster: &Roster, options: &Options) -> FxHashMap<Pair, Truth> {
        let stops = frame.rows().map(|Row { user, state }| {
            if state.speed > 0.0 { stopping_distance(state.speed, &roster.profile_of(user).brakes) } else { 0.0 }
        });
        let stops = stops.collect::<Vec<_>>();
        let circles = frame.rows().zip(&stops).map(|(Row { user, state }, stop)| {
            let profile = roster.profile_of(user);
            Circle { x: state.x, y: state.y, radius: stop + profile.length + profile.width + options.epsilon }
        });
        let mut pairs = Vec::new();
        Search::default().pairs(&circles.map(Area::from).collect::<Vec<_>>(), &mut pairs);
        pairs.sort_unstable();
        let ways = frame.rows().zip(&stops).map(|(row, stop)| {
            let profile = roster.profile_of(row.user);
            let beyond = profile.length + profile.width + 30.0;
            let reach = [*stop, stop + options.epsilon, stop + options.epsilon + beyond];
            self.ahead(roster.id(row.user), frame.time, &reach)
        });
        let ways = ways.collect::<Vec<_>>();
        let judged = pairs.into_iter().filter(|(a, b)| {
            let speed = |row: &u32| frame.state(*row).speed;
            speed(a) > 0.0 || speed(b) > 0.0
        });
        let judge = |(a, b): (u32, u32)| {
            let (a, b) = (a as usize, b as usize);
            let truth = match (&ways[a], &ways[b]) {
                (Some(a_ways), Some(b_ways)) => {
                    let mover = |row: usize, ways| Way::of(frame, roster, row, stops[row], options.epsilon, ways);
                    judge(&mover(a, a_ways), &mover(b, b_ways), options)
                }
                _ => Truth::Aside,
            };
            (pair(roster, frame.user(a as u32), frame.user(b as u32)), truth)
        };
        judged.map(judge).collect()
    }

    /// The poses that followed on a time: where these ways end (the last one may not be reached) and at every step;
    /// none where the second is not reached, or somebody was moved to the side.
    fn ahead(&self, id: &str, time: Second, ways: &[Metre; 3]) -> Option<Vec<Pose>> {
        let trace = self.traces.get(id)?;
        let start = trace.partition_point(|(at, ..)| *at < time - 1e-6);
        let (_, front, axis) = *trace.get(start)?;
        let mut poses = vec![Pose { distance: 0.0, front, axis }];
        for (_, front, axis) in &trace[start + 1..] {
            let last = poses[poses.len() - 1];
            let moved = front - last.front;
            let length = moved.norm();
            if length < STANDS {
                continue;
            }
            if cross(&last.axis, &moved).abs() > SIDEWAYS + 0.5 * length {
                return None;
            }
            let way = last.distance + length;
            for asked in ways.iter().filter(|asked| last.distance < **asked && **asked < way) {
                let part = (asked - last.distance) / length;
                let turned = (last.axis + (axis - last.axis) * part).normalize();
                poses.push(Pose { distance: *asked, front: last.front + moved * part, axis: turned });
            }
            poses.push(Pose { distance: way, front: *front, axis: *axis });
            if way > ways[2] {
                break;
            }
        }
        (poses[poses.len() - 1].distance >= ways[1]).then_some(poses)
    }
}

/// A road user on the way that it drove.
struct Way<'a> {
    rectangle: Rectangle,
    poses: &'a [Pose],
    cover: SweptBounds,
    covers: Vec<SweptBounds>,
    speed: MetrePerSecond,
    brakes: &'a Brakes,
    stop: Metre,
    /// Poses beyond where it would stand.
    all: &'a [Pose],
}

impl<'a> Way<'a> {
    fn of(frame: &Frame, roster: &'a Roster, row: usize, stop: Metre, epsilon: Metre, all: &'a [Pose]) -> Self {
        let Row { user, state: State { x, y, heading, speed, .. } } = frame.row(row as u32);
        let profile = roster.profile_of(user);
        let rectangle = Rectangle::behind(Point::new(x, y), direction(heading), profile.length, profile.width);
        let end = all.partition_point(|pose| pose.distance <= stop + epsilon);
        let poses = &all[..end.max(1)];
        let (length, width) = (profile.length, profile.width);
        let cover = SweptBounds::of(poses, length, width).unwrap_or(SweptBounds::NOWHERE);
        let covers = poses.windows(2).filter_map(|pair| SweptBounds::of(pair, length, width)).collect();
        Self { rectangle, poses, cover, covers, speed, brakes: &profile.brakes, stop, all }
    }

    fn mover(&self) -> Participant<'_> {
        let Self { rectangle, poses, ref cover, ref covers, speed, brakes, stop, .. } = *self;
        let reach = poses.last().map_or(0.0, |pose| pose.distance);
        Participant { rectangle, shape: &[], poses, straight: false, reach, cover, covers, speed, brakes, stop }
    }
}

fn judge(a: &Way, b: &Way, options: &Options) -> Truth {
    let (first, second) = (a.mover(), b.mover());
    if side::touch_now(&first, &second) {
        return Truth::Conflict(0.0);
    }
    let Some(approach) = narrow_phase::meet(&first, &second, &|| true) else { return Truth::None };
    let [ego, foe] = approach.ego.then_foe([a, b]);
    let meeting = approach.conflict_point;
    let sigma = meeting.angle().cos();
    let foe_distance = if sigma > 0.0 { way_out(foe, &meeting) } else { meeting.foe_distance };
    let gap = narrow_phase::gap(meeting.ego_distance, foe_distance, sigma);
    let margin = gap - narrow_phase::mu(MuModel::Minimal, &ego.mover(), &foe.mover(), sigma, options.epsilon);
    match margin {
        _ if margin.abs() < NEAR => Truth::Aside,
        _ if margin < 0.0 => Truth::Conflict(gap),
        _ => Truth::None,
    }
}

/// The foe's way until it has left the meeting place; a leader is there now.
fn way_out(foe: &Way, meeting: &ConflictPoint) -> Metre {
    if meeting.foe_distance <= 0.0 {
        0.0
    } else {
        side::departure(&mut Bisection::default(), foe.all, &foe.mover(), &meeting.ego_rectangle, meeting.foe_distance)
    }
}
