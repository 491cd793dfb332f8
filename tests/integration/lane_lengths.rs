//! Lanes that are longer or shorter than they are drawn: gap, μ and TTC are in SUMO's metres along the lane.

use std::path::Path;
use std::sync::Arc;

use closecall::{Detector, Encounter, Frame, Net, Options, Placement, Profile, Roster, State, SumoType};

/// Two lanes of 100 m as drawn, one after the other, with these lengths for SUMO.
fn net(lengths: [f64; 2]) -> Arc<Net> {
    let [first, second] = lengths;
    let text = format!(
        r#"<net>
            <edge id="a" from="w" to="m"><lane id="a_0" index="0" length="{first}" shape="0,0 60,0 100,0"/></edge>
            <edge id="b" from="m" to="e"><lane id="b_0" index="0" length="{second}" shape="100,0 200,0"/></edge>
            <connection from="a" to="b" fromLane="0" toLane="0" dir="s" state="M"/>
        </net>"#
    );
    Arc::new(closecall_run::net::parse(Path::new("stretched.net.xml"), text).unwrap())
}

/// The encounter of two cars of 5 m at these distances along both lanes, in SUMO's metres, with these speeds.
fn encounter(lengths: [f64; 2], cars: [(f64, f64); 2]) -> Option<Encounter> {
    encounter_beside(lengths, cars, 0.0)
}

/// The same with both this far to the left of the centre line.
fn encounter_beside(lengths: [f64; 2], cars: [(f64, f64); 2], y: f64) -> Option<Encounter> {
    let net = net(lengths);
    let mut roster = Roster::default();
    let profile = roster.profile(Profile::vehicle(&SumoType::car("car"), &Options::default())).unwrap();
    let mut frame = Frame::default();
    frame.begin(0.0);
    let mut placements = Vec::new();
    for (id, (position, speed)) in ["follower", "leader"].into_iter().zip(cars) {
        let [first, second] = lengths;
        let (lane, position, x) = match position {
            on_first if on_first <= first => ("a_0", on_first, on_first / first * 100.0),
            on_second => ("b_0", on_second - first, 100.0 + (on_second - first) / second * 100.0),
        };
        frame.push(roster.enter(id, profile), State { x, y, z: 0.0, heading: 0.0, speed });
        placements.push(Placement {
            lane: net.lane(lane).unwrap(),
            position,
            route: Some(["a", "b"].iter().map(|edge| net.edge(edge).unwrap()).collect()),
            route_position: usize::from(lane == "b_0"),
            lateral_speed: 0.0,
        });
    }
    let mut detector = Detector::new(&Options::default(), Some(net));
    for row in detector.track_paths(&frame, &roster).to_vec() {
        detector.set_placement(&frame, &roster, row, &placements[row as usize]);
    }
    detector.broad_phase(&frame, &roster);
    detector.narrow_phase(&frame, &roster).next().copied()
}

/// Checks that a follower at 20 m/s, 35 m behind a leader at `speed`, has the gap and the TTC that it has on the lane.
fn is_as_on_the_lane(lengths: [f64; 2], position: f64, speed: f64) {
    let found = encounter(lengths, [(position, 20.0), (position + 40.0, speed)]).unwrap();
    let as_drawn = encounter([100.0, 100.0], [(20.0, 20.0), (60.0, speed)]).unwrap();
    // The sweep of a rectangle is exact to 2.5 cm of the drawing, here at most 7.5 cm along the lane.
    let near = |found: f64, right: f64| (found - right).abs() < 0.075;
    assert!(near(found.gap, 35.0) && near(found.mu, as_drawn.mu), "{lengths:?} at {position}: {found:?}");
    let closing = 20.0 - speed;
    let ttc = found.nearness.unwrap().values.ttc().unwrap();
    assert!((ttc - 35.0 / closing).abs() < 1e-6, "{lengths:?} at {position}: TTC {ttc}");
    let drac = found.nearness.unwrap().values.drac().unwrap();
    assert!((drac - closing * closing / 70.0).abs() < 0.01, "{lengths:?} at {position}: DRAC {drac}");
}

#[test]
fn gap_and_ttc_are_those_along_the_lane() {
    for lengths in [[200.0, 200.0], [300.0, 300.0], [100.0, 100.0]] {
        is_as_on_the_lane(lengths, 30.0, 10.0);
        is_as_on_the_lane(lengths, 30.0, 0.0);
    }
}

#[test]
fn lengths_are_converted_where_lanes_join() {
    for lengths in [[200.0, 100.0], [100.0, 200.0], [60.0, 150.0]] {
        // The follower is on the first lane, the leader on the second.
        is_as_on_the_lane(lengths, lengths[0] - 20.0, 10.0);
    }
}

#[test]
fn a_lane_half_a_percent_longer_than_drawn_is_as_long_as_it_says() {
    for lengths in [[100.5, 100.5], [100.05, 100.0], [99.5, 100.5]] {
        for position in [30.0, lengths[0] - 20.0] {
            let found = encounter(lengths, [(position, 20.0), (position + 40.0, 10.0)]).unwrap();
            let ttc = found.nearness.unwrap().values.ttc().unwrap();
            // The leader is drawn as long as where it is now, also on the next lane.
            let is_as_on_the_lane = (found.gap - 35.0).abs() < 0.03 && (ttc - 3.5).abs() < 6e-3;
            assert!(is_as_on_the_lane, "{lengths:?} at {position}: {} m, {ttc} s", found.gap);
        }
    }
}

#[test]
fn two_that_stand_apart_on_the_lane_do_not_touch() {
    // 2.5 m are left; as drawn, with their full lengths, the two would overlap by 1.25 m.
    let found = encounter([400.0, 400.0], [(100.0, 0.1), (107.5, 0.0)]);
    assert!(found.is_none_or(|found| !found.collision && found.overlap == 0.0), "{found:?}");
}

#[test]
fn a_vehicle_is_drawn_as_long_as_all_lanes_under_it() {
    for beside in [0.0, 0.4] {
        let clearance = |lengths, cars| {
            let found = encounter_beside(lengths, cars, beside).unwrap();
            assert!(!found.collision, "{found:?}");
            found.nearness.unwrap().clearance
        };
        // The leader is 1 m beyond the end of the first lane; 4 m of it are on that lane, which is drawn at a quarter.
        let shorter = clearance([400.0, 100.0], [(393.0, 4.0), (401.0, 3.0)]);
        assert!((shorter - 0.75).abs() < 1e-9, "{shorter} at {beside} m");
        // The first lane is drawn at four times its length.
        let longer = clearance([25.0, 100.0], [(18.0, 4.0), (26.0, 3.0)]);
        assert!((longer - 12.0).abs() < 1e-9, "{longer} at {beside} m");
    }
}
