//! The manoeuvre and the causes of a conflict, from the net, the traffic lights and how the two drive.

use std::path::Path;
use std::sync::Arc;

use closecall::{Category, Conflict, Net, Placement, Profile, State};
use closecall_run::Run;
use closecall_study::stress::car;

/// The time between two steps, in s.
const STEP: f64 = 0.1;

/// A car, or a person, that goes along these lanes from a place on the first.
pub(crate) struct Drive {
    pub(crate) lanes: Vec<&'static str>,
    /// Its front on the first lane, in m.
    pub(crate) start: f64,
    /// Its speed by time.
    pub(crate) speed: fn(f64) -> f64,
    /// The number of a lane of the first lane's edge that it moves to, and when.
    pub(crate) change: Option<(f64, &'static str)>,
    pub(crate) category: Category,
    /// When it enters the scene.
    pub(crate) enters: f64,
}

pub(crate) fn drive(lanes: &[&'static str], start: f64, speed: fn(f64) -> f64) -> Drive {
    Drive { lanes: lanes.to_vec(), start, speed, change: None, category: Category::Vehicle, enters: 0.0 }
}

/// What a run of some seconds logs of these cars: kind, manoeuvre and causes.
fn logged(net: &Net, drives: &[Drive], signals: &[(f64, &str)], lasts: f64) -> Vec<[String; 3]> {
    let name =
        |conflict: &Conflict| conflict.manoeuvre.map(|manoeuvre| manoeuvre.name()).unwrap_or_default().to_owned();
    let row = |conflict: &Conflict| [conflict.kind.name().to_owned(), name(conflict), conflict.causes.to_string()];
    conflicts(net, drives, signals, lasts).iter().map(row).collect()
}

/// The conflicts of a run of some seconds. SUMO is taken to move cars to lane 1 for the sake of their route, and back to keep
/// right.
pub(crate) fn conflicts(net: &Net, drives: &[Drive], signals: &[(f64, &str)], lasts: f64) -> Vec<Conflict> {
    conflicts_with(net, drives, signals, &[], lasts)
}

/// The same where those of these numbers have a stop.
fn conflicts_with(net: &Net, drives: &[Drive], signals: &[(f64, &str)], stops: &[u32], lasts: f64) -> Vec<Conflict> {
    let mut run = run_of(net, drives, signals, stops, lasts);
    run.finish().unwrap();
    run.conflicts()
}

/// The run of some seconds, which is not finished.
pub(crate) fn run_of(net: &Net, drives: &[Drive], signals: &[(f64, &str)], stops: &[u32], lasts: f64) -> Run {
    let net = Arc::new(net.clone());
    let mut run = Run::new(&closecall_run::RunOptions::default(), Some(Arc::clone(&net))).unwrap();
    let mut enter = |(drive, number): (&Drive, u32)| {
        let profile = run.roster.profile(Profile { category: drive.category, ..car() }).unwrap();
        run.enter(&format!("car{number}"), profile)
    };
    let users = drives.iter().zip(0..).map(&mut enter).collect::<Vec<_>>();
    let mut routes = drives.iter().map(|drive| drive.start).collect::<Vec<_>>();
    for step in 0..(lasts / STEP) as u32 {
        let time = f64::from(step) * STEP;
        run.begin_step(time);
        if let Some((_, state)) = signals.iter().rfind(|(since, _)| *since <= time) {
            run.set_signal(0, state);
        }
        let mut placements = Vec::new();
        for ((drive, user), displacement) in drives.iter().zip(&users).zip(&mut routes) {
            let speed = (drive.speed)(time);
            *displacement += if step > 0 { speed * STEP } else { 0.0 };
            let mut position = *displacement;
            let mut lanes = drive.lanes.iter().map(|lane| net.lane(lane).unwrap()).peekable();
            let mut lane = lanes.next().unwrap();
            while position > net.lanes[lane].length && lanes.peek().is_some() {
                position -= net.lanes[lane].length;
                lane = lanes.next().unwrap();
            }
            if let Some((_, to)) = drive.change.filter(|(since, _)| *since <= time) {
                lane = net.lane(to).unwrap();
            }
            if time < drive.enters {
                continue;
            }
            let (at, heading) = place(&net, lane, position);
            run.frame.push(*user, State { x: at[0], y: at[1], z: 0.0, heading, speed });
            let edges = drive.lanes.iter().map(|lane| net.lanes[net.lane(lane).unwrap()].edge);
            let route = edges.filter(|edge| !net.edges[*edge].id.starts_with(':')).collect::<Vec<_>>();
            let on = route.iter().position(|edge| *edge == net.lanes[lane].edge).unwrap_or(0);
            placements.push(Placement {
                lane,
                position,
                route: Some(route.into()),
                route_position: on,
                lateral_speed: 0.0,
            });
        }
        for user in run.standing() {
            if stops.iter().any(|number| users[*number as usize] == user) {
                run.set_stopped(user);
            }
        }
        let stepped: closecall_run::Result<()> = run.step(|run, rows| {
            for row in rows {
                run.set_placement(*row, &placements[*row as usize]);
                if let Some(lanes) = run.changed_lanes(*row) {
                    run.set_lane_change_state(*row, if lanes > 0 { 1 << 1 | 1 << 3 } else { 1 << 2 | 1 << 6 });
                }
            }
            Ok::<_, closecall_run::Error>(())
        });
        stepped.unwrap();
    }
    run
}

/// The place and heading at a position on a lane.
fn place(net: &Net, lane: closecall::LaneIndex, position: f64) -> ([f64; 2], f64) {
    let shape = &net.lanes[lane].shape;
    let mut left = position;
    for ends in shape.windows(2) {
        let displacement = ends[1] - ends[0];
        if left <= displacement.norm() || std::ptr::eq(ends.last().unwrap(), shape.last().unwrap()) {
            let at = ends[0] + displacement * (left / displacement.norm());
            return ([at.x, at.y], displacement.y.atan2(displacement.x));
        }
        left -= displacement.norm();
    }
    unreachable!("a lane has two points")
}

pub(crate) fn net_of(scene: &str) -> Net {
    closecall_run::net::read(Path::new(&format!(
        "{}/../../sumo_nets/{scene}/{scene}.net.xml",
        env!("CARGO_MANIFEST_DIR")
    )))
    .unwrap()
}

/// A road of two lanes with a limit of 30 m/s.
pub(crate) fn road() -> Net {
    road_of(r#"from="w" to="e""#, 1.6)
}

/// The same with an edge that is this, its lanes so far to the right and left of the x axis.
fn road_of(edge: &str, beside: f64) -> Net {
    let text = format!(
        r#"<net><edge id="road" {edge}>
        <lane id="road_0" speed="30" length="900" shape="0,-{beside} 900,-{beside}"/>
        <lane id="road_1" speed="30" length="900" shape="0,{beside} 900,{beside}"/>
    </edge></net>"#
    );
    closecall_run::net::parse(Path::new("road.net.xml"), text).unwrap()
}

pub(crate) const LEFT: [&str; 4] = ["from_south_1", ":centre_8_0", ":centre_14_0", "to_west_1"];
pub(crate) const ONCOMING: [&str; 3] = ["from_north_0", ":centre_1_0", "to_south_0"];

/// Two cars on the crossing of `left_turn`, each at a distance before the junction, in m, and with a speed, in m/s.
fn at_the_crossing(routes: [(&[&'static str], f64); 2], signals: &[(f64, &str)]) -> Vec<[String; 3]> {
    let net = net_of("left_turn");
    let drives = routes.map(|(lanes, before)| {
        let length = net.lanes[net.lane(lanes[0]).unwrap()].length;
        drive(lanes, length - before, |_| 10.0)
    });
    logged(&net, &drives, signals, 5.0)
}

#[test]
fn one_that_crosses_against_the_right_of_way_did_not_yield() {
    let net = net_of("side");
    let routes = [
        drive(&["from_south_0", ":crossing_0_0", "to_north_0"], 36.0, |_| 15.0),
        drive(&["from_west_0", ":crossing_1_0", "to_east_0"], 44.0, |_| 15.0),
    ];
    assert_eq!(logged(&net, &routes, &[], 9.0), [["side", "crossing", "did_not_yield"]]);
}

#[test]
fn one_that_lets_the_other_go_first_has_yielded() {
    let net = net_of("side");
    let causes = |[south, west]: [f64; 2]| {
        let routes = [
            drive(&["from_south_0", ":crossing_0_0", "to_north_0"], south, |_| 15.0),
            drive(&["from_west_0", ":crossing_1_0", "to_east_0"], west, |_| 15.0),
        ];
        let found = logged(&net, &routes, &[], 9.0);
        let [[_, manoeuvre, why]] = &found[..] else { panic!("{found:?}") };
        assert_eq!(manoeuvre, "crossing");
        why.clone()
    };
    // In the one order the two miss each other as in the other; only one of them has to yield.
    let [first, second] = [[36.0, 58.0], [58.0, 36.0]].map(causes);
    assert!([("did_not_yield", ""), ("", "did_not_yield")].contains(&(&first, &second)), "{first} {second}");
}

#[test]
fn the_light_at_the_entry_leaves_the_right_of_way() {
    let net = net_of("left_turn");
    let length = |lane: &str| net.lanes[net.lane(lane).unwrap()].length;
    let turns = |time: f64| if time < 2.0 { 0.0 } else { 6.0 };
    let routes =
        [drive(&LEFT[1..], length(LEFT[1]) - 1.0, turns), drive(&ONCOMING, length(ONCOMING[0]) - 18.0, |_| 10.0)];
    // The oncoming car passes its stop line at 1.8 s.
    for (red, cause) in [(1.9, "did_not_yield"), (1.5, "ran_red")] {
        let found = logged(&net, &routes, &[(0.0, "rGrrrrrrgrrr"), (red, "rrrrrrrrrrrr")], 5.0);
        let [[_, manoeuvre, why]] = &found[..] else { panic!("{found:?}") };
        assert_eq!((&**manoeuvre, &**why), ("left_turn_across", cause));
    }
}

#[test]
fn a_left_turn_across_the_oncoming_car_is_named_with_its_light() {
    let routes: [(&[&str], f64); 2] = [(&LEFT, 15.0), (&ONCOMING, 18.0)];
    // Links 1 and 8 of the twelve are those of the two.
    for (signals, cause) in [
        (&[(0.0, "rGrrrrrrgrrr")][..], "did_not_yield"),
        (&[(0.0, "rGrrrrrrgrrr"), (0.8, "rGrrrrrryrrr"), (0.9, "rGrrrrrrrrrr")], "ran_red"),
        (&[], ""),
    ] {
        let found = at_the_crossing(routes, signals);
        let [[_, manoeuvre, why]] = &found[..] else { panic!("{found:?}") };
        assert_eq!((&**manoeuvre, &**why), ("left_turn_across", cause));
    }
}

#[test]
fn late_amber_is_one_that_left_room_to_stop() {
    let routes: [(&[&str], f64); 2] = [(&["from_west_0", ":centre_10_0", "to_east_0"], 38.0), (&ONCOMING, 30.0)];
    // It passes the stop line at 3.8 s. At 10 m/s it could have stopped if amber came 2.6 s before.
    for (amber, cause) in [(1.0, "late_amber"), (1.4, "")] {
        let found = at_the_crossing(routes, &[(0.0, "rGrrrrrrrrGr"), (amber, "rGrrrrrrrryr")]);
        assert_eq!(found, [["side", "crossing", cause]]);
    }
}

#[test]
fn two_that_turn_into_one_road_are_no_crossing() {
    let right: [&str; 3] = ["from_north_0", ":centre_0_0", "to_west_0"];
    let routes: [(&[&str], f64); 2] = [(&["from_east_0", ":centre_4_0", "to_west_0"], 20.0), (&right, 20.0)];
    let found = at_the_crossing(routes, &[]);
    assert!(!found.is_empty() && found.iter().all(|[_, manoeuvre, _]| manoeuvre == "turn_into"), "{found:?}");
}

#[test]
fn a_follower_is_too_close_and_a_leader_brakes_hard() {
    let behind = |gap: f64, leader: fn(f64) -> f64| {
        let found =
            logged(&road(), &[drive(&["road_0"], 100.0, |_| 20.0), drive(&["road_0"], 105.0 + gap, leader)], &[], 1.5);
        let [[_, manoeuvre, why]] = &found[..] else { panic!("{found:?}") };
        assert_eq!(manoeuvre, "following");
        why.clone()
    };
    assert_eq!(behind(14.0, |_| 20.0), "too_close");
    assert_eq!(behind(20.0, |time| 20.0 - 5.0 * time), "leader_braked");
    assert_eq!(behind(20.0, |time| 20.0 - 3.0 * time), "");
}

#[test]
fn one_that_moves_in_front_cuts_in() {
    let follower = || drive(&["road_0"], 100.0, |_| 20.0);
    let leader = |change| Drive { change, ..drive(&["road_1"], 112.0, |_| 17.0) };
    let cut_in = ["rear_end", "cut_in", "changed_lane"];
    assert_eq!(logged(&road(), &[follower(), leader(Some((1.0, "road_0")))], &[], 2.5), [cut_in]);
    assert!(logged(&road(), &[follower(), leader(None)], &[], 2.5).is_empty());
    let behind = Drive { change: Some((1.0, "road_1")), ..follower() };
    let found = logged(&road(), &[behind, leader(None)], &[], 2.5);
    assert_eq!(found, [["rear_end", "lane_change", "changed_lane"]]);
}

#[test]
fn a_change_of_lanes_has_the_reason_that_sumo_told() {
    let reason = |cars: &[Drive]| {
        let found = conflicts(&road(), cars, &[], 2.5);
        found.last().and_then(|conflict| conflict.lane_change_reason).map_or("", |reason| reason.name())
    };
    let follower = || drive(&["road_0"], 100.0, |_| 20.0);
    let leader = || drive(&["road_1"], 112.0, |_| 17.0);
    let to = |drive: Drive, lane, time| Drive { change: Some((time, lane)), ..drive };
    assert_eq!(reason(&[follower(), to(leader(), "road_0", 1.0)]), "keep_right");
    assert_eq!(reason(&[to(follower(), "road_1", 1.0), leader()]), "strategic");
    assert_eq!(reason(&[follower(), drive(&["road_0"], 112.0, |_| 17.0)]), "", "none has changed lanes");
}

#[test]
fn of_two_that_change_lanes_the_later_comes_into_the_way() {
    for (ego, foe, manoeuvre) in [(0.5, 1.0, "cut_in"), (1.0, 0.5, "lane_change")] {
        let changes = |start, speed, time| Drive { change: Some((time, "road_0")), ..drive(&["road_1"], start, speed) };
        let found = logged(&road(), &[changes(100.0, |_| 20.0, ego), changes(119.0, |_| 17.0, foe)], &[], 2.5);
        assert_eq!(found.last(), Some(&["rear_end", manoeuvre, "changed_lane"].map(str::to_owned)));
    }
}

#[test]
fn a_lane_change_within_a_junction_is_one() {
    let change = Some((1.0, "road_0"));
    let cars = [drive(&["road_0"], 100.0, |_| 20.0), Drive { change, ..drive(&["road_1"], 112.0, |_| 17.0) }];
    let found = logged(&road_of(r#"function="internal""#, 1.6), &cars, &[], 2.5);
    assert_eq!(found, [["rear_end", "cut_in", "changed_lane"]]);
}

#[test]
fn lanes_that_overlap_as_drawn_have_no_lane_change() {
    let cars = [drive(&["road_0"], 100.0, |_| 20.0), drive(&["road_1"], 112.0, |_| 17.0)];
    assert_eq!(logged(&road_of(r#"from="w" to="e""#, 0.5), &cars, &[], 2.5), [["rear_end", "side_by_side", ""]]);
}

#[test]
fn a_lane_change_before_the_other_was_there_is_none() {
    let leader = || Drive { change: Some((1.0, "road_0")), ..drive(&["road_1"], 112.0, |_| 17.0) };
    for (enters, manoeuvre, cause) in [(0.0, "cut_in", "changed_lane"), (1.5, "following", "appeared")] {
        let follower = Drive { enters, ..drive(&["road_0"], 90.0, |_| 20.0) };
        assert_eq!(logged(&road(), &[follower, leader()], &[], 2.5), [["rear_end", manoeuvre, cause]]);
    }
}

#[test]
fn a_person_that_stands_walks_neither_along_nor_across() {
    for (speed, manoeuvre) in [((|_| 0.0) as fn(f64) -> f64, "person_standing"), (|_| 1.0, "person_along")] {
        let person = Drive { category: Category::Person, ..drive(&["road_0"], 125.0, speed) };
        let found = logged(&road(), &[drive(&["road_0"], 100.0, |_| 15.0), person], &[], 0.5);
        assert_eq!(found, [["rear_end", manoeuvre, ""]]);
    }
}

/// A lane that bends to the left by this radius in m.
fn bend(radius: f64) -> Net {
    let point = |number: u32| {
        let angle = f64::from(number) / radius;
        format!("{},{}", radius * angle.sin(), radius * (1.0 - angle.cos()))
    };
    let shape = (0..=90).map(point).collect::<Vec<_>>().join(" ");
    let text = format!(
        r#"<net><edge id="bend" from="w" to="n"><lane id="bend_0" speed="30" length="90" shape="{shape}"/></edge></net>"#
    );
    closecall_run::net::parse(Path::new("bend.net.xml"), text).unwrap()
}

#[test]
fn the_end_of_a_queue_is_behind_a_curve_that_hides_it() {
    let causes = |net: &Net, speed: fn(f64) -> f64| {
        let lane = if net.lane("bend_0").is_some() { "bend_0" } else { "road_0" };
        let found = logged(net, &[drive(&[lane], 20.0, |_| 13.0), drive(&[lane], 60.0, speed)], &[], 2.5);
        let [[_, manoeuvre, why]] = &found[..] else { panic!("{found:?}") };
        assert_eq!(manoeuvre, "following");
        why.clone()
    };
    assert_eq!(causes(&bend(18.0), |_| 1.0), "behind_curve");
    assert_eq!(causes(&bend(60.0), |_| 1.0), "");
    assert_eq!(causes(&road(), |_| 1.0), "");
    assert_eq!(causes(&bend(18.0), |_| 5.0), "", "no queue");
}

#[test]
fn a_vehicle_that_stands_because_of_a_stop_stood_there() {
    let causes = |net: &Net, stops: &[u32]| {
        let lane = if net.lane("bend_0").is_some() { "bend_0" } else { "road_0" };
        let drives = [drive(&[lane], 20.0, |_| 13.0), drive(&[lane], 60.0, |_| 0.0)];
        let found = conflicts_with(net, &drives, &[], stops, 1.5);
        found.iter().map(|conflict| conflict.causes.to_string()).collect::<Vec<_>>()
    };
    assert_eq!([causes(&road(), &[1]), causes(&road(), &[])], [["stood"], [""]]);
    assert_eq!([causes(&bend(18.0), &[1]), causes(&bend(18.0), &[])], [["stood"], ["behind_curve"]]);
    assert_eq!(causes(&road(), &[0]), [""], "a stop of the moving one");
}

#[test]
fn one_faster_than_its_lane_allows_is_too_fast() {
    for (speed, cause) in [((|_| 33.5) as fn(f64) -> f64, ""), (|_| 34.5, "too_fast")] {
        let found = logged(&road(), &[drive(&["road_0"], 100.0, speed), drive(&["road_0"], 180.0, |_| 10.0)], &[], 2.0);
        assert_eq!(found, [["rear_end", "following", cause]]);
    }
}
