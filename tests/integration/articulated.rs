//! A tram of several carriages on a bend.

use std::path::Path;
use std::sync::Arc;

use closecall::geometry::Vector;
use closecall::geometry::contact::touches;
use closecall::geometry::rectangle::Rectangle;
use closecall::{
    Detector, Encounter, Frame, Kind, Options, Placement, Point, Profile, Roster, Shortcut, State, SumoType,
};
use proptest::prelude::*;

use super::road::Road;

fn articulated(shape: &str, class: &str, length: f64) -> Profile {
    let sumo = SumoType { length, shape: shape.to_owned(), ..SumoType::of_class("long", class) };
    Profile::vehicle(&sumo, &Options::default())
}

fn tram() -> Profile {
    articulated("rail/railcar", "tram", 45.0)
}

/// What a long vehicle and a car meet; each step is where the front bumper of the one is and how fast it is, and the car.
fn meet(road: &Road, profile: &Profile, steps: &[(f64, f64, State)], options: &Options) -> Vec<Encounter> {
    let mut roster = Roster::default();
    let types = [profile.clone(), Profile::vehicle(&SumoType::car("car"), options)];
    let types = types.map(|profile| roster.profile(profile).unwrap());
    let users = [roster.enter("a", types[0]), roster.enter("b", types[1])];
    let mut detector = Detector::new(options, Some(road.net.clone()));
    let mut frame = Frame::default();
    for (time, (distance, speed, car)) in steps.iter().enumerate() {
        frame.begin(time as f64);
        frame.push(users[0], road.vehicle(profile, *distance, *speed));
        frame.push(users[1], *car);
        for row in detector.track_paths(&frame, &roster).to_vec().into_iter().filter(|row| *row == 0) {
            let placement = Placement {
                lane: road.net.lane("e_0").unwrap(),
                position: *distance,
                route: Some([road.net.edge("e").unwrap()].into()),
                route_position: 0,
                lateral_speed: 0.0,
            };
            detector.set_placement(&frame, &roster, row, &placement);
        }
        detector.broad_phase(&frame, &roster);
        let _ = detector.narrow_phase(&frame, &roster);
    }
    detector.encounters().map(|found| detector.with_probabilities(&roster, found)).collect()
}

/// A car that stands along the bend, this far from the circle's centre.
fn stands(radius: f64, degrees: f64) -> State {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    State { x: 100.0 + radius * sine, y: 20.0 - radius * cosine, z: 0.0, heading: degrees.to_radians(), speed: 0.0 }
}

fn inside() -> State {
    stands(15.0, 55.0)
}

#[test]
fn a_tram_passes_what_stands_beside_it_on_a_bend() {
    let cars = [(16.5, 20.0), (15.0, 50.0), (16.5, 80.0), (23.0, 10.0), (23.0, 40.0), (23.0, 85.0)];
    let road = Road::bend();
    let times_met = |profile: &Profile| {
        let places = cars.iter().flat_map(|car| (60..180).step_by(3).map(move |front| (car, f64::from(front))));
        let met = places.filter(|((radius, degrees), front)| {
            !meet(&road, profile, &[(*front, 8.0, stands(*radius, *degrees))], &Options::default()).is_empty()
        });
        met.count()
    };
    assert_eq!(times_met(&tram()), 0);
    let stiff = Profile { carriages: 1, chord: 45.0, ..tram() };
    assert!(times_met(&stiff) > 50, "a stiff one would cut the bend");
}

#[test]
fn a_tram_runs_into_what_stands_in_its_way_on_a_bend() {
    let (road, tram) = (Road::bend(), tram());
    let stands = road.vehicle(&Profile::vehicle(&SumoType::car("car"), &Options::default()), 122.0, 0.0);
    let [found] = meet(&road, &tram, &[(108.0, 8.0, stands)], &Options::default())[..] else { panic!() };
    assert_eq!((found.kind, found.ego.0), (Kind::RearEnd, 0));
    assert!((found.gap - 9.0).abs() < 0.3, "{found:?}");
    let [found] = meet(&road, &tram, &[(150.0, 8.0, stands)], &Options::default())[..] else { panic!() };
    assert!(found.collision && found.overlap > 1.5, "{found:?}");
}

