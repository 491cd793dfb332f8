//! Positions and speeds of SUMO's Euler update, brought to one moment.

use std::f64::consts::FRAC_PI_2;

use closecall::geometry::Vector;
use closecall::{Align, Detector, Frame, Net, Options, Placement, Profile, Roster, State, SumoType};

use super::road::Road;
use proptest::prelude::*;

fn car() -> Profile {
    Profile::vehicle(&SumoType::car("car"), &Options::default())
}

/// The states after a second step, 1 s after the first, and the first TTC; with a net, all are about this far along its lane.
fn second_step(detector: &mut Detector, net: Option<(&Net, f64)>, steps: [&[State]; 2]) -> (Vec<State>, Option<f64>) {
    last_step(detector, net, &steps)
}

/// The same after steps 1 s apart.
fn last_step(detector: &mut Detector, net: Option<(&Net, f64)>, steps: &[&[State]]) -> (Vec<State>, Option<f64>) {
    steps_at(detector, net.map(|(net, position)| (net, vec![position; steps.len()])), steps)
}

/// The same with the position along the lane in each step.
fn steps_at(detector: &mut Detector, net: Option<(&Net, Vec<f64>)>, steps: &[&[State]]) -> (Vec<State>, Option<f64>) {
    let (mut roster, mut frame) = (Roster::default(), Frame::default());
    let profile = roster.profile(car()).unwrap();
    let users = steps[0].iter().enumerate().map(|(number, _)| roster.enter(&number.to_string(), profile));
    let users = users.collect::<Vec<_>>();
    for (time, states) in steps.iter().enumerate() {
        frame.begin(time as f64);
        for (user, state) in users.iter().zip(*states) {
            frame.push(*user, *state);
        }
        for row in detector.track_paths(&frame, &roster).to_vec() {
            let Some((net, positions)) = &net else { continue };
            let placement = Placement {
                lane: net.lane("e_0").unwrap(),
                position: positions[time],
                route: Some([net.edge("e").unwrap()].into()),
                route_position: 0,
                lateral_speed: 0.0,
            };
            detector.set_placement(&frame, &roster, row, &placement);
        }
        detector.align(&mut frame, &roster);
        detector.broad_phase(&frame, &roster);
        _ = detector.narrow_phase(&frame, &roster);
    }
    let ttc = detector.encounters().find_map(|found| found.nearness?.values.ttc());
    (frame.rows().map(|row| row.state).collect(), ttc)
}

fn aligning(net: Option<&Road>) -> Detector {
    let mut detector = Detector::new(&Options::default(), net.map(|road| road.net.clone()));
    detector.set_averaged_over(1.0);
    detector
}

#[test]
fn on_lanes_half_a_step_back_follows_the_bend() {
    let (road, car) = (Road::bend(), car());
    let at = |distance: f64| road.vehicle(&car, distance, 8.0);
    for front in (20..200).map(f64::from) {
        let (found, _) =
            second_step(&mut aligning(Some(&road)), Some((&road.net, front - 8.0)), [&[at(front - 8.0)], &[at(front)]]);
        let (found, expected) = (found[0], at(front - 4.0));
        assert!((found.front() - expected.front()).norm() < 1e-9, "{front}: {found:?} {expected:?}");
        assert!((found.heading - expected.heading).abs() < 1e-9, "{front}: {found:?} {expected:?}");
    }
}

#[test]
fn without_lanes_half_a_step_back_is_straight() {
    let state = |x: f64| State { x, y: 2.0, heading: std::f64::consts::PI, speed: 6.0, ..State::default() };
    let (found, _) = second_step(&mut aligning(None), None, [&[state(10.0)], &[state(4.0)]]);
    assert!((found[0].x - 7.0).abs() < 1e-12 && (found[0].y - 2.0).abs() < 1e-12, "{found:?}");
}

