//! The path that is built from a road user's lane, heading and route.

use std::path::Path;
use std::sync::Arc;

use closecall::{Detector, Frame, Options, Placement, Point, Roster, State};

use super::street::street;

/// Whether the path of a car on the westbound lane, with this heading and route, leads west.
fn drives_west(heading: f64, route: &[&str], route_position: usize) -> bool {
    let net = street();
    let mut roster = Roster::default();
    let profile = roster.profile(closecall_study::stress::car()).unwrap();
    let mut frame = Frame::default();
    frame.begin(0.0);
    frame.push(roster.enter("car", profile), State { x: 120.0, y: 1.6, z: 0.0, heading, speed: 12.0 });
    let mut detector = Detector::new(&Options::default(), Some(net.clone()));
    assert_eq!(detector.track_paths(&frame, &roster), [0]);
    let placement = Placement {
        lane: net.lane("west_0").unwrap(),
        position: 80.0,
        route: Some(route.iter().map(|edge| net.edge(edge).unwrap()).collect()),
        route_position,
        lateral_speed: 0.0,
    };
    detector.set_placement(&frame, &roster, 0, &placement);
    detector.broad_phase(&frame, &roster);
    detector.path(&frame, &roster, 0).last().unwrap().x < 120.0
}

#[test]
fn after_a_sharp_turn_a_car_follows_its_route() {
    for heading in [0.5, 1.5, 3.0, std::f64::consts::PI] {
        assert!(drives_west(heading, &["east", "west"], 1));
    }
}

#[test]
fn a_car_on_the_oncoming_lane_drives_against_it() {
    assert!(!drives_west(0.0, &["east"], 0));
    assert!(!drives_west(0.0, &[], 0), "without a route the heading decides");
    assert!(drives_west(3.0, &[], 0));
}

/// Two lanes that do not join, as in SUMO's nets without junction lanes.
const APART: &str = r#"<net>
    <edge id="a" from="w" to="m"><lane id="a_0" index="0" length="100" shape="0,0 100,0"/></edge>
    <edge id="b" from="m" to="e"><lane id="b_0" index="0" length="100" shape="110,5 210,5"/></edge>
    <connection from="a" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
</net>"#;

#[test]
fn a_path_leads_straight_across_between_unjoined_lanes() {
    let net = Arc::new(closecall_run::net::parse(Path::new("apart.net.xml"), APART).unwrap());
    let mut roster = Roster::default();
    let profile = roster.profile(closecall_study::stress::car()).unwrap();
    let (user, mut frame) = (roster.enter("car", profile), Frame::default());
    let mut detector = Detector::new(&Options::default(), Some(net.clone()));
    detector.set_fixed_routes(true);
    let places = [(60.0, 0.0), (80.0, 0.0), (100.0, 0.0), (105.0, 2.5), (110.0, 5.0), (130.0, 5.0)];
    for (step, (x, y)) in places.into_iter().enumerate() {
        frame.begin(step as f64);
        frame.push(user, State { x, y, z: 0.0, heading: 0.0, speed: 25.0 });
        let asked = detector.track_paths(&frame, &roster).to_vec();
        assert_eq!(asked.is_empty(), step > 0, "it has left its path at ({x}, {y})");
        for row in asked {
            let placement = Placement {
                lane: net.lane("a_0").unwrap(),
                position: x,
                route: Some(["a", "b"].iter().map(|edge| net.edge(edge).unwrap()).collect()),
                route_position: 0,
                lateral_speed: 0.0,
            };
            detector.set_placement(&frame, &roster, row, &placement);
        }
        detector.broad_phase(&frame, &roster);
        let path = detector.path(&frame, &roster, 0);
        let passes = |x: f64, y: f64| path.iter().any(|point| (point - Point::new(x, y)).norm() < 1e-9);
        assert!(x >= 100.0 || passes(100.0, 0.0), "{path:?}");
        assert!(x >= 110.0 || passes(110.0, 5.0), "{path:?}");
        assert!((path.last().unwrap().y - 5.0).abs() < 1e-9, "{path:?}");
    }
}

/// A street with a turn-off to the south.
const FORK: &str = r#"<net>
    <edge id="a" from="w" to="m"><lane id="a_0" index="0" length="100" shape="0,0 100,0"/></edge>
    <edge id="b" from="m" to="e"><lane id="b_0" index="0" length="100" shape="100,0 200,0"/></edge>
    <edge id="c" from="m" to="s"><lane id="c_0" index="0" length="100" shape="100,0 100,-100"/></edge>
    <connection from="a" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
    <connection from="a" to="c" fromLane="0" toLane="0" dir="r" state="M"/>
</net>"#;

#[test]
fn a_path_is_rebuilt_only_for_another_route() {
    let net = Arc::new(closecall_run::net::parse(Path::new("fork.net.xml"), FORK).unwrap());
    let mut roster = Roster::default();
    let profile = roster.profile(closecall_study::stress::car()).unwrap();
    let (user, mut frame) = (roster.enter("car", profile), Frame::default());
    let mut detector = Detector::new(&Options::default(), Some(net.clone()));
    // The end of the path; the car stays at the same place in every step.
    let mut path_end = |route: Option<[&str; 2]>, lateral_speed: f64| {
        frame.begin(frame.time + 1.0);
        frame.push(user, State { x: 80.0, y: 0.0, z: 0.0, heading: 0.0, speed: 25.0 });
        assert_eq!(detector.track_paths(&frame, &roster), [0]);
        let route = route.map(|edges| edges.iter().map(|edge| net.edge(edge).unwrap()).collect());
        let lane = net.lane("a_0").unwrap();
        let placement = Placement { lane, position: 80.0, route, route_position: 0, lateral_speed };
        detector.set_placement(&frame, &roster, 0, &placement);
        detector.broad_phase(&frame, &roster);
        detector.path(&frame, &roster, 0).pop().unwrap()
    };
    let drifts = path_end(Some(["a", "b"]), 1.0);
    assert!(drifts.y > 1.0, "{drifts}");
    assert_eq!(path_end(Some(["a", "b"]), 0.0), drifts);
    assert_eq!(path_end(None, 0.0), drifts);
    let turns = path_end(Some(["a", "c"]), 0.0);
    assert!(turns.y < -10.0, "{turns}");
}
