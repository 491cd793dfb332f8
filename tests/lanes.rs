//! Which way somebody is taken to drive along the lane that it is on.

#![allow(clippy::unwrap_used, reason = "a test may")]

#[path = "common/street.rs"]
mod street;

use closecall::detector::Detector;
use closecall::encounter::Placement;
use closecall::frame::{Frame, Roster, State};
use closecall::options::Options;
use street::street;

/// Whether a car on the lane to the west, headed this way, is taken to drive to the west, on this route.
fn drives_west(heading: f64, route: &[&str], route_position: usize) -> bool {
    let net = street();
    let mut roster = Roster::default();
    let profile = roster.profile(closecall::stress::car()).unwrap();
    let mut frame = Frame::default();
    frame.begin(0.0);
    frame.push(roster.enter("car", profile), State { x: 120.0, y: 1.6, z: 0.0, heading, speed: 12.0 });
    let mut detector = Detector::new(&Options::default(), Some(net.clone()));
    assert_eq!(detector.follow(&frame, &roster), [0]);
    let placement = Placement {
        lane: net.lane("west_0").unwrap(),
        position: 80.0,
        route: route.iter().map(|edge| net.edge(edge).unwrap()).collect(),
        route_position,
        lateral_speed: 0.0,
    };
    detector.place(&frame, &roster, 0, &placement);
    detector.approach(&frame, &roster);
    detector.path(&frame, &roster, 0).last().unwrap().x < 120.0
}

#[test]
fn who_has_just_turned_sharply_onto_its_route_drives_along_it_whatever_its_heading() {
    for heading in [0.5, 1.5, 3.0, std::f64::consts::PI] {
        assert!(drives_west(heading, &["east", "west"], 1));
    }
}

#[test]
fn who_is_on_the_lane_of_those_who_come_towards_it_drives_against_it() {
    assert!(!drives_west(0.0, &["east"], 0));
    assert!(!drives_west(0.0, &[], 0), "of whom no route is known the heading says it");
    assert!(drives_west(3.0, &[], 0));
}
