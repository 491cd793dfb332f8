//! Once warm, the detector takes no memory any more: counted by the allocator itself.

#![allow(clippy::unwrap_used, reason = "a test may")]

#[path = "common/counting.rs"]
mod counting;

use closecall::detector::Detector;
use closecall::frame::{Frame, Roster, State, UserIndex};
use closecall::options::Options;

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

#[test]
fn a_warm_detector_allocates_nothing() {
    let mut roster = Roster::default();
    let profile = roster.profile(closecall::stress::car()).unwrap();
    let users = (0..1000).map(|number| roster.enter(&number.to_string(), profile)).collect::<Vec<_>>();
    let mut detector = Detector::new(&Options::default(), None);
    let mut frame = Frame::default();
    let (mut before, mut found) = (0, 0);
    // One round to get warm, then the same one again.
    for number in 0..40 {
        if number == 20 {
            before = counting::allocations();
        }
        step(&mut frame, &users, number);
        detector.follow(&frame, &roster);
        detector.approach(&frame, &roster);
        found += detector.detect(&roster).len();
    }
    assert!(found > 1000, "{found}");
    assert_eq!(counting::allocations() - before, 0);
}
