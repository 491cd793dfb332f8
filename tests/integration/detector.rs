//! Scenes with two vehicles, straight on and without a net, compared with the definitions in docs/model.md.

use closecall::detection::encounter::Nearness;
use closecall::detection::measures::table::LoggedMeasure;
use closecall::{
    BrakeSystem, Detector, Encounter, Frame, Kind, Mode, Options, PathModel, Profile, Roster, Shortcut, State,
    SumoType, TypeOptions, UserIndex,
};
use proptest::prelude::*;

/// A car of 5 m by 2 m that brakes with 8 m/s² after 1 s, without build-up.
fn car(options: &Options) -> Profile {
    Profile::vehicle(&sumo_car(), options)
}

fn sumo_car() -> SumoType {
    SumoType { width: 2.0, emergency_decel: 8.0, ..SumoType::car("car") }
}

fn options() -> Options {
    let mut options = Options::default();
    let settings = TypeOptions {
        response_time: Some(0.75),
        build_up: Some(0.0),
        brakes: Some(BrakeSystem::Hydraulic),
        ..TypeOptions::default()
    };
    options.types.insert("car".to_owned(), settings);
    options
}

/// Encounters of cars given as (x, y, heading, speed) of their front bumpers, named a, b, c, …, with the ego's name.
fn encounters(cars: &[(f64, f64, f64, f64)]) -> Vec<(Encounter, String)> {
    encounters_by(cars, |_| {})
}

/// [`encounters`] by a detector with settings of its own.
fn encounters_by(cars: &[(f64, f64, f64, f64)], set_up: impl Fn(&mut Detector)) -> Vec<(Encounter, String)> {
    let mut detector = Detector::new(&options(), None);
    set_up(&mut detector);
    look(&mut detector, cars)
}

/// The encounters that a detector finds in a step.
fn look(detector: &mut Detector, cars: &[(f64, f64, f64, f64)]) -> Vec<(Encounter, String)> {
    look_at(detector, &options(), cars)
}

/// [`look`] with cars whose brakes follow these options.
fn look_at(detector: &mut Detector, options: &Options, cars: &[(f64, f64, f64, f64)]) -> Vec<(Encounter, String)> {
    let mut roster = Roster::default();
    let profile = roster.profile(car(options)).unwrap();
    let mut frame = Frame::default();
    frame.begin(0.0);
    for (index, &(x, y, heading, speed)) in cars.iter().enumerate() {
        let user = roster.enter(&char::from(b'a' + index as u8).to_string(), profile);
        frame.push(user, State { x, y, z: 0.0, heading, speed });
    }
    detector.track_paths(&frame, &roster);
    detector.broad_phase(&frame, &roster);
    let found = detector.narrow_phase(&frame, &roster).copied().collect::<Vec<_>>();
    let found = found.into_iter().map(|found| detector.with_probabilities(&roster, &found));
    found.map(|found| (found, roster.id(found.ego).to_string())).collect()
}

const WEST: f64 = std::f64::consts::PI;
const NORTH: f64 = std::f64::consts::FRAC_PI_2;

#[test]
fn a_followers_gap_is_the_room_between_the_bumpers() {
    let [(found, ego)] = &encounters(&[(30.0, 0.0, 0.0, 10.0), (0.0, 0.0, 0.0, 20.0)])[..] else { panic!() };
    assert_eq!((found.kind, ego.as_str()), (Kind::RearEnd, "b"));
    assert!((found.gap - 25.0).abs() < 1e-9);
    // 20 m of response; then both brake alike, 400/16 − 100/16.
    assert!((found.mu - (20.0 + 25.0 - 6.25 + 0.5)).abs() < 0.05, "{}", found.mu);
    assert!(found.in_conflict());
    assert!((found.nearness.unwrap().values.ttc().unwrap() - 2.5).abs() < 1e-9);
}

#[test]
fn oncoming_vehicles_need_the_sum_of_their_stopping_distances() {
    let [(found, _)] = &encounters(&[(0.0, 0.0, 0.0, 20.0), (60.0, 0.5, WEST, 10.0)])[..] else { panic!() };
    assert_eq!(found.kind, Kind::Frontal);
    assert!((found.gap - 60.0).abs() < 1e-9);
    assert!((found.mu - (45.0 + 16.25 + 0.5)).abs() < 0.05, "{}", found.mu);
}

#[test]
fn ordinary_oncoming_traffic_is_not_an_encounter() {
    assert!(encounters(&[(0.0, 0.0, 0.0, 20.0), (60.0, 3.2, WEST, 20.0)]).is_empty());
}