#[test]
fn half_a_step_back_the_time_to_collision_is_half_a_step_longer() {
    let pair = |x: f64| [State { x, speed: 12.0, ..State::default() }, State { x: 40.0, ..State::default() }];
    let ttc = |align: Align| {
        let mut detector = Detector::new(&Options { align, ..Options::default() }, None);
        detector.set_averaged_over(1.0);
        second_step(&mut detector, None, [&pair(8.0), &pair(20.0)]).1.unwrap()
    };
    assert!((ttc(Align::Auto) - ttc(Align::Never) - 0.5).abs() < 1e-9);
    assert_eq!(ttc(Align::Auto), ttc(Align::Always));
}

#[test]
fn speeds_of_a_moment_are_left_where_they_are() {
    let state = State { x: 5.0, speed: 5.0, ..State::default() };
    let mut detector = Detector::new(&Options::default(), None);
    assert_eq!(second_step(&mut detector, None, [&[State { x: 0.0, ..state }], &[state]]).0, [state]);
}

#[test]
fn a_change_of_lanes_comes_after_the_step() {
    let (road, car) = (Road::bend(), car());
    let at = |distance: f64| road.vehicle(&car, distance, 8.0);
    // The other lane may begin some metres further on.
    let fronts = (48..200).map(f64::from);
    for (front, further) in fronts.flat_map(|front| [(front, 0.0), (front, 6.0)]) {
        let along = (road.at(front + 0.1) - road.at(front - 0.1)).normalize();
        let moved = Vector::new(along.y, -along.x) * 3.2 + along * further;
        let mut to = at(front);
        (to.x, to.y, to.heading) = (to.x + moved.x, to.y + moved.y, to.heading - 0.7);
        let steps: [&[State]; 2] = [&[at(front - 8.0)], &[to]];
        let (found, _) = second_step(&mut aligning(Some(&road)), Some((&road.net, front - 8.0)), steps);
        let (found, expected) = (found[0], at(front - 4.0));
        assert!((found.front() - expected.front()).norm() < 1e-9, "{front}: {found:?} {expected:?}");
        assert!((found.heading - expected.heading).abs() < 1e-9, "{front}: {found:?} {expected:?}");
    }
}

#[test]
fn one_that_stands_changes_lanes_after_the_step() {
    let (road, car) = (Road::bend(), car());
    for front in (48..200).map(f64::from) {
        let expected = State { speed: 0.0, ..road.vehicle(&car, front, 8.0) };
        let along = road.at(front + 0.1) - road.at(front - 0.1);
        let aside = Vector::new(along.y, -along.x).normalize() * 3.2;
        let to = State { x: expected.x + aside.x, y: expected.y + aside.y, ..expected };
        let steps: [&[State]; 2] = [&[road.vehicle(&car, front, 8.0)], &[to]];
        let (found, _) = second_step(&mut aligning(Some(&road)), Some((&road.net, front)), steps);
        assert!((found[0].front() - expected.front()).norm() < 1e-9, "{front}: {found:?} {expected:?}");
    }
}

#[test]
fn one_that_is_put_elsewhere_has_not_changed_lanes() {
    let (road, car) = (Road::bend(), car());
    let before = road.vehicle(&car, 60.0, 8.0);
    let to = State { x: before.x + 30.0, y: before.y + 30.0, speed: 2.0, ..before };
    let steps: [&[State]; 2] = [&[before], &[to]];
    let (found, _) = second_step(&mut aligning(Some(&road)), Some((&road.net, 60.0)), steps);
    assert_eq!(found, [to]);
}

