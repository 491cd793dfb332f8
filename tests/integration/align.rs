//! Positions and speeds of SUMO's Euler update, brought to one moment.

use closecall::internals::geometry::Vector;
use closecall::{Align, Detector, Frame, Net, Options, Placement, Profile, Roster, State, SumoType};

use super::way::Way;

fn car() -> Profile {
    Profile::vehicle(&SumoType::car("car"), &Options::default())
}

/// The states after a second step, 1 s after the first, and the first TTC; with a net, all are about this far along its lane.
fn second_step(detector: &mut Detector, net: Option<(&Net, f64)>, steps: [&[State]; 2]) -> (Vec<State>, Option<f64>) {
    let (mut roster, mut frame) = (Roster::default(), Frame::default());
    let profile = roster.profile(car()).unwrap();
    let users = steps[0].iter().enumerate().map(|(number, _)| roster.enter(&number.to_string(), profile));
    let users = users.collect::<Vec<_>>();
    for (states, time) in steps.into_iter().zip([0.0, 1.0]) {
        frame.begin(time);
        for (user, state) in users.iter().zip(states) {
            frame.push(*user, *state);
        }
        for row in detector.track_paths(&frame, &roster).to_vec() {
            let Some((net, position)) = net else { continue };
            let placement = Placement {
                lane: net.lane("e_0").unwrap(),
                position,
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
    let ttc = detector.encounters().find_map(|found| found.nearness?.ttc);
    (frame.rows().map(|row| row.state).collect(), ttc)
}

fn aligning(net: Option<&Way>) -> Detector {
    let mut detector = Detector::new(&Options::default(), net.map(|way| way.net.clone()));
    detector.set_averaged_over(1.0);
    detector
}

#[test]
fn on_lanes_half_a_step_back_follows_the_bend() {
    let (way, car) = (Way::bend(), car());
    let at = |distance: f64| way.vehicle(&car, distance, 8.0);
    for front in (20..200).map(f64::from) {
        let (found, _) =
            second_step(&mut aligning(Some(&way)), Some((&way.net, front)), [&[at(front - 8.0)], &[at(front)]]);
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
    let (way, car) = (Way::bend(), car());
    let at = |distance: f64| way.vehicle(&car, distance, 8.0);
    // The other lane may begin some metres further on.
    let fronts = (48..200).map(f64::from);
    for (front, further) in fronts.flat_map(|front| [(front, 0.0), (front, 6.0)]) {
        let along = (way.at(front + 0.1) - way.at(front - 0.1)).normalize();
        let moved = Vector::new(along.y, -along.x) * 3.2 + along * further;
        let mut to = at(front);
        (to.x, to.y, to.heading) = (to.x + moved.x, to.y + moved.y, to.heading - 0.7);
        let steps: [&[State]; 2] = [&[at(front - 8.0)], &[to]];
        let (found, _) = second_step(&mut aligning(Some(&way)), Some((&way.net, front - 8.0)), steps);
        let (found, expected) = (found[0], at(front - 4.0));
        assert!((found.front() - expected.front()).norm() < 1e-9, "{front}: {found:?} {expected:?}");
        assert!((found.heading - expected.heading).abs() < 1e-9, "{front}: {found:?} {expected:?}");
    }
}

#[test]
fn one_that_stands_changes_lanes_after_the_step() {
    let (way, car) = (Way::bend(), car());
    for front in (48..200).map(f64::from) {
        let expected = State { speed: 0.0, ..way.vehicle(&car, front, 8.0) };
        let along = way.at(front + 0.1) - way.at(front - 0.1);
        let aside = Vector::new(along.y, -along.x).normalize() * 3.2;
        let to = State { x: expected.x + aside.x, y: expected.y + aside.y, ..expected };
        let steps: [&[State]; 2] = [&[way.vehicle(&car, front, 8.0)], &[to]];
        let (found, _) = second_step(&mut aligning(Some(&way)), Some((&way.net, front)), steps);
        assert!((found[0].front() - expected.front()).norm() < 1e-9, "{front}: {found:?} {expected:?}");
    }
}

#[test]
fn one_that_is_put_elsewhere_has_not_changed_lanes() {
    let (way, car) = (Way::bend(), car());
    let before = way.vehicle(&car, 60.0, 8.0);
    let to = State { x: before.x + 30.0, y: before.y + 30.0, speed: 2.0, ..before };
    let steps: [&[State]; 2] = [&[before], &[to]];
    let (found, _) = second_step(&mut aligning(Some(&way)), Some((&way.net, 60.0)), steps);
    assert!((found[0].front() - to.front()).norm() < 1.0 + 1e-9, "{found:?} {to:?}");
}

#[test]
fn what_enters_after_the_moment_collides_with_nothing() {
    let encounters = |[behind, ahead]: [f64; 2], is_new: bool| {
        let [behind, ahead] = [(20.0, behind), (28.0, ahead)].map(|(x, speed)| State { x, speed, ..State::default() });
        let before = State { speed: if is_new { f64::NAN } else { ahead.speed }, ..ahead };
        let mut detector = aligning(None);
        second_step(&mut detector, None, [&[behind, before], &[behind, ahead]]);
        let collisions = detector.encounters().filter(|found| found.collision).count();
        (detector.encounters().count(), collisions)
    };
    // Half a step back the first of these overlap.
    assert_eq!((encounters([20.0, 28.0], false), encounters([20.0, 28.0], true).1), ((1, 1), 0));
    assert_eq!((encounters([20.0, 18.0], false), encounters([20.0, 18.0], true)), ((1, 0), (1, 0)));
    assert_eq!((encounters([20.0, 0.0], false).0, encounters([20.0, 0.0], true).0), (1, 0));
}

#[test]
fn what_was_put_elsewhere_meets_nothing_there() {
    let (way, car) = (Way::bend(), car());
    let stands = way.vehicle(&car, 100.0, 0.0);
    let encounters = |from: f64| {
        let mut detector = aligning(Some(&way));
        let before = way.vehicle(&car, from, 8.0);
        let steps: [&[State]; 2] = [&[before, stands], &[way.vehicle(&car, 93.0, 8.0), stands]];
        second_step(&mut detector, Some((&way.net, from)), steps);
        detector.encounters().count()
    };
    assert_eq!((encounters(85.0), encounters(60.0)), (1, 0));
}

#[test]
fn one_that_was_away_for_a_step_is_where_it_came_back() {
    let (way, car) = (Way::bend(), car());
    let [before, elsewhere, expected] = [95.0, 170.0, 166.0].map(|front| way.vehicle(&car, front, 8.0));
    let (mut detector, mut roster, mut frame) = (aligning(Some(&way)), Roster::default(), Frame::default());
    let profile = roster.profile(car).unwrap();
    let user = roster.enter("teleported", profile);
    for (time, state) in [Some(before), None, Some(elsewhere)].into_iter().enumerate() {
        frame.begin(time as f64);
        if let Some(state) = state {
            frame.push(user, state);
        }
        for row in detector.track_paths(&frame, &roster).to_vec() {
            let placement = Placement {
                lane: way.net.lane("e_0").unwrap(),
                position: if time == 0 { 95.0 } else { 170.0 },
                route: Some([way.net.edge("e").unwrap()].into()),
                route_position: 0,
                lateral_speed: 0.0,
            };
            detector.set_placement(&frame, &roster, row, &placement);
        }
        detector.align(&mut frame, &roster);
        detector.broad_phase(&frame, &roster);
    }
    let found = frame.state(0);
    assert!((found.front() - expected.front()).norm() < 1e-9, "{found:?} {expected:?}");
}