#[test]
fn a_crossing_foe_is_met_at_its_paths_edge() {
    let [(found, ego)] = &encounters(&[(0.0, 0.0, 0.0, 15.0), (20.0, -11.0, NORTH, 10.0)])[..] else { panic!() };
    assert_eq!((found.kind, ego.as_str()), (Kind::Side, "a"));
    assert!((found.ego_distance - 19.0).abs() < 0.02, "{}", found.ego_distance);
    assert!((found.gap - 19.0).abs() < 0.02, "{}", found.gap);
}

#[test]
fn a_vehicle_stopping_before_the_crossing_is_not_a_foe() {
    assert!(encounters(&[(0.0, 0.0, 0.0, 15.0), (20.0, -25.0, NORTH, 10.0)]).is_empty());
}

#[test]
fn overlapping_rectangles_are_a_collision_without_a_gap() {
    let [(found, _)] = &encounters(&[(0.0, 0.0, 0.0, 15.0), (-2.0, 1.0, NORTH, 10.0)])[..] else { panic!() };
    assert!(found.collision);
    assert_eq!(found.gap, 0.0);
}

#[test]
fn two_standing_vehicles_are_not_a_pair() {
    assert!(encounters(&[(0.0, 0.0, 0.0, 0.0), (5.1, 0.0, 0.0, 0.0)]).is_empty());
}

#[test]
fn in_a_merge_the_foe_has_to_pass_first() {
    let [(found, ego)] = &encounters(&[(0.0, 0.0, 0.0, 20.0), (20.0, -4.0, 0.3, 15.0)])[..] else { panic!() };
    assert_eq!((found.kind, ego.as_str()), (Kind::RearEnd, "a"));
    assert!(found.foe_distance > 5.0 && found.foe_distance < 15.0, "{}", found.foe_distance);
}

/// Number of encounters and the conflicts: without and with the restriction to conflicts.
fn all_and_only(cars: &[(f64, f64, f64, f64)]) -> [(usize, Vec<(Encounter, String)>); 2] {
    [false, true].map(|only| {
        let found = encounters_by(cars, |detector| detector.set_conflicts_only(only));
        (found.len(), found.into_iter().filter(|(found, _)| found.in_conflict()).collect())
    })
}

#[test]
fn the_restriction_to_conflicts_keeps_all_of_them() {
    let cars = [(0.0, 0.0, 0.0, 20.0), (40.0, 0.0, 0.0, 20.0), (0.0, 99.0, 0.0, 20.0), (12.0, 99.0, 0.0, 15.0)];
    let [(all, of_all), (only, of_only)] = all_and_only(&cars);
    assert!(0 < only && only < all, "{only} {all}");
    assert_eq!(of_only, of_all);
}

#[test]
fn the_restriction_to_conflicts_drops_foes_that_leave_in_time() {
    let [(all, of_all), (only, of_only)] = all_and_only(&[(0.0, 0.0, 0.0, 20.0), (44.5, -1.0, 0.1, 20.0)]);
    assert_eq!((all, only, of_all, of_only), (1, 0, vec![], vec![]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5000))]

    #[test]
    fn the_restriction_to_conflicts_keeps_every_merging_conflict(
        x in -60.0..60.0, y in -12.0..12.0, turn in -0.5..0.5, speed in 2.0..35.0, foe_speed in 2.0..35.0,
    ) {
        let [(_, of_all), (_, of_only)] = all_and_only(&[(0.0, 0.0, 0.0, speed), (x, y, turn, foe_speed)]);
        prop_assert_eq!(of_only, of_all);
    }
}

/// Cars near each other, some of them standing; with a few fixed headings and arbitrary ones.
fn some_cars() -> impl Strategy<Value = Vec<(f64, f64, f64, f64)>> {
    let heading = prop_oneof![-4.0..4.0, prop_oneof![Just(0.0), Just(1.0), Just(NORTH)]];
    prop::collection::vec((-40.0..40.0, -40.0..40.0, heading, prop_oneof![Just(0.0), 0.0..35.0]), 2..7)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// With these shortcuts off, straight paths are built and stored like those that turn.
    #[test]
    fn straight_traffic_meets_the_same_whatever_is_left_out(cars in some_cars()) {
        let [left_out, kept] = [vec![], vec![Shortcut::AreasApart, Shortcut::PathsApart]].map(|disabled| {
            let options = Options { no_shortcuts: disabled, ..options() };
            look_at(&mut Detector::new(&options, None), &options, &cars)
        });
        prop_assert_eq!(left_out, kept);
    }

    #[test]
    fn one_step_changes_nothing_in_the_next(before in some_cars(), cars in some_cars()) {
        let mut warm = Detector::new(&options(), None);
        look(&mut warm, &before);
        let mut found = look(&mut warm, &cars);
        // Two that stand are a pair only in the step in which one of them stops.
        found.retain(|(found, _)| [found.ego_row, found.foe_row].iter().any(|row| cars[*row as usize].3 > 0.0));
        prop_assert_eq!(found, encounters(&cars));
    }
}

