//! The paths that the vehicles of a recording really drove, and the pairs that were in conflict on them.
//!
//! The narrow phase is closecall's own, with the poses that followed in the recording. Any difference from the result of a
//! path model is therefore due to the path model.

use std::path::Path;

use ecow::EcoString;
use rustc_hash::FxHashMap;

use closecall::braking::{Brakes, MuModel, stopping_distance};
use closecall::detection::broad_phase::{Area, Circle, Search};
use closecall::detection::narrow_phase::{self, ConflictPoint, Participant, SweptBounds, side};
use closecall::detection::path::Pose;
use closecall::geometry::bisection::Bisection;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::geometry::{Point, Vector, cross};
use closecall::options::Options;
use closecall::traffic::frame::{Frame, Row, State};
use closecall::traffic::profile::Carriage;
use closecall::traffic::roster::{Roster, UserIndex};
use closecall::util::units::{Metre, MetrePerSecond, Second};
use closecall_run::Result;
use closecall_run::input::replay::recorded_step::RecordedStep;
use closecall_run::input::replay::recording::Recording;

/// Pairs whose margin is within this of 0 are excluded, because a recording rounds steps and sizes.
const NEAR: Metre = 0.75;
/// A vehicle that moves further sideways than this in one step was moved, not driven.
const SIDEWAYS: Metre = 0.3;
/// A vehicle that moves less than this is standing.
const STANDS: Metre = 1e-3;

/// The front-bumper centre and heading of every road user, step by step.
pub(super) struct DrivenTraces {
    traces: FxHashMap<String, Vec<(Second, Point, Vector)>>,
}

/// Whether a pair was really in conflict in a step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Truth {
    /// In conflict, with this gap.
    Conflict(Metre),
    /// Not in conflict.
    None,
    /// Unknown: one of the two left, stood or was moved sideways, or the margin is a matter of centimetres.
    Unknown,
}

/// Both ids, the smaller one first.
pub(super) type IdPair = (EcoString, EcoString);

/// The pair of two road users.
pub(super) fn pair(roster: &Roster, a: UserIndex, b: UserIndex) -> IdPair {
    ordered(roster.id(a).clone(), roster.id(b).clone())
}

/// Both ids, the smaller one first.
pub(super) fn ordered(a: EcoString, b: EcoString) -> IdPair {
    if a <= b { (a, b) } else { (b, a) }
}

impl DrivenTraces {
    /// Reads a recording.
    pub fn read(path: &Path) -> Result<Self> {
        let mut recording = Recording::open(path)?;
        let mut step = RecordedStep::default();
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

    /// Whether each pair of road users near each other was really in conflict in this step.
    pub(crate) fn truth(&self, frame: &Frame, roster: &Roster, options: &Options) -> FxHashMap<IdPair, Truth> {
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
        let driven = frame.rows().zip(&stops).map(|(row, stop)| {
            let profile = roster.profile_of(row.user);
            let beyond = profile.length + profile.width + 30.0;
            let reach = [*stop, stop + options.epsilon, stop + options.epsilon + beyond];
            self.ahead(roster.id(row.user), frame.time, &reach)
        });
        let driven = driven.collect::<Vec<_>>();
        let judged = pairs.into_iter().filter(|(a, b)| {
            let speed = |row: &u32| frame.state(*row).speed;
            speed(a) > 0.0 || speed(b) > 0.0
        });
        let judge = |(a, b): (u32, u32)| {
            let (a, b) = (a as usize, b as usize);
            let truth = match (&driven[a], &driven[b]) {
                (Some(a_poses), Some(b_poses)) => {
                    let path =
                        |row: usize, poses| DrivenUser::of(frame, roster, row, stops[row], options.epsilon, poses);
                    judge(&path(a, a_poses), &path(b, b_poses), options)
                }
                _ => Truth::Unknown,
            };
            (pair(roster, frame.user(a as u32), frame.user(b as u32)), truth)
        };
        judged.map(judge).collect()
    }

    /// The poses from a time on: at every step, and at these distances. The vehicle may not reach the last one; none if it
    /// does not reach the second, or was moved sideways.
    fn ahead(&self, id: &str, time: Second, distances: &[Metre; 3]) -> Option<Vec<Pose>> {
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
            let travelled = last.distance + length;
            for distance in distances.iter().filter(|distance| last.distance < **distance && **distance < travelled) {
                let part = (distance - last.distance) / length;
                let turned = (last.axis + (axis - last.axis) * part).normalize();
                poses.push(Pose { distance: *distance, front: last.front + moved * part, axis: turned });
            }
            poses.push(Pose { distance: travelled, front: *front, axis: *axis });
            if travelled > distances[2] {
                break;
            }
        }
        (poses[poses.len() - 1].distance >= distances[1]).then_some(poses)
    }
}

