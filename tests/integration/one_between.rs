//! A follower is in conflict with the vehicle before it, not with those beyond.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use closecall::{Net, Options, PathModel, Placement, Profile, Shortcut, State, SumoType};
use closecall_run::Run;

use crate::street::street;

/// A vehicle: its id, where its front bumper is, its heading, its speed and its width.
type Car = (&'static str, [f64; 2], f64, f64, f64);

const CAR: f64 = 2.0;
const NARROW: f64 = 0.6;

fn car(id: &'static str, x: f64, y: f64, speed: f64) -> Car {
    (id, [x, y], 0.0, speed, CAR)
}

/// The pairs in conflict in a step of these vehicles, which are 5 m long, as ego and foe; each is on the lane of that
/// name, if there is a net.
fn pairs_on(options: &Options, net: Option<Arc<Net>>, cars: &[Car], lane: &str) -> Vec<(String, String)> {
    let mut run = Run::new(&options.clone().into(), net.clone()).unwrap();
    run.begin_step(0.0);
    for &(id, [x, y], heading, speed, width) in cars {
        let sumo = SumoType { width, ..SumoType::car(if width == CAR { "car" } else { "narrow" }) };
        let profile = run.roster.profile(Profile::vehicle(&sumo, options)).unwrap();
        let user = run.enter(id, profile);
        run.frame.push(user, State { x, y, z: 0.0, heading, speed });
    }
    run.step(|run, rows| {
        let Some(net) = &net else { return Ok::<(), closecall_run::Error>(()) };
        for &row in rows {
            let position = run.frame.state(row).x;
            let lane = net.lane(lane).unwrap();
            run.set_placement(row, &Placement { lane, position, route: None, route_position: 0, lateral_speed: 0.0 });
        }
        Ok(())
    })
    .unwrap();
    run.finish().unwrap();
    let mut pairs =
        run.conflicts().iter().map(|found| (found.ego.to_string(), found.foe.to_string())).collect::<Vec<_>>();
    pairs.sort();
    pairs
}

fn pairs(cars: &[Car]) -> Vec<(String, String)> {
    pairs_on(&Options::default(), None, cars, "")
}

fn of(pairs: &[[&str; 2]]) -> Vec<(String, String)> {
    pairs.iter().map(|[ego, foe]| ((*ego).to_owned(), (*foe).to_owned())).collect()
}

/// The last car of three in a lane, before a vehicle that stands.
const LAST: Car = ("last", [0.0, -1.6], 0.0, 25.0, CAR);

#[test]
fn a_platoon_has_conflicts_of_neighbours_only() {
    let platoon = [LAST, car("third", 9.0, -1.6, 25.0), car("second", 18.0, -1.6, 25.0), car("first", 27.0, -1.6, 0.0)];
    let neighbours = of(&[["last", "third"], ["second", "first"], ["third", "second"]]);
    let arcs = Options { path: PathModel::Arc, ..Options::default() };
    let wide = Options { log: "ttc < 10 or margin < 0 or gap < 100".parse().unwrap(), ..Options::default() };
    for options in
        [Options::default(), arcs, wide, Options { no_shortcuts: Shortcut::ALL.to_vec(), ..Options::default() }]
    {
        let found = [pairs_on(&options, None, &platoon, ""), pairs_on(&options, Some(street()), &platoon, "east_0")];
        for found in found {
            assert!(found.iter().all(|pair| neighbours.contains(pair)), "{found:?}");
            assert!(found.contains(&neighbours[1]), "{found:?}");
        }
    }
}

#[test]
fn what_a_follower_has_with_the_first_it_has_once_the_middle_is_gone() {
    let (middle, first) = (car("middle", 30.0, -1.6, 14.0), car("first", 48.0, -1.6, 14.0));
    assert_eq!(pairs(&[LAST, middle, first]), of(&[["last", "middle"], ["middle", "first"]]));
    assert_eq!(pairs(&[LAST, first]), of(&[["last", "first"]]));
}

#[test]
fn one_beside_or_across_is_not_between() {
    let first = car("first", 24.0, -1.6, 0.0);
    let has_first = |other: Car| pairs(&[LAST, other, first]).contains(&of(&[["last", "first"]])[0]);
    assert!(!has_first(car("middle", 12.0, -1.6, 2.0)));
    assert!(has_first(car("beside", 12.0, 0.5, 2.0)), "on the next lane");
    assert!(has_first(("across", [12.0, -1.0], FRAC_PI_2, 2.0, CAR)), "it crosses");
    assert!(has_first(("oncoming", [12.0, -1.6], PI, 2.0, CAR)), "it comes towards both");
    assert!(has_first(car("beyond", 34.0, -1.6, 2.0)), "it is ahead of both");
    assert!(has_first(car("behind", -12.0, -1.6, 2.0)), "it is behind both");
}

#[test]
fn one_that_leaves_the_lane_is_not_between() {
    let first = car("first", 34.0, -1.6, 0.0);
    let has_first = |heading: f64| {
        let leaves = ("leaves", [12.0, -1.6], heading, 10.0, CAR);
        pairs(&[LAST, leaves, first]).contains(&of(&[["last", "first"]])[0])
    };
    assert!(!has_first(0.0) && has_first(0.35), "20° to the left");
}

#[test]
fn two_that_touch_are_a_pair_whatever_is_between() {
    // Both have pushed into a narrow one.
    let crash = [car("last", 0.0, 0.0, 10.0), ("narrow", [2.0, 0.0], 0.0, 10.0, NARROW), car("first", 4.5, 0.0, 5.0)];
    assert!(pairs(&crash).contains(&of(&[["last", "first"]])[0]));
}

#[test]
fn a_narrow_one_is_between_only_where_it_is_in_the_way() {
    let first = car("first", 24.0, 0.0, 0.0);
    let has_first = |y: f64| {
        let pairs = pairs(&[car("last", 0.0, 0.0, 20.0), ("narrow", [12.0, y], 0.0, 5.0, NARROW), first]);
        pairs.contains(&of(&[["last", "first"]])[0])
    };
    assert_eq!([0.0, 1.0, 1.27, 2.0].map(has_first), [false, false, true, true]);
}
