//! What a collision is called, and where it is, depends on no step length and on no phase of the steps.

use std::f64::consts::FRAC_PI_2;

use closecall::{Conflict, Kind, Options, Profile, State, SumoType};
use closecall_run::{Error, Run};

/// The lengths of steps, in s.
const STEPS: [f64; 6] = [0.05, 0.1, 0.2, 0.25, 0.5, 1.0];
/// When the first step is, as parts of its length.
const PHASES: [f64; 4] = [0.0, 0.2, 0.5, 0.8];

/// A road user: its class, and where it is when.
type User<'a> = (&'a str, &'a dyn Fn(f64) -> State);

fn state(x: f64, y: f64, heading: f64, speed: f64) -> State {
    State { x, y, z: 0.0, heading, speed }
}

/// The conflict of two within 8 s.
fn conflict(users: [User; 2], step: f64, phase: f64) -> Conflict {
    let options = Options::default();
    let mut run = Run::new(&options.clone().into(), None).unwrap();
    let users = users.map(|(class, at)| {
        let sumo = SumoType::of_class(class, class);
        let profile = match class {
            "pedestrian" => Profile::person(&sumo, &options, step),
            _ => Profile::vehicle(&sumo, &options),
        };
        let profile = run.roster.profile(profile).unwrap();
        (profile, at)
    });
    let users = [("a", users[0]), ("b", users[1])].map(|(id, (profile, at))| (run.enter(id, profile), at));
    for number in 0..(8.0 / step) as u32 {
        let time = (f64::from(number) + phase) * step;
        run.begin_step(time);
        for (user, at) in &users {
            run.frame.push(*user, at(time));
        }
        run.step(|_, _| Ok::<_, Error>(())).unwrap();
    }
    run.finish().unwrap();
    let found = run.conflicts();
    assert_eq!(found.len(), 1, "steps of {step} s, {phase}: {found:?}");
    found.into_iter().next().unwrap()
}

/// Checks that two collide with this kind at this place, whatever the steps; the ego is one of these.
fn strike_with(users: [User; 2], kind: Kind, (x, y): (f64, f64), within: f64, egos: &[&str]) {
    for (step, phase) in STEPS.into_iter().flat_map(|step| PHASES.map(|phase| (step, phase))) {
        let found = conflict(users, step, phase);
        let off = (found.x - x).hypot(found.y - y);
        assert!(
            found.collision && found.kind == kind && egos.contains(&found.ego.as_str()) && off < within,
            "steps of {step} s, {phase}: {:?} of {} at {}, {}",
            found.kind,
            found.ego,
            found.x,
            found.y
        );
    }
}

/// The same with the first as the ego.
fn strike(users: [User; 2], kind: Kind, place: (f64, f64), within: f64) {
    strike_with(users, kind, place, within, &["a"]);
}

/// A car that drives along the x axis with 12 m/s.
fn car(time: f64) -> State {
    state(12.0 * time - 48.0, 0.0, 0.0, 12.0)
}

#[test]
fn a_person_that_walks_on_is_struck_from_the_side() {
    // A person is 0.478 m wide; two collide where they overlap by 0.25 m.
    let person = |time: f64| state(0.0, 1.4 * (time - 4.0), FRAC_PI_2, 1.4);
    strike([("passenger", &car), ("pedestrian", &person)], Kind::Side, (0.011, 0.0), 0.01);
}

#[test]
fn a_person_that_turns_when_it_is_struck_is_still_struck_from_the_side() {
    for turned in [0.0, 0.4, -0.5, 2.0 * FRAC_PI_2] {
        let person = move |time: f64| match time {
            ..4.0 => state(0.0, 1.4 * (time - 4.0), FRAC_PI_2, 1.4),
            _ => state(0.0, 0.0, turned, 0.0),
        };
        strike([("passenger", &car), ("pedestrian", &person)], Kind::Side, (0.0, 0.0), 0.35);
    }
}

#[test]
fn a_person_that_steps_aside_before_is_still_crossing() {
    // As SUMO turns a person that makes way, for the last 0.15 s.
    let person = |time: f64| match time {
        ..3.85 => state(0.0, 1.4 * (time - 4.0), FRAC_PI_2, 1.4),
        _ => state(0.2 * (time - 3.85).min(0.5), -0.2, 0.0, 0.2),
    };
    strike([("passenger", &car), ("pedestrian", &person)], Kind::Side, (0.0, 0.0), 0.35);
}

#[test]
fn a_bicycle_that_crosses_is_struck_from_the_side() {
    let bicycle = |time: f64| state(0.0, 4.0 * (time - 4.0), FRAC_PI_2, 4.0);
    strike([("passenger", &car), ("bicycle", &bicycle)], Kind::Side, (-0.075, 0.0), 0.01);
}

#[test]
fn a_slow_vehicle_is_struck_alike_at_every_step() {
    let slow = |time: f64| state(1.0, 1.0 * (time - 3.0), FRAC_PI_2, 1.0);
    strike([("passenger", &car), ("truck", &slow)], Kind::Side, (0.05, 0.0), 0.01);
    let ahead = |time: f64| state(0.5 * (time - 3.0), 0.0, 0.0, 0.5);
    // The follower's front reaches the leader's rear, 5 m behind its front, after 3.609 s, and is 0.25 m deeper 0.022 s later.
    strike([("passenger", &car), ("passenger", &ahead)], Kind::RearEnd, (-4.435, 0.0), 0.01);
}

#[test]
fn a_car_that_turns_strikes_a_person_as_it_is_headed_then() {
    // It turns left on a radius of 8 m with 6 m/s, and comes to the person after 70° of the turn.
    let turning = |time: f64| {
        let distance = 6.0 * (time - 3.0);
        let angle = (distance / 8.0).clamp(0.0, FRAC_PI_2);
        let rest = (distance - 8.0 * FRAC_PI_2).max(0.0);
        state(distance.min(0.0) + 8.0 * angle.sin(), 8.0 - 8.0 * angle.cos() + rest, angle, 6.0)
    };
    let at = 1.22_f64;
    let place = (8.0 * at.sin(), 8.0 - 8.0 * at.cos());
    // It crosses the exit of the turn, and stands still, turned round, as soon as it is struck.
    let arrives = 3.0 + 8.0 * at / 6.0;
    let person = |time: f64| {
        let walked = (1.4 * (time - arrives)).min(0.0);
        let heading = if time < arrives { 0.0 } else { FRAC_PI_2 };
        state(place.0 + walked, place.1, heading, if time < arrives { 1.4 } else { 0.0 })
    };
    // In a step of 1 s before the contact, the person has the longer way to where the car will be.
    strike_with([("passenger", &turning), ("pedestrian", &person)], Kind::Side, place, 0.6, &["a", "b"]);
}
