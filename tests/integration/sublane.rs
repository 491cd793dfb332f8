//! The sublane model: a vehicle that drifts to the side stays within its lanes.

use std::sync::Arc;

use closecall::{Detector, Frame, Net, Options, Placement, Roster, State};

use super::street::{left_hand_street, street};

/// Number of encounters when the eastbound car is at y and drifts to the left, towards the oncoming lane.
fn encounters(y: f64, drift: f64) -> usize {
    encounters_on(street(), 1.0, y, drift)
}

/// The same on a net; where `left` is −1, all is mirrored, but for SUMO's lateral speeds.
fn encounters_on(net: Arc<Net>, left: f64, y: f64, drift: f64) -> usize {
    let mut roster = Roster::default();
    let profile = roster.profile(closecall_study::stress::car()).unwrap();
    let mut frame = Frame::default();
    frame.begin(0.0);
    let states = [(80.0, y, 0.0), (120.0, 1.6, std::f64::consts::PI)];
    for (name, (x, y, heading)) in ["east", "west"].into_iter().zip(states) {
        let user = roster.enter(name, profile);
        frame.push(user, State { x, y: left * y, z: 0.0, heading, speed: 12.0 });
    }
    let mut detector = Detector::new(&Options::default(), Some(net.clone()));
    detector.set_sublane(true);
    for row in detector.track_paths(&frame, &roster).to_vec() {
        let name = ["east", "west"][row as usize];
        let placement = Placement {
            lane: net.lane(&format!("{name}_0")).unwrap(),
            position: 80.0,
            route: Some(Arc::new([net.edge(name).unwrap()])),
            route_position: 0,
            lateral_speed: if row == 0 { drift } else { 0.0 },
        };
        detector.set_placement(&frame, &roster, row, &placement);
    }
    detector.broad_phase(&frame, &roster);
    detector.narrow_phase(&frame, &roster).len()
}

#[test]
fn a_drift_ends_at_the_border_of_the_last_lane() {
    assert_eq!(encounters(-1.6, 0.5), 0);
    // The border itself: half of 3.2 m less 2 m to the left of the centre.
    assert_eq!(encounters(-1.0, 0.5), 0);
}

#[test]
fn a_car_across_the_border_meets_oncoming_traffic() {
    assert_eq!(encounters(0.5, 0.0), 1);
}

#[test]
fn a_left_hand_net_is_a_right_hand_one_mirrored() {
    for (y, drift, expected) in [(0.5, -1.0, 0), (0.5, 0.0, 1), (-1.6, 0.5, 0)] {
        assert_eq!(encounters(y, drift), expected, "{y} {drift}");
        assert_eq!(encounters_on(left_hand_street(), -1.0, y, drift), expected, "left hand: {y} {drift}");
    }
}
