//! The whole detector: steps of any length, fast, far from the origin, on lanes that are not as long as drawn, round a
//! hairpin, in a crowd.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::cars::{self, CarRun, car};
use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::chance::Chance;
use crate::reference::{braking, contact, nearest};
use closecall::braking::Braking;
use closecall::detection::path::track::Track;
use closecall::geometry::polylines::Lines;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::geometry::{Point, Vector, cross};
use closecall::options::Options;
use closecall::traffic::frame::State;
use closecall::traffic::placement::Placement;
use closecall::traffic::profile::{Carriage, Category, Profile};
use closecall::util::units::{Metre, MetrePerSecond, Second};

const POINT: Property = Property::within("distance to the conflict point", 1e-6, Unit::Metre);
const FOUND: Property = Property::always("a pair that would meet is found, and no other");
const TTC: Property = Property::within("TTC in a step of any length", 1e-9, Unit::Relative);
const MOVED: Property = Property::within("change of gap and mu, 1,000 km away", 1e-6, Unit::Metre);
const KIND: Property = Property::always("the same pair and kind, 1,000 km away");
/// A rectangle is swept to 0.1 mm as drawn; where a lane is drawn at a tenth of its length, that is 1 mm along the lane.
const ALONG: Property = Property::within("gap along a lane that is not as long as drawn", 5e-3, Unit::Metre);
const TTC_ALONG: Property = Property::within("TTC along such a lane", 1e-6, Unit::Second);
const CHORD: Property =
    Property::within("rear bumper behind the front's way, in ulps of the position", 64.0, Unit::Ulps);
const FINITE: Property = Property::always("every value a finite number");
const REFUSED: Property = Property::always("an error, within ten seconds");

/// Sizes of the stress cases' car, in m.
const SIZE: [Metre; 2] = [5.0, 2.0];

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Detector, "steps of 1 ms to 10 s, to 100 m/s", |chance, tally| {
        let (speed, closing) = (chance.between(25.0, 95.0), chance.between(2.0, 5.0));
        let step = chance.magnitude(1e-3, 10.0);
        check_steps(speed, closing, step, tally);
    })
    .costing(20),
    Case::new(Group::Detector, "crossing, to 100 m/s", |chance, tally| {
        let pair = crossing(chance);
        check_point(&pair, tally);
    })
    .costing(10),
    Case::new(Group::Detector, "1,000 km from the origin", |chance, tally| {
        let pair = crossing(chance);
        let by = [chance.between(-1e6, 1e6), chance.pick(&[1e6, -1e6])];
        check_moved(&pair, by, tally);
    })
    .costing(10),
    Case::new(Group::Detector, "a lane as long as a tenth to ten times its shape", |chance, tally| {
        // A lane within a hundredth of its shape is taken as drawn.
        let factor = Some(chance.magnitude(0.1, 10.0)).filter(|factor| (factor - 1.0).abs() > 0.01).unwrap_or(1.0);
        let room = chance.between(1.0, 20.0);
        let speeds = [chance.between(20.0, 40.0), chance.between(0.0, 15.0)];
        check_lane(factor, room, speeds, tally);
    })
    .costing(20),
    Case::new(Group::Detector, "30 m long, round a hairpin", |chance, tally| {
        let (radius, corners) = (chance.between(0.5, 15.0), chance.below(20) + 2);
        let begins = chance.between(30.0, 50.0);
        check_hairpin(chance, radius, corners, begins, tally);
    })
    .costing(20),
    Case::new(Group::Detector, "10^5 persons in one place", |_, tally| {
        let begun = Instant::now();
        let refused = crowd(100_000).is_err();
        tally.holds(REFUSED, refused && begun.elapsed() < Duration::from_secs(10), &refused);
    })
    .costing(u64::MAX),
];