/// A road user on the path that it drove.
struct DrivenUser<'a> {
    rectangle: Rectangle,
    poses: &'a [Pose],
    cover: SweptBounds,
    covers: Vec<SweptBounds>,
    speed: MetrePerSecond,
    brakes: &'a Brakes,
    stop: Metre,
    /// All known poses, including those beyond its stopping distance.
    all: &'a [Pose],
}

impl<'a> DrivenUser<'a> {
    fn of(frame: &Frame, roster: &'a Roster, row: usize, stop: Metre, epsilon: Metre, all: &'a [Pose]) -> Self {
        let Row { user, state: State { x, y, heading, speed, .. } } = frame.row(row as u32);
        let profile = roster.profile_of(user);
        let rectangle = Rectangle::behind(Point::new(x, y), direction(heading), profile.length, profile.width);
        let reach = if speed > 0.0 { stop + epsilon } else { 0.0 };
        let end = all.partition_point(|pose| pose.distance <= reach);
        let poses = &all[..end.max(1)];
        let length = profile.length;
        let width = profile.width;
        let cover = SweptBounds::of(poses, length, width).unwrap_or(SweptBounds::NOWHERE);
        let covers = poses.windows(2).filter_map(|pair| SweptBounds::of(pair, length, width)).collect();
        Self { rectangle, poses, cover, covers, speed, brakes: &profile.brakes, stop, all }
    }

    fn participant(&self) -> Participant<'_> {
        let Self { rectangle, poses, ref cover, ref covers, speed, brakes, stop, .. } = *self;
        let reach = poses.last().map_or(0.0, |pose| pose.distance);
        Participant {
            rectangle,
            carriage: Carriage { behind: 0.0, length: 2.0 * rectangle.half_length },
            setback: 0.0,
            shape: &[],
            poses,
            straight: false,
            reach,
            cover,
            covers,
            speed,
            brakes,
            stop,
        }
    }
}

fn judge(a: &DrivenUser, b: &DrivenUser, options: &Options) -> Truth {
    let first = a.participant();
    let second = b.participant();
    if side::touch_now(&first, &second) {
        let collide = side::overlap_now(&first, &second) > options.contact_tolerance;
        return if collide { Truth::Conflict(0.0) } else { Truth::Unknown };
    }
    let Some(approach) = narrow_phase::meet(&first, &second) else { return Truth::None };
    let [ego, foe] = approach.ego.then_foe([a, b]);
    let point = approach.conflict_point;
    let sigma = point.angle().cos();
    let foe_distance = if sigma > 0.0 { distance_to_leave(foe, &point) } else { point.foe_distance };
    let gap = narrow_phase::gap(point.ego_distance, foe_distance, sigma);
    let mu = narrow_phase::mu(MuModel::Minimal, &ego.participant(), &foe.participant(), sigma, options.epsilon);
    let margin = gap - mu;
    match margin {
        _ if margin.abs() < NEAR => Truth::Unknown,
        _ if margin < 0.0 => Truth::Conflict(gap),
        _ => Truth::None,
    }
}

/// The foe's distance until it has left the conflict area; 0 for a leader, which is already there.
fn distance_to_leave(foe: &DrivenUser, point: &ConflictPoint) -> Metre {
    if point.foe_distance <= 0.0 {
        0.0
    } else {
        side::departure(
            &mut Bisection::default(),
            foe.all,
            &foe.participant(),
            &point.ego_rectangle,
            point.foe_distance,
        )
    }
}