#[test]
fn what_enters_after_the_moment_meets_nothing_and_stays() {
    let states = |[behind, ahead]: [f64; 2], is_new: bool| {
        let [behind, ahead] = [(20.0, behind), (28.0, ahead)].map(|(x, speed)| State { x, speed, ..State::default() });
        let back = |state: State| State { x: state.x - state.speed, ..state };
        let before = if is_new { State { speed: f64::NAN, ..ahead } } else { back(ahead) };
        let mut detector = aligning(None);
        let (found, _) = second_step(&mut detector, None, [&[back(behind), before], &[behind, ahead]]);
        (detector.encounters().count(), found[1].x)
    };
    assert_eq!((states([20.0, 18.0], false), states([20.0, 18.0], true)), ((1, 19.0), (0, 28.0)));
    assert_eq!((states([20.0, 0.0], false), states([20.0, 0.0], true)), ((1, 28.0), (0, 28.0)));
}

#[test]
fn what_was_put_elsewhere_meets_nothing_there() {
    let (road, car) = (Road::bend(), car());
    let stands = road.vehicle(&car, 100.0, 0.0);
    let encounters = |from: f64| {
        let mut detector = aligning(Some(&road));
        let before = road.vehicle(&car, from, 8.0);
        let steps: [&[State]; 2] = [&[before, stands], &[road.vehicle(&car, 93.0, 8.0), stands]];
        second_step(&mut detector, Some((&road.net, from)), steps);
        detector.encounters().count()
    };
    assert_eq!((encounters(85.0), encounters(60.0)), (1, 0));
}

#[test]
fn one_that_was_away_for_a_step_is_where_it_came_back() {
    let (road, car) = (Road::bend(), car());
    let [before, elsewhere] = [95.0, 170.0].map(|front| road.vehicle(&car, front, 8.0));
    let (mut detector, mut roster, mut frame) = (aligning(Some(&road)), Roster::default(), Frame::default());
    let profile = roster.profile(car).unwrap();
    let user = roster.enter("teleported", profile);
    for (time, state) in [Some(before), None, Some(elsewhere)].into_iter().enumerate() {
        frame.begin(time as f64);
        if let Some(state) = state {
            frame.push(user, state);
        }
        for row in detector.track_paths(&frame, &roster).to_vec() {
            let placement = Placement {
                lane: road.net.lane("e_0").unwrap(),
                position: if time == 0 { 95.0 } else { 170.0 },
                route: Some([road.net.edge("e").unwrap()].into()),
                route_position: 0,
                lateral_speed: 0.0,
            };
            detector.set_placement(&frame, &roster, row, &placement);
        }
        detector.align(&mut frame, &roster);
        detector.broad_phase(&frame, &roster);
    }
    assert_eq!(*frame.state(0), elsewhere);
}

#[test]
fn one_that_a_script_steers_is_half_way_on_its_own_way() {
    let road = Road::bend();
    // Across the lane, at steps of which each is more and less than a lane wide, and askew.
    for (angle, speed) in [(FRAC_PI_2, 8.0), (FRAC_PI_2, 2.0), (FRAC_PI_2, 0.5), (0.8, 8.0), (0.8, 1.0), (-1.2, 12.0)] {
        let at = |past: f64| {
            let (sine, cosine) = angle.sin_cos();
            State { x: 50.0 + past * speed * cosine, y: past * speed * sine, z: 0.0, heading: angle, speed }
        };
        let steps: [&[State]; 2] = [&[at(-0.7)], &[at(0.3)]];
        let (found, _) = second_step(&mut aligning(Some(&road)), Some((&road.net, 50.0)), steps);
        let (found, expected) = (found[0], at(-0.2));
        assert!((found.front() - expected.front()).norm() < 1e-9, "{found:?} {expected:?}");
        assert_eq!(found.heading, angle);
    }
}

#[test]
fn one_that_a_script_steers_is_predicted_where_it_heads() {
    let road = Road::bend();
    let crossing = |y: f64| State { x: 50.0, y, z: 0.0, heading: FRAC_PI_2, speed: 8.0 };
    let stands = State { x: 50.0, y: 9.0, z: 0.0, heading: FRAC_PI_2, speed: 0.0 };
    let mut detector = aligning(Some(&road));
    second_step(&mut detector, Some((&road.net, 50.0)), [&[crossing(-8.0), stands], &[crossing(0.0), stands]]);
    assert_eq!(detector.encounters().count(), 1);
}