#[test]
fn a_conflict_with_the_tail_of_a_tram_is_where_its_tail_is() {
    let (road, tram) = (Road::bend(), tram());
    let behind = road.vehicle(&Profile::vehicle(&SumoType::car("car"), &Options::default()), 96.0, 12.0);
    let [found] = meet(&road, &tram, &[(147.0, 4.0, behind)], &Options::default())[..] else { panic!() };
    assert_eq!((found.kind, found.ego.0), (Kind::RearEnd, 1), "a car follows it round the bend");
    assert!((found.gap - 6.0).abs() < 0.3, "{found:?}");
    let across = State { x: 104.0, y: 1.0, z: 0.0, heading: -std::f64::consts::FRAC_PI_2, speed: 6.0 };
    let [found] = meet(&road, &tram, &[(140.0, 8.0, across)], &Options::default())[..] else { panic!() };
    assert!(found.collision && found.ego.0 == 1, "{found:?}");
    assert!((Point::new(found.x, found.y) - Point::new(104.0, 1.0)).norm() < 6.0, "{found:?}");
}

#[test]
fn a_tram_that_has_stopped_on_a_bend_still_bends() {
    let passes = State { speed: 2.0, ..inside() };
    let [before, stands] = [(147.5, 4.0, inside()), (148.0, 0.0, passes)];
    assert_eq!(meet(&Road::bend(), &tram(), &[before, stands, stands], &Options::default()), []);
    let across = State { x: 112.0, y: 10.0, z: 0.0, heading: -std::f64::consts::FRAC_PI_4, speed: 8.0 };
    let [found] = meet(&Road::bend(), &tram(), &[before, (148.0, 0.0, across)], &Options::default())[..] else {
        panic!()
    };
    assert_eq!((found.kind, found.ego.0), (Kind::Side, 1));
    assert!((found.gap - 3.0).abs() < 0.3, "{found:?}");
}

#[test]
fn on_a_straight_way_a_tram_is_one_rectangle() {
    let (road, tram) = (Road::through(vec![Point::origin(), Point::new(300.0, 0.0)]), tram());
    let rigid = Profile { carriages: 1, chord: tram.length, ..tram.clone() };
    for y in [0.0, 2.0, 9.0] {
        let car = State { x: 90.0, y, z: 0.0, heading: -0.4, speed: 9.0 };
        let [bends, stiff] =
            [&tram, &rigid].map(|profile| meet(&road, profile, &[(120.0, 9.0, car)], &Options::default()));
        assert_eq!(bends, stiff);
    }
}

/// Two roads that merge: from the west and from the south to the north-east.
const MERGE: &str = r#"<net>
    <edge id="a" from="w" to="m"><lane id="a_0" index="0" length="100" shape="0,100 100,100"/></edge>
    <edge id="b" from="s" to="m"><lane id="b_0" index="0" length="100" shape="100,0 100,100"/></edge>
    <edge id="c" from="m" to="n"><lane id="c_0" index="0" length="100" shape="100,100 180,160"/></edge>
    <connection from="a" to="c" fromLane="0" toLane="0" dir="s" state="M"/>
    <connection from="b" to="c" fromLane="0" toLane="0" dir="s" state="M"/>
</net>"#;

