//! When two road users collide, graze, or only stand beside each other.

use closecall::{Detector, Encounter, Frame, Options, Profile, Roster, Severity, State, SumoType, UserIndex};

/// Two cars of 5 m by 2 m, over steps of 1 s.
struct TwoCars {
    detector: Detector,
    roster: Roster,
    frame: Frame,
    users: [UserIndex; 2],
}

const NORTH: f64 = std::f64::consts::FRAC_PI_2;

impl TwoCars {
    fn new(options: &Options) -> Self {
        let mut roster = Roster::default();
        let sumo = SumoType { width: 2.0, ..SumoType::car("car") };
        let profile = roster.profile(Profile::vehicle(&sumo, options)).unwrap();
        let users = [roster.enter("a", profile), roster.enter("b", profile)];
        Self { detector: Detector::new(options, None), roster, frame: Frame::default(), users }
    }

    /// The encounter in a step with the two at (x, y, heading, speed) of their front bumpers.
    fn step(&mut self, cars: [(f64, f64, f64, f64); 2]) -> Option<Encounter> {
        self.frame.begin(self.frame.time + 1.0);
        for (user, (x, y, heading, speed)) in self.users.iter().zip(cars) {
            self.frame.push(*user, State { x, y, z: 0.0, heading, speed });
        }
        self.detector.step(&self.frame, &self.roster).next().copied()
    }
}

fn encounter(cars: [(f64, f64, f64, f64); 2]) -> Option<Encounter> {
    TwoCars::new(&Options::default()).step(cars)
}

#[test]
fn a_crash_that_ends_at_rest_is_a_collision() {
    let mut cars = TwoCars::new(&Options::default());
    assert!(!cars.step([(0.0, 0.0, 0.0, 12.5), (10.0, 0.0, 0.0, 0.0)]).unwrap().collision);
    let crashed = cars.step([(6.0, 0.0, 0.0, 0.0), (10.0, 0.0, 0.0, 0.0)]).unwrap();
    assert!(crashed.collision && crashed.in_conflict());
    assert!((crashed.overlap - 1.0).abs() < 1e-12, "{}", crashed.overlap);
    assert_eq!(cars.step([(6.0, 0.0, 0.0, 0.0), (10.0, 0.0, 0.0, 0.0)]), None, "it is over in the step after");
}

#[test]
fn without_a_reserve_a_crash_at_rest_is_a_conflict() {
    let mut cars = TwoCars::new(&Options { epsilon: 0.0, ..Options::default() });
    cars.step([(0.0, 0.0, 0.0, 12.5), (10.0, 0.0, 0.0, 0.0)]);
    assert!(cars.step([(6.0, 0.0, 0.0, 0.0), (10.0, 0.0, 0.0, 0.0)]).unwrap().in_conflict());
}

#[test]
fn two_that_stand_on_each_other_from_the_beginning_are_no_pair() {
    let mut cars = TwoCars::new(&Options::default());
    let parked = [(0.0, 0.0, 0.0, 0.0), (1.0, 0.3, 0.0, 0.0)];
    assert_eq!([cars.step(parked), cars.step(parked)], [None; 2]);
}

#[test]
fn one_that_stands_beside_the_path_is_in_no_conflict() {
    // It faces the road, its front 0.2 m beside what the other covers.
    for speed in [0.5, 8.0, 30.0] {
        assert_eq!(encounter([(0.0, 0.0, 0.0, speed), (10.0, -1.2, NORTH, 0.0)]), None);
    }
    let in_the_way = encounter([(0.0, 0.0, 0.0, 8.0), (10.0, -0.8, NORTH, 0.0)]).unwrap();
    assert_eq!(in_the_way.ego, UserIndex(0));
}

#[test]
fn one_that_moves_off_beside_the_path_is_in_conflict() {
    assert!(encounter([(0.0, 0.0, 0.0, 8.0), (8.0, -1.2, NORTH, 0.5)]).is_some());
}

#[test]
fn queues_that_graze_side_by_side_are_in_no_conflict() {
    for speed in [0.0, 2.0, 10.0] {
        assert_eq!(encounter([(0.0, 0.0, 0.0, speed), (3.0, 1.93, 0.0, 2.0)]), None, "{speed} m/s");
    }
}

#[test]
fn a_graze_is_no_collision_and_a_deeper_overlap_is() {
    let bumpers = |overlap: f64| encounter([(0.0, 0.0, 0.0, 3.0), (5.0 - overlap, 0.0, 0.0, 1.0)]).unwrap();
    for (overlap, collides) in [(0.1, false), (0.24, false), (0.26, true)] {
        let found = bumpers(overlap);
        assert_eq!(found.collision, collides, "{overlap} m");
        assert!((found.overlap - overlap).abs() < 1e-12 && found.in_conflict());
        assert_eq!(found.nearness.unwrap().clearance, 0.0);
    }
}

#[test]
fn without_a_tolerance_touching_is_a_collision() {
    let mut cars = TwoCars::new(&Options { contact_tolerance: 0.0, ..Options::default() });
    assert!(cars.step([(0.0, 0.0, 0.0, 3.0), (5.0, 0.0, 0.0, 1.0)]).unwrap().collision);
}

#[test]
fn oncoming_vehicles_that_graze_have_no_conflict_ahead() {
    assert_eq!(encounter([(0.0, 0.0, 0.0, 5.0), (-4.0, 1.9, std::f64::consts::PI, 5.0)]), None);
}

#[test]
fn oncoming_vehicles_that_will_only_graze_have_no_ttc() {
    for (aside, touches) in [(1.9, false), (1.76, false), (1.74, true), (1.0, true)] {
        for foe_speed in [0.0, 5.0] {
            let oncoming = encounter([(0.0, 0.0, 0.0, 10.0), (5.0, aside, std::f64::consts::PI, foe_speed)]);
            let nearness = oncoming.unwrap().nearness.unwrap();
            assert_eq!(nearness.values.ttc().is_some(), touches, "{aside} m aside");
            assert_eq!(nearness.values.drac().is_some(), touches, "{aside} m aside");
            assert_eq!(nearness.assessment.severity, if touches { Severity::Critical } else { Severity::Caution });
        }
    }
}

#[test]
fn one_whose_corner_will_only_graze_has_no_ttc() {
    // The ego passes behind a foe that crosses: that leaves just before, or just after.
    let crossing = |behind: f64| encounter([(0.0, 0.0, 0.0, 10.0), (10.0, 6.0 + behind, NORTH, 10.0)]);
    let ttc = |behind: f64| crossing(behind).and_then(|found| found.nearness?.values.ttc());
    assert_eq!([ttc(-9.4), ttc(-9.6)].map(|ttc| ttc.is_some()), [false, true]);
}

#[test]
fn without_a_tolerance_a_graze_ahead_has_a_ttc() {
    let mut cars = TwoCars::new(&Options { contact_tolerance: 0.0, ..Options::default() });
    let oncoming = cars.step([(0.0, 0.0, 0.0, 10.0), (12.0, 1.9, std::f64::consts::PI, 0.0)]).unwrap();
    assert!((oncoming.nearness.unwrap().values.ttc().unwrap() - 1.2).abs() < 1e-9);
}

#[test]
fn a_follower_that_touches_at_the_horizon_has_a_ttc() {
    for (gap, touches) in [(0.999, true), (1.001, false)] {
        let follower = encounter([(0.0, 0.0, 0.0, 5.0), (5.0 + gap, 0.0, 0.0, 4.9)]).unwrap();
        assert_eq!(follower.nearness.unwrap().values.ttc().is_some(), touches, "{gap} m");
    }
}