#[test]
fn a_rear_before_the_begin_of_a_lane_is_on_no_bend() {
    // A turnaround leads to the begin of the lane, at (0, 0); SUMO has inserted a car there, straight on its lane.
    let lane = |id: &str, shape: &str, length: f64| {
        format!(
            r#"<edge id="{id}" {}><lane id="{id}_0" index="0" length="{length}" width="3.2" shape="{shape}"/></edge>"#,
            if id.starts_with(':') { r#"function="internal""# } else { r#"from="a" to="b""# }
        )
    };
    let text = format!(
        r#"<net>{}{}{}<connection from="back" to="e" fromLane="0" toLane="0" via=":a_0_0"/>
        <connection from=":a_0" to="e" fromLane="0" toLane="0"/></net>"#,
        lane(":a_0", "0,3.2 -1.2,2.4 -1.6,1.6 -1.2,0.8 0,0", 4.67),
        lane("e", "0,0 300,0", 300.0),
        lane("back", "300,3.2 0,3.2", 300.0),
    );
    let net = std::sync::Arc::new(closecall_run::net::parse(std::path::Path::new("turnaround.net.xml"), text).unwrap());
    // A car beside another one, 1.4 m away.
    let both = |x: f64| [0.0, 3.2].map(|y| State { x, y, z: 0.0, heading: 0.0, speed: 10.0 });
    for front in [1.0, 2.0, 5.0, 8.0] {
        let (inserted, next) = (both(front), both(front + 10.0));
        for steps in [&[&inserted[..]][..], &[&inserted, &next]] {
            let mut detector = Detector::new(&Options::default(), Some(net.clone()));
            detector.set_averaged_over(1.0);
            let (found, _) = last_step(&mut detector, Some((&net, front)), steps);
            assert_eq!(detector.encounters().count(), 0, "{front}");
            let expected = if steps.len() > 1 { front + 5.0 } else { front };
            assert!((found[0].x - expected).abs() < 1e-9 && found[0].heading == 0.0, "{found:?}");
        }
    }
}

proptest! {
    /// Within the circle through both reported places, and half a metre: so far from its path a vehicle may be.
    #[test]
    fn no_place_lies_outside_of_the_two_reported_ones(
        front in 20.0..200.0_f64, aside in prop_oneof![Just(0.0), -4.0..4.0], further in -12.0..12.0_f64,
        turned in prop_oneof![Just(0.0), -3.0..3.0], before in prop_oneof![Just(0.0), -3.0..3.0],
        speed in prop_oneof![Just(0.0), 0.0..20.0], has_net in any::<bool>(),
    ) {
        let (road, car) = (Road::bend(), car());
        let last = road.vehicle(&car, front, speed);
        let last = State { heading: last.heading + before, ..last };
        let ahead = (front + speed + further).max(6.0);
        let to = road.vehicle(&car, ahead, speed);
        let across = Vector::new(-to.heading.sin(), to.heading.cos()) * aside;
        let to = State { x: to.x + across.x, y: to.y + across.y, heading: to.heading + turned, ..to };
        let net = has_net.then_some(&road);
        let places = net.map(|road| (&*road.net, vec![front, ahead]));
        let (found, _) = steps_at(&mut aligning(net), places, &[&[last], &[to]]);
        let (from, to, found) = (last.front(), to.front(), found[0]);
        let middle = from + (to - from) / 2.0;
        let outside = (found.front() - middle).norm() - (to - from).norm() / 2.0;
        prop_assert!(outside <= 0.5, "{outside} m: {found:?} {last:?} {to:?}");
        let back = (found.front() - to).norm();
        prop_assert!(back <= speed / 2.0 + aside.hypot(further) + 0.5, "{back} m back at {speed} m/s");
    }
}