proptest! {
    #[test]
    fn in_paper_mode_leaving_out_changes_nothing(
        cars in prop::collection::vec((-40.0..40.0, -40.0..40.0, -4.0..4.0, 0.0..35.0), 2..6), build_up in 0.0..3.0,
    ) {
        let mut options = Options { mode: Mode::Paper, ..options() };
        options.types.values_mut().for_each(|settings| settings.build_up = Some(build_up));
        let [left_out, kept] = [&[][..], Shortcut::ALL].map(|disabled| {
            let options = Options { no_shortcuts: disabled.to_vec(), ..options.clone() };
            look_at(&mut Detector::new(&options, None), &options, &cars)
        });
        prop_assert_eq!(left_out, kept);
    }
}

#[test]
fn a_kind_without_pairs_is_reported_as_left_out() {
    let left_out = |options: &Options, foe| {
        let mut detector = Detector::new(options, None);
        look(&mut detector, &[(0.0, 0.0, 0.0, 20.0), foe]);
        let altogether = detector.left_out().into_iter().filter(|entry| entry.times.is_none());
        altogether.map(|entry| entry.to_string()).collect::<Vec<_>>()
    };
    let frontal = "frontal tests skipped altogether (no opposing paths within reach)";
    let side = "side tests skipped altogether (no crossing or bending paths within reach)";
    let (ahead, towards_it, across) = ((30.0, 0.0, 0.0, 10.0), (60.0, 0.0, WEST, 10.0), (40.0, -20.0, NORTH, 15.0));
    assert_eq!(left_out(&options(), ahead), [frontal, side]);
    assert_eq!(left_out(&options(), towards_it), [side]);
    assert_eq!(left_out(&options(), across), [frontal]);
    for needs_all in
        [Options { no_shortcuts: Shortcut::ALL.to_vec(), ..options() }, Options { mode: Mode::Paper, ..options() }]
    {
        assert!(left_out(&needs_all, ahead).is_empty());
    }
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let (options, mut roster, mut frame) = (options(), Roster::default(), Frame::default());
    let profile = roster.profile(car(&options)).unwrap();
    let users = (0..21_000).map(|number| roster.enter(&number.to_string(), profile)).collect::<Vec<_>>();
    let mut detectors = [1, 2, 3, 8].map(|threads| {
        let mut detector = Detector::new(&options, None);
        detector.set_threads(threads);
        detector
    });
    for step in 0..3 {
        frame.begin(f64::from(step));
        // Prime numbers, so that all directions differ and the rows are not sorted by place.
        for (number, user) in (0_u32..).zip(&users) {
            let of = |prime: u32| f64::from(number * prime % 20_983) / 20_983.0;
            let distance = f64::from(step) * 10.0;
            let (x, y) = (of(1709) * 3000.0 + distance * of(7), of(2903) * 3000.0);
            frame.push(*user, State { x, y, z: 0.0, heading: of(3571) * 6.2, speed: of(4273) * 15.0 });
        }
        let [alone, others @ ..] = &mut detectors;
        alone.track_paths(&frame, &roster);
        alone.broad_phase(&frame, &roster);
        let found = alone.narrow_phase(&frame, &roster).copied().collect::<Vec<_>>();
        assert!(found.iter().filter(|found| found.in_conflict()).count() > 500, "{}", found.len());
        for detector in others {
            detector.track_paths(&frame, &roster);
            detector.broad_phase(&frame, &roster);
            assert!(detector.narrow_phase(&frame, &roster).eq(&found));
            assert_eq!(detector.work(), alone.work());
        }
    }
}

#[test]
fn a_pair_that_is_met_further_ahead_counts_once() {
    let options = Options { log: "ttc < 3 or margin < 0".parse().unwrap(), path: PathModel::Arc, ..options() };
    let (mut detector, mut roster, mut frame) = (Detector::new(&options, None), Roster::default(), Frame::default());
    let profile = roster.profile(car(&options)).unwrap();
    frame.begin(0.0);
    for (number, x) in [0.0, 30.0, 60.0, 90.0].into_iter().enumerate() {
        let state = State { x, y: 4.0 * number as f64, z: 0.0, heading: 0.0, speed: 20.0 };
        frame.push(roster.enter(&number.to_string(), profile), state);
    }
    detector.step(&frame, &roster).count();
    let work = detector.work();
    assert!(work.in_line + work.paths_apart > 0);
    assert!(work.in_line + work.paths_apart <= work.pairs, "{work:?}");
}

