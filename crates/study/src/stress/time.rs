//! Times near infinity or zero, contacts that only graze, and road users that move in impossible ways.

use super::cars::CarRun;
use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::chance::Chance;
use crate::reference::{contact as reference, nearest, precise};
use closecall::detection::measures::ttc::{HORIZON, SteadyMotion, time_to_collision};
use closecall::detection::path::Pose;
use closecall::events::{CLOSES_AFTER, Conflict};
use closecall::geometry::contact::distance;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::geometry::{Point, left_of};
use closecall::traffic::frame::State;
use closecall::util::units::{Metre, MetrePerSecond, Second};

const LENGTH: f64 = 5.0;
const WIDTH: f64 = 2.0;
/// Rounding a position of 1e3 m costs 1e-13 m, which at 1 m/s is 1e-13 s.
const TTC: Property = Property::within("TTC", 1e-9, Unit::Second);
const LATE: Property = Property::always("TTC finite or none, none beyond the horizon");
const THERE: Property = Property::within("gap between the rectangles at the TTC", 1e-9, Unit::Metre);
const BETWEEN: Property = Property::always("TTC between those of rectangles 1e-9 m larger and smaller");
const FOUND: Property = Property::always("contact found if deeper than 1e-9 m, not if 1e-9 m apart");
const FINITE: Property = Property::always("every value a finite number");
const ONE: Property = Property::always("one conflict with the right begin and end");
const NO_DRIFT: Property = Property::within("begin of a conflict after 10^6 steps", 1e-6, Unit::Second);
const TWO: Property = Property::always("two stays, two conflicts");

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Time, "relative speed to 0", |chance, tally| {
        let speed = chance.between(0.0, 100.0);
        let closing = chance.magnitude(1e-300, 10.0);
        let moving = SteadyCar { front: Point::new(0.0, 0.0), heading: 0.0, speed: speed + closing };
        let fixed = SteadyCar { front: Point::new(LENGTH + chance.magnitude(1e-9, 100.0), 0.0), heading: 0.0, speed };
        check(&moving, &fixed, tally);
    }),
    Case::new(Group::Time, "at any angle, to 140 m/s", |chance, tally| {
        let moving = any(chance);
        let foe = any(chance);
        check(&moving, &foe, tally);
    }),
    Case::new(Group::Time, "grazing", |chance, tally| {
        let moving = SteadyCar { front: Point::origin(), heading: chance.angle(), speed: chance.between(1.0, 100.0) };
        let axis = direction(moving.heading);
        // Beside the ego's path, so that the corners pass each other within a few units in the last place.
        let aside = WIDTH * (1.0 + f64::from(chance.around(4)) * f64::EPSILON);
        let front = moving.front + axis * chance.between(20.0, 80.0) + left_of(&axis) * aside;
        let foe = SteadyCar { front, heading: moving.heading, speed: 0.0 };
        check(&moving, &foe, tally);
    }),
    Case::new(Group::Time, "steps of 1 ms to 10 s", |chance, tally| {
        let step = chance.magnitude(1e-3, 10.0);
        let lasts = chance.below(20) + 1;
        let found = episode(0.0, step, lasts);
        let holds = found.as_ref().is_some_and(|found| {
            let [(begin, end)] = found[..] else { return false };
            begin.abs() < step / 2.0 && (end - step * (lasts - 1) as f64).abs() < step / 2.0
        });
        tally.holds(ONE, holds, &(step, lasts, found));
    })
    .costing(20),
    Case::new(Group::Time, "10^6 steps", |_, tally| {
        const STEP: Second = 0.1;
        const STEPS: u32 = 1_000_000;
        // As in SUMO, the time is the sum of the steps in whole milliseconds.
        let begin = f64::from(STEPS) * STEP;
        let error = after(STEPS, STEP).map_or(f64::INFINITY, |found| (found - begin).abs());
        tally.error(NO_DRIFT, error, &STEPS);
    })
    .costing(u64::MAX),
    Case::new(Group::Time, "jumps, stands, turns back", |chance, tally| {
        let mut steps = Vec::new();
        for _ in 0..30 {
            steps.push([odd(chance), odd(chance)]);
        }
        let finite = is_finite(&steps);
        tally.holds(FINITE, finite, &steps);
    })
    .costing(30),
    Case::new(Group::Time, "leaves and returns under the same id", |chance, tally| {
        let away = chance.below(5) as f64 + 1.0;
        let found = twice(away);
        tally.holds(TWO, found == Some(2), &(away, found));
    })
    .costing(20),
];