/// A follower that closes in on its leader, one step after the other.
fn check_steps(speed: MetrePerSecond, closing: MetrePerSecond, step: Second, tally: &mut Tally) {
    /// The room in m at first, which either needs more than, and the least at which it still follows.
    const ROOMS: [Metre; 2] = [20.0, 0.5];
    const MOST: u32 = 20;
    let Ok(mut run) = CarRun::new(None) else { return tally.holds(FOUND, false, &"no run") };
    let users = [run.enter("leader"), run.enter("follower")];
    let steps = ((ROOMS[0] - ROOMS[1]) / (closing * step)) as u32;
    for number in 0..=steps.min(MOST) {
        let time = f64::from(number) * step;
        let room = ROOMS[0] - closing * time;
        let at = |x: Metre, speed| State { x, y: 0.0, z: 0.0, heading: 0.0, speed };
        let states = [at(speed * time + room + SIZE[0], speed), at(speed * time, speed + closing)];
        run.step(time, &[(users[0], states[0]), (users[1], states[1])]);
        let inputs = (speed, closing, step, number, run.ttc());
        let off = run.ttc().map_or(f64::INFINITY, |ttc| (ttc - room / closing).abs() / (room / closing));
        // Both have driven up to 100 m/s times 200 s, whose rounding is part of the room.
        tally.error(TTC, off, &inputs);
    }
}

/// Two cars that may cross near the origin.
fn crossing(chance: &mut Chance) -> [State; 2] {
    // Two that are parallel meet in one dimension.
    let (first, turn) = (chance.angle(), chance.between(0.02, PI - 0.02) * chance.pick(&[1.0, -1.0]));
    let mut towards = |heading: f64| {
        let (speed, ahead) = (chance.between(1.0, 100.0), chance.between(0.0, 4.0));
        let aside = Point::new(chance.between(-20.0, 20.0), chance.between(-20.0, 20.0));
        let front = aside - direction(heading) * (speed * ahead);
        State { x: front.x, y: front.y, z: 0.0, heading, speed }
    };
    [towards(first), towards(first + turn)]
}

fn rectangle(state: &State) -> Rectangle {
    Rectangle::behind(Point::new(state.x, state.y), direction(state.heading), SIZE[0], SIZE[1])
}

fn stop(state: &State) -> Metre {
    nearest(&braking::stopping_distance(&Braking { speed: state.speed, brakes: &car().brakes }))
}

/// An ego's distance to the area that the foe covers until it stands, if it gets there.
fn distance_to(ego: &State, foe: &State) -> Option<Metre> {
    let (axis, stopping) = (direction(foe.heading), stop(foe));
    let area = Rectangle::behind(Point::new(foe.x, foe.y) + axis * stopping, axis, SIZE[0] + stopping, SIZE[1]);
    let found = contact::first_contact(&rectangle(ego), direction(ego.heading), &area).map(|found| nearest(&found));
    found.filter(|distance| *distance <= stop(ego) + Options::default().epsilon)
}

fn check_point([first, second]: &[State; 2], tally: &mut Tally) {
    if contact::touches(&rectangle(first), &rectangle(second)) {
        return;
    }
    let expected = [distance_to(first, second), distance_to(second, first)].into_iter().flatten().reduce(f64::max);
    let found = cars::encounter(*first, *second).map(|found| found.ego_distance);
    let inputs = (first, second, found, expected);
    tally.holds(FOUND, found.is_some() == expected.is_some(), &inputs);
    if let (Some(found), Some(expected)) = (found, expected) {
        tally.error(POINT, (found - expected).abs(), &inputs);
    }
}

fn check_moved([first, second]: &[State; 2], [x, y]: [Metre; 2], tally: &mut Tally) {
    let moved = |state: &State| State { x: state.x + x, y: state.y + y, ..*state };
    let (near, far) = (cars::encounter(*first, *second), cars::encounter(moved(first), moved(second)));
    let inputs = (first, second, x, y);
    tally.holds(KIND, near.map(|found| (found.ego, found.kind)) == far.map(|found| (found.ego, found.kind)), &inputs);
    if let (Some(near), Some(far)) = (near, far) {
        tally.error(MOVED, (near.gap - far.gap).abs().max((near.mu - far.mu).abs()), &inputs);
    }
}