/// Encounters among some of the cars, given as (x, y, heading, speed), after one step of turning; by their numbers.
fn encounters_of(cars: &[(f64, f64, f64, f64)], numbers: &[usize], roster: &Roster) -> Vec<Encounter> {
    let mut detector = Detector::new(&Options { path: PathModel::Arc, ..options() }, None);
    turned_by(0.05, &mut detector, cars, numbers, roster)
}

/// [`encounters_of`] by this detector, after a turn by this angle.
fn turned_by(
    turn: f64,
    detector: &mut Detector,
    cars: &[(f64, f64, f64, f64)],
    numbers: &[usize],
    roster: &Roster,
) -> Vec<Encounter> {
    let mut frame = Frame::default();
    for time in [0.0, 0.1] {
        frame.begin(time);
        for &number in numbers {
            let (x, y, heading, speed) = cars[number];
            let (x, y) = (x + speed * time * heading.cos(), y + speed * time * heading.sin());
            frame.push(UserIndex(number as u32), State { x, y, z: 0.0, heading: heading + turn * time / 0.1, speed });
        }
        detector.track_paths(&frame, roster);
        detector.broad_phase(&frame, roster);
    }
    let by_number = |found: &Encounter| Encounter { ego_row: found.ego.0, foe_row: found.foe.0, ..*found };
    _ = detector.narrow_phase(&frame, roster);
    detector.encounters().map(|found| by_number(&detector.with_probabilities(roster, found))).collect()
}

/// With many vehicles the detector forgets paths, and builds them again.
#[test]
fn vehicles_meet_the_same_foes_among_many_as_alone() {
    let mut roster = Roster::default();
    let profile = roster.profile(car(&options())).unwrap();
    let all = (0..200).collect::<Vec<_>>();
    for number in &all {
        roster.enter(&number.to_string(), profile);
    }
    // Prime numbers, as above.
    let of = |number: usize, prime: usize| (number * prime % 8999) as f64 / 8999.0;
    let car = |n: &usize| (of(*n, 1709) * 100.0, of(*n, 2903) * 100.0, of(*n, 3571) * 6.2, of(*n, 4273) * 14.0);
    let cars = all.iter().map(car).collect::<Vec<_>>();
    let together = encounters_of(&cars, &all, &roster);
    let pairs = all.iter().flat_map(|a| (a + 1..cars.len()).map(|b| [*a, b]));
    let alone = pairs.flat_map(|pair| encounters_of(&cars, &pair, &roster)).collect::<Vec<_>>();
    assert!(alone.len() > 300, "{}", alone.len());
    assert_eq!(together, alone);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// On a small circle the tail of a long vehicle reaches further than its front.
    #[test]
    fn on_arcs_leaving_out_keeps_pairs_that_a_tail_meets(
        (x, y) in (-60.0..60.0, -60.0..60.0), heading in -3.2..3.2, speed in 0.5..15.0, foe_speed in 0.0..15.0,
        length in 2.0..25.0, turn in -0.5..0.5, articulated: bool,
    ) {
        let mut sumo = SumoType { length, ..sumo_car() };
        if articulated {
            sumo.shape = "truck/semitrailer".to_owned();
        }
        let mut roster = Roster::default();
        let profile = roster.profile(Profile::vehicle(&sumo, &options())).unwrap();
        ["a", "b"].iter().for_each(|id| _ = roster.enter(id, profile));
        let cars = [(0.0, 0.0, 0.0, speed), (x, y, heading, foe_speed)];
        let [left_out, kept] = [&[][..], Shortcut::ALL].map(|disabled| {
            let options = Options { path: PathModel::Arc, no_shortcuts: disabled.to_vec(), ..options() };
            turned_by(turn, &mut Detector::new(&options, None), &cars, &[0, 1], &roster)
        });
        prop_assert_eq!(left_out, kept);
    }
}

/// [`options`] with this condition.
fn logging(condition: &str) -> Options {
    Options { log: condition.parse().unwrap(), ..options() }
}