/// A car that keeps its speed.
#[derive(Clone, Copy, Debug)]
struct SteadyCar {
    front: Point,
    heading: f64,
    speed: MetrePerSecond,
}

impl SteadyCar {
    fn rectangle(&self, time: Second) -> Rectangle {
        let axis = direction(self.heading);
        Rectangle::behind(self.front + axis * (self.speed * time), axis, LENGTH, WIDTH)
    }
}

fn any(chance: &mut Chance) -> SteadyCar {
    // All cars drive towards the origin and arrive at about the same time.
    let towards = chance.angle();
    let speed = chance.magnitude(1.0, 140.0);
    let arrives = chance.between(3.0, 3.2);
    SteadyCar { front: Point::from(-direction(towards) * (speed * arrives)), heading: towards, speed }
}

fn check(a: &SteadyCar, b: &SteadyCar, tally: &mut Tally) {
    let inputs = (a, b);
    let poses = |moving: &SteadyCar| [Pose { distance: 0.0, front: moving.front, axis: direction(moving.heading) }];
    let a_poses = poses(a);
    let b_poses = poses(b);
    let course = |poses, speed| SteadyMotion { poses, speed, deceleration: 0.0, length: LENGTH, width: WIDTH };
    let found = time_to_collision(&course(&a_poses, a.speed), &course(&b_poses, b.speed));
    tally.holds(LATE, found.is_none_or(|time| time.is_finite() && (0.0..=HORIZON).contains(&time)), &inputs);
    let velocity = direction(a.heading) * a.speed - direction(b.heading) * b.speed;
    let expected = reference::first_contact(&a.rectangle(0.0), velocity, &b.rectangle(0.0));
    let expected = expected.filter(|time| *time < precise(HORIZON)).map(|time| nearest(&time));
    match (found, expected) {
        (Some(found), Some(expected)) => {
            let room = distance(&a.rectangle(found), &b.rectangle(found));
            tally.error(THERE, room, &inputs);
            let early = grown_contact(a, b, 1e-9);
            let late = grown_contact(a, b, -1e-9);
            let between = early.is_none_or(|early| early <= found) && late.is_none_or(|late| found <= late);
            tally.holds(BETWEEN, between, &(inputs, found, expected));
            // If the cars close slowly or graze each other, rounding a position changes the time by more than the bound.
            if let (Some(early), Some(late)) = (early, late)
                && late - early < 1e-8
            {
                tally.error(TTC, (found - expected).abs(), &inputs);
            }
        }
        (None, None) => {}
        // Only a contact that rounding decides, or one at the horizon, may be found by just one of the two.
        (Some(time), None) | (None, Some(time)) => tally.holds(FOUND, grazes(a, b, time), &(inputs, found, expected)),
    }
}

/// Whether rounding decides that two cars touch before the horizon.
fn grazes(a: &SteadyCar, b: &SteadyCar, time: Second) -> bool {
    time > HORIZON - 1e-9 || grown_contact(a, b, 1e-9).is_some() != grown_contact(a, b, -1e-9).is_some()
}

