//! Roads that cross on a bridge, in nets with and without heights.

use std::path::Path;
use std::sync::Arc;

use closecall::{Detector, Encounter, Frame, Net, Options, Placement, Profile, Roster, State, SumoType};

/// Two streets that cross at the origin, from west to east and from south to north; `node` is where the second begins and
/// `heights` are those of its two ends.
fn net(node: &str, heights: [&str; 2]) -> Arc<Net> {
    let [low, high] = heights;
    let text = format!(
        r#"<net>
            <edge id="we" from="w" to="e"><lane id="we_0" index="0" length="400" shape="-200,0 200,0"/></edge>
            <edge id="sn" from="{node}" to="n"><lane id="sn_0" index="0" length="400" shape="0,-200{low} 0,200{high}"/></edge>
            <junction id="w" x="-200" y="0" shape="-200,-2 -200,2"/>
            <junction id="e" x="200" y="0" shape="200,-2 200,2"/>
        </net>"#
    );
    Arc::new(closecall_run::net::parse(Path::new("bridge.net.xml"), text).unwrap())
}

const NORTH: f64 = std::f64::consts::FRAC_PI_2;

/// The encounter of two cars that would be at the crossing at the same time; `aside` is how far the second is beside its lane.
fn crossing(net: Arc<Net>, aside: f64, z: f64) -> Option<Encounter> {
    let mut roster = Roster::default();
    let profile = roster.profile(Profile::vehicle(&SumoType::car("car"), &Options::default())).unwrap();
    let mut frame = Frame::default();
    frame.begin(0.0);
    let states = [
        State { x: -20.0, y: 0.0, z: 0.0, heading: 0.0, speed: 15.0 },
        State { x: aside, y: -20.0, z, heading: NORTH, speed: 15.0 },
    ];
    let lanes = [("we_0", "we"), ("sn_0", "sn")];
    for (id, state) in ["a", "b"].into_iter().zip(states) {
        frame.push(roster.enter(id, profile), state);
    }
    let mut detector = Detector::new(&Options::default(), Some(net.clone()));
    for row in detector.track_paths(&frame, &roster).to_vec() {
        let (lane, edge) = lanes[row as usize];
        let placement = Placement {
            lane: net.lane(lane).unwrap(),
            position: 180.0,
            route: Some([net.edge(edge).unwrap()].into()),
            route_position: 0,
            lateral_speed: 0.0,
        };
        detector.set_placement(&frame, &roster, row, &placement);
    }
    detector.broad_phase(&frame, &roster);
    detector.narrow_phase(&frame, &roster).next().copied()
}

#[test]
fn streets_that_cross_without_a_junction_are_on_two_levels() {
    assert_eq!(crossing(net("s", ["", ""]), 0.0, 0.0), None);
}

#[test]
fn far_from_their_common_junction_they_are_on_two_levels() {
    assert_eq!(crossing(net("w", ["", ""]), 0.0, 0.0), None);
}

#[test]
fn where_a_net_has_heights_these_decide() {
    let rises = |z| crossing(net("s", [",0", ",9"]), 0.0, z);
    assert!(rises(0.0).is_some() && rises(2.0).is_some());
    assert_eq!(rises(4.0), None);
}

#[test]
fn a_vehicle_off_its_road_can_meet_any_other() {
    assert!(crossing(net("s", ["", ""]), 4.0, 0.0).is_some());
}