#[test]
fn a_trailer_is_still_on_the_road_that_it_came_from() {
    let net = Arc::new(closecall_run::net::parse(Path::new("merge.net.xml"), MERGE).unwrap());
    let [truck, car] = [articulated("truck/semitrailer", "truck", 16.5), articulated("passenger", "passenger", 5.0)];
    for (from, route) in [(Point::new(96.0, 100.0), ["a", "c"]), (Point::new(100.0, 96.0), ["b", "c"])] {
        let mut roster = Roster::default();
        let users = [("a", &truck), ("b", &car)].map(|(id, profile)| {
            let profile = roster.profile(profile.clone()).unwrap();
            roster.enter(id, profile)
        });
        let (mut detector, mut frame) = (Detector::new(&Options::default(), Some(net.clone())), Frame::default());
        frame.begin(0.0);
        frame.push(users[0], State { x: 104.0, y: 103.0, z: 0.0, heading: 0.6_f64.atan2(0.8), speed: 5.0 });
        // It stands on the western road.
        frame.push(users[1], State { x: 94.0, y: 100.0, z: 0.0, heading: 0.0, speed: 0.0 });
        detector.track_paths(&frame, &roster);
        let placement = Placement {
            lane: net.lane("c_0").unwrap(),
            position: 5.0,
            route: Some(route.iter().map(|edge| net.edge(edge).unwrap()).collect()),
            route_position: 1,
            lateral_speed: 0.0,
        };
        detector.set_placement(&frame, &roster, 0, &placement);
        detector.broad_phase(&frame, &roster);
        let collides = detector.narrow_phase(&frame, &roster).any(|found| found.collision);
        assert_eq!(collides, from.y == 100.0, "it came from {from}");
    }
}

fn shape() -> impl Strategy<Value = Profile> {
    prop_oneof![
        (25.0..60.0).prop_map(|length| articulated("rail/railcar", "tram", length)),
        (60.0..120.0).prop_map(|length| articulated("rail", "rail", length)),
        (16.0..19.0).prop_map(|length| articulated("bus/flexible", "bus", length)),
        (14.0..19.0).prop_map(|length| articulated("truck/semitrailer", "truck", length)),
        (14.0..19.0).prop_map(|length| articulated("truck/trailer", "trailer", length)),
    ]
}

/// Turns and the distances after them.
fn turns() -> impl Strategy<Value = Vec<(f64, f64)>> {
    prop::collection::vec((-0.5..0.5, 3.0..15.0), 40)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn leaving_out_keeps_every_pair_that_a_carriage_meets(
        turns in turns(), profile in shape(), moves in prop::collection::vec(0.0..9.0, 1..4),
        (x, y) in (-30.0..30.0, -30.0..30.0), behind in 0.0..60.0, heading in -3.2..3.2, speed in 0.0..15.0,
    ) {
        let (road, mut front) = (Road::turning(&turns), 125.0);
        let near = road.at(front - behind);
        let car = State { x: near.x + x, y: near.y + y, z: 0.0, heading, speed };
        let steps = moves.iter().map(|speed| { front += speed; (front, *speed, car) }).collect::<Vec<_>>();
        let steps = [(125.0, 5.0, car)].into_iter().chain(steps).chain([(front, 0.0, car)]).collect::<Vec<_>>();
        for steps in [&steps[..steps.len() - 1], &steps] {
            let [left_out, kept] = [&[][..], Shortcut::ALL].map(|disabled| {
                meet(&road, &profile, steps, &Options { no_shortcuts: disabled.to_vec(), ..Options::default() })
            });
            prop_assert_eq!(left_out, kept);
        }
    }

    #[test]
    fn a_vehicle_collides_with_what_one_of_its_carriages_touches(
        turns in turns(), profile in shape(), (x, y) in (-4.0..4.0, -4.0..4.0), behind in 0.0..60.0, heading in -3.2..3.2,
    ) {
        let road = Road::turning(&turns);
        let near = road.at(130.0 - behind);
        let car = State { x: near.x + x, y: near.y + y, z: 0.0, heading, speed: 0.0 };
        let of_car = Rectangle::behind(car.front(), Vector::new(heading.cos(), heading.sin()), 5.0, 1.8);
        let touched = profile.carriages().any(|carriage| {
            let [front, rear] = [0.0, carriage.length].map(|length| road.at(130.0 - carriage.behind - length));
            touches(&Rectangle::behind(front, (front - rear).normalize(), carriage.length, profile.width), &of_car)
        });
        let found = meet(&road, &profile, &[(130.0, 5.0, car)], &Options { contact_tolerance: 0.0, ..Options::default() });
        prop_assert_eq!(found.iter().any(|found| found.collision), touched);
    }
}