/// A follower and its leader on a straight lane of 400 m as drawn.
fn check_lane(factor: f64, room: Metre, [speed, of_leader]: [MetrePerSecond; 2], tally: &mut Tally) {
    const DRAWN: Metre = 400.0;
    let length = DRAWN * factor;
    let text = format!(
        "<net><edge id='e' from='a' to='b'><lane id='e_0' index='0' length='{length}' shape='0,0 {DRAWN},0'/></edge></net>"
    );
    let inputs = (factor, room, speed, of_leader);
    let net = closecall_run::net::parse(Path::new("lane.net.xml"), text).ok().map(Arc::new);
    let Some((net, lane)) = net.and_then(|net| Some((net.clone(), net.lane("e_0")?))) else {
        return tally.holds(FOUND, false, &inputs);
    };
    let follower = SIZE[0].min(length / 8.0);
    let placed = [(follower, speed), (follower + room + SIZE[0], of_leader)].map(|(position, speed)| {
        let state = State { x: position / factor, y: 0.0, z: 0.0, heading: 0.0, speed };
        (state, Placement { lane, position, route: None, route_position: 0, lateral_speed: 0.0 })
    });
    let found = cars::encounter_on(net, placed);
    tally.holds(FOUND, found.is_some(), &inputs);
    let Some(found) = found else { return };
    tally.error(ALONG, (found.gap - room).abs(), &(inputs, found.gap));
    let ttc = found.nearness.and_then(|near| near.values.ttc());
    let expected = room / (speed - of_leader);
    tally.error(TTC_ALONG, ttc.map_or(f64::INFINITY, |ttc| (ttc - expected).abs()), &(inputs, ttc, expected));
}

/// A vehicle of 30 m on a line that turns round.
fn check_hairpin(chance: &mut Chance, radius: Metre, corners: usize, begins: Metre, tally: &mut Tally) {
    const LENGTH: Metre = 30.0;
    const STRAIGHT: Metre = 50.0;
    let corner = |index: usize| {
        let angle = PI * index as f64 / corners as f64;
        Point::new(STRAIGHT + radius * angle.sin(), radius * (1.0 - angle.cos()))
    };
    let ends = [Point::origin(), Point::new(0.0, 2.0 * radius)];
    let points = std::iter::once(ends[0]).chain((0..=corners).map(corner)).chain([ends[1]]).collect::<Vec<_>>();
    let lines = Lines::through(points.iter().copied());
    let mut track = Track::default();
    track.begin(&lines, 0, begins);
    let room = track.ahead();
    let distances = [room * chance.between(0.0, 1.0), room];
    let mut poses = Vec::new();
    track.poses(&lines, Vector::x(), Carriage { behind: 0.0, length: LENGTH }, &distances, false, &mut poses);
    let inputs = (radius, corners, begins, distances);
    let ulp = (lines.length(0) + STRAIGHT) * f64::EPSILON;
    let mut worst = 0.0_f64;
    for pose in &poses {
        let rear = at(&points, begins + pose.distance - LENGTH);
        let (back, front) = (rear - pose.front, at(&points, begins + pose.distance) - pose.front);
        // A rear in the front's place has no chord.
        let off = if back.norm() < 1e-3 { 0.0 } else { cross(&pose.axis, &back).abs() };
        worst = worst.max((off + front.norm()) / ulp);
        tally.holds(FINITE, (pose.axis.norm() - 1.0).abs() < 1e-12 && pose.front.coords.amax() < 1e3, &inputs);
    }
    tally.error(CHORD, worst, &inputs);
}

/// The place at a distance along a line.
fn at(line: &[Point], mut distance: Metre) -> Point {
    for pair in line.windows(2) {
        let length = (pair[1] - pair[0]).norm();
        if distance <= length {
            return pair[0] + (pair[1] - pair[0]) * (distance / length);
        }
        distance -= length;
    }
    line[line.len() - 1]
}

/// A step of persons in one place.
fn crowd(count: usize) -> closecall_run::Result<()> {
    let person = Profile { category: Category::Person, length: 0.215, width: 0.478, chord: 0.215, ..car() };
    let mut run = CarRun::of(person, None)?;
    let at = State { x: 0.0, y: 0.0, z: 0.0, heading: 0.0, speed: 1.0 };
    let states = (0..count).map(|number| (run.enter(&format!("person{number}")), at)).collect::<Vec<_>>();
    run.try_step(0.0, &states, None)
}