#[test]
fn a_foe_that_slows_down_far_ahead_is_found_by_its_ttc() {
    // The ego stands after 22 + 30.25 m. The foe's rear is 70 m ahead and comes nearer by 20 m/s.
    let cars = [(0.0, 0.0, 0.0, 22.0), (75.0, 0.0, 0.0, 2.0)];
    assert!(encounters(&cars).is_empty());
    let options = logging("ttc < 4");
    let [(found, ego)] = &look_at(&mut Detector::new(&options, None), &options, &cars)[..] else { panic!() };
    assert_eq!((found.kind, ego.as_str()), (Kind::RearEnd, "a"));
    assert!((found.nearness.unwrap().values.ttc().unwrap() - 3.5).abs() < 1e-9 && found.is_logged());
    assert!((found.gap - 70.0).abs() < 1e-9 && found.margin > 0.0);
}

#[test]
fn a_pair_that_would_stand_before_it_meets_is_in_no_conflict() {
    // The foe stands after 16.25 m, 7.75 m before the ego's path. The ego needs 29.6 m and has 29.
    let cars = [(-10.0, 0.0, 0.0, 15.0), (20.0, -25.0, NORTH, 10.0)];
    let options = logging("pet < 5 or gap < 40");
    let [(found, _)] = &look_at(&mut Detector::new(&options, None), &options, &cars)[..] else { panic!() };
    assert!((found.margin - 7.75).abs() < 0.1 && !found.in_conflict(), "{found:?}");
    assert!((found.gap - found.mu - found.margin).abs() < 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn looking_further_changes_no_pair_that_meets_before_both_stand(cars in some_cars()) {
        let wide = logging("ttc < 8 or gap < 9 or pet < 4");
        let known = |(found, ego): (Encounter, String)| {
            (Encounter { nearness: None, pet_below: 0.0, ..found }, ego)
        };
        let near = encounters(&cars).into_iter().map(known).collect::<Vec<_>>();
        let far = look_at(&mut Detector::new(&wide, None), &wide, &cars).into_iter().map(known).collect::<Vec<_>>();
        prop_assert!(near.iter().all(|found| far.contains(found)));
        let is_new = |found: &&(Encounter, String)| !near.contains(found);
        prop_assert!(far.iter().filter(is_new).all(|(found, _)| !found.in_conflict()));
    }

    #[test]
    fn looking_further_leaves_nothing_out(cars in some_cars(), arcs: bool) {
        let [left_out, kept] = [&[][..], Shortcut::ALL].map(|disabled| {
            let path = if arcs { PathModel::Arc } else { PathModel::Straight };
            let options = Options { no_shortcuts: disabled.to_vec(), path, ..logging("ttc < 4 or drac > 2 or pet < 2") };
            look_at(&mut Detector::new(&options, None), &options, &cars)
        });
        prop_assert_eq!(left_out, kept);
    }

    #[test]
    fn no_contact_within_the_ttc_is_missed(cars in some_cars()) {
        let (near, all) = (logging("ttc < 3"), logging("ttc < 10"));
        let [near, all] = [near, all].map(|options| {
            let found = look_at(&mut Detector::new(&options, None), &options, &cars);
            let is_near = |found: &Encounter| found.nearness.is_some_and(|near| near.values.ttc().is_some_and(|ttc| ttc < 3.0));
            let found = found.into_iter().map(|(found, _)| found).filter(is_near);
            found.map(|found| [found.ego.min(found.foe), found.ego.max(found.foe)]).collect::<Vec<_>>()
        });
        prop_assert_eq!(near, all);
    }
}

#[test]
fn crash_probabilities_of_an_earlier_step_are_none() {
    let mut roster = Roster::default();
    let profile = roster.profile(car(&options())).unwrap();
    let users = [roster.enter("a", profile), roster.enter("b", profile)];
    let mut detector = Detector::new(&options(), None);
    let probability = |detector: &Detector, near: &Nearness| {
        detector.crash_probability(&roster, near, LoggedMeasure::CrashProbabilityBraking)
    };
    let mut last = None;
    // In the third step nobody is there.
    for (time, cars) in [(0.0, 2), (0.1, 2), (0.2, 0)] {
        let mut frame = Frame::default();
        frame.begin(time);
        for (user, x, speed) in [(users[0], 30.0, 10.0), (users[1], 0.0, 20.0)].into_iter().take(cars) {
            frame.push(user, State { x, y: 0.0, z: 0.0, heading: 0.0, speed });
        }
        let near = detector.step(&frame, &roster).next().and_then(|found| found.nearness);
        assert!(near.is_none_or(|near| probability(&detector, &near).is_some()));
        let worked_out = last.and_then(|last: Nearness| last.values.crash_probability_braking());
        assert_eq!(last.and_then(|last| probability(&detector, &last)), worked_out);
        last = near;
    }
    assert!(last.is_none());
}
