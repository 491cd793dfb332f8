//! A warm detector allocates no memory: counted by the allocator itself.

#![allow(clippy::unwrap_used, reason = "a test may")]

#[path = "common/counting.rs"]
mod counting;

use closecall::{Detector, Frame, Options, PathModel, Roster, State, UserIndex};

/// Four lanes of cars that close up and spread again; every tenth crosses.
fn step(frame: &mut Frame, users: &[UserIndex], number: u32) {
    let phase = f64::from(number % 20) / 20.0 * std::f64::consts::TAU;
    frame.begin(f64::from(number) * 0.1);
    for (place, &user) in users.iter().enumerate() {
        let (row, lane) = (place / 4, place % 4);
        let x = row as f64 * (12.0 + 2.0 * phase.sin()) + 3.0 * phase.cos();
        let heading = if place % 10 == 0 { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        frame.push(user, State { x, y: lane as f64 * 3.2, z: 0.0, heading, speed: 8.0 + 5.0 * phase.cos() });
    }
}

/// Rings of cars at equal speed, each ring crossing its neighbours.
fn round_step(frame: &mut Frame, users: &[UserIndex], number: u32) {
    const ROUND: f64 = 20.0;
    frame.begin(f64::from(number) * 0.1);
    for (place, &user) in users.iter().enumerate() {
        let (ring, place) = ((place / 10) as f64, (place % 10) as f64);
        let angle = (f64::from(number) / ROUND + place / 10.0) * std::f64::consts::TAU;
        let (x, y) = (30.0 * ring + 20.0 * angle.cos(), 20.0 * angle.sin());
        frame.push(user, State { x, y, z: 0.0, heading: angle + std::f64::consts::FRAC_PI_2, speed: 8.0 });
    }
}

fn assert_warm_allocates_nothing(options: &Options, users: u32, step: impl Fn(&mut Frame, &[UserIndex], u32)) {
    let mut roster = Roster::default();
    let profile = roster.profile(closecall_study::stress::car()).unwrap();
    let users = (0..users).map(|number| roster.enter(&number.to_string(), profile)).collect::<Vec<_>>();
    let mut detector = Detector::new(options, None);
    let mut frame = Frame::default();
    let (mut before, mut found) = (0, 0);
    // The first round warms up; the second must allocate nothing.
    for number in 0..40 {
        if number == 20 {
            before = counting::allocations();
        }
        step(&mut frame, &users, number);
        detector.track_paths(&frame, &roster);
        detector.broad_phase(&frame, &roster);
        found += detector.narrow_phase(&frame, &roster).len();
    }
    assert!(found > 1000, "{found}");
    assert_eq!(counting::allocations() - before, 0);
}

#[test]
fn a_warm_detector_allocates_nothing() {
    assert_warm_allocates_nothing(&Options::default(), 1000, step);
    assert_warm_allocates_nothing(&Options { path: PathModel::Arc, ..Options::default() }, 100, round_step);
}