/// The time at which two cars first touch if they are larger on all sides by this.
fn grown_contact(a: &SteadyCar, b: &SteadyCar, by: Metre) -> Option<Second> {
    let grown = |moving: &SteadyCar| {
        let rectangle = moving.rectangle(0.0);
        Rectangle { half_length: rectangle.half_length + by, half_width: rectangle.half_width + by, ..rectangle }
    };
    let velocity = direction(a.heading) * a.speed - direction(b.heading) * b.speed;
    let found = reference::first_contact(&grown(a), velocity, &grown(b)).map(|time| nearest(&time));
    found.filter(|time| *time < HORIZON)
}

/// Begin and end of the conflicts of a follower that is too close for `lasts` steps and then far away.
fn episode(begin: Second, step: Second, lasts: usize) -> Option<Vec<(Second, Second)>> {
    let mut scene = CarRun::new(None).ok()?;
    let leader = scene.enter("leader");
    let follower = scene.enter("follower");
    let quiet = (CLOSES_AFTER / step).ceil() as usize + 2;
    for number in 0..lasts + quiet {
        let behind = if number < lasts { -8.0 } else { -500.0 };
        let at = |x: f64| State { x, y: 0.0, z: 0.0, heading: 0.0, speed: 20.0 };
        scene.step(begin + step * number as f64, &[(leader, at(0.0)), (follower, at(behind))]);
    }
    Some(scene.finish().iter().map(|conflict| (conflict.begin, conflict.end)).collect())
}

/// The begin of a conflict that starts after this many steps.
fn after(steps: u32, step: Second) -> Option<Second> {
    let mut scene = CarRun::new(None).ok()?;
    let leader = scene.enter("leader");
    let follower = scene.enter("follower");
    let at = |x: f64| State { x, y: 0.0, z: 0.0, heading: 0.0, speed: 20.0 };
    let mut milliseconds = 0_u64;
    for number in 0..=steps {
        let behind = if number < steps { -500.0 } else { -8.0 };
        scene.step(milliseconds as f64 / 1e3, &[(leader, at(0.0)), (follower, at(behind))]);
        milliseconds += (step * 1e3).round() as u64;
    }
    scene.finish().first().map(|conflict| conflict.begin)
}

/// A state unrelated to the previous one: anywhere, often at the same place, often at rest.
fn odd(chance: &mut Chance) -> State {
    let around = chance.pick(&[0.0, 1.0, 20.0, 1e7]);
    State {
        x: chance.between(-around, around),
        y: chance.between(-around, around),
        z: 0.0,
        heading: chance.pick(&[0.0, 1e-16, std::f64::consts::PI, -std::f64::consts::PI, 1.0]),
        speed: chance.pick(&[0.0, 5e-324, 1e-9, 10.0, 140.0]),
    }
}

/// Whether a run of two cars with these states has only finite values.
fn is_finite(steps: &[[State; 2]]) -> bool {
    let Ok(mut scene) = CarRun::new(None) else { return false };
    let users = [scene.enter("a"), scene.enter("b")];
    for (number, [first, second]) in steps.iter().enumerate() {
        // An hour passes between two steps.
        scene.step(number as f64 * 3600.0, &[(users[0], *first), (users[1], *second)]);
    }
    let finite =
        |conflict: &Conflict| (conflict.margin + conflict.ego_delta_v + conflict.foe_delta_v + conflict.x).is_finite();
    scene.finite && scene.finish().iter().all(finite)
}

/// The number of conflicts of two cars if one leaves and returns elsewhere under the same id.
fn twice(away: Second) -> Option<usize> {
    let mut scene = CarRun::new(None).ok()?;
    let leader = scene.enter("leader");
    let at = |x: f64| State { x, y: 0.0, z: 0.0, heading: 0.0, speed: 20.0 };
    let mut time = 0.0;
    for stay in 0..2 {
        let follower = scene.enter("follower");
        scene.step(time, &[(leader, at(0.0)), (follower, at(-8.0 - f64::from(stay)))]);
        scene.leave(follower);
        time += 0.1;
        scene.step(time, &[(leader, at(0.0))]);
        time += away * 0.01;
    }
    Some(scene.finish().len())
}
