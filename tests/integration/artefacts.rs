//! What is set aside because it is not traffic, and what never is.

use std::path::Path;
use std::sync::Arc;

use closecall::{Artefact, Category, Net, Options, PathModel, Profile, Severity, State, SumoType};
use closecall_run::{Error, Result, Run};

use crate::why::{Drive, LEFT, ONCOMING, conflicts, drive, net_of, road};

/// What a run of some seconds makes of these: of each conflict why it is set aside, and how severe it is.
fn set_aside(net: &Net, drives: &[Drive], lasts: f64) -> Vec<(Option<Artefact>, Severity)> {
    conflicts(net, drives, &[], lasts).iter().map(|conflict| (conflict.artefact, conflict.severity)).collect()
}

#[test]
fn one_that_waits_inside_a_junction_is_passed() {
    let net = net_of("left_turn");
    let length = |lane: &str| net.lanes[net.lane(lane).unwrap()].length;
    let waits = || drive(&LEFT[1..], length(LEFT[1]) + 3.0, |_| 0.0);
    let comes = |speed: fn(f64) -> f64| drive(&ONCOMING, length(ONCOMING[0]) - 30.0, speed);
    let passed = set_aside(&net, &[waits(), comes(|_| 12.0)], 6.0);
    assert!(
        passed.iter().all(|(artefact, _)| *artefact == Some(Artefact::DrawnOverlap)) && !passed.is_empty(),
        "{passed:?}"
    );
    // One that brakes has seen the other.
    let braked = set_aside(&net, &[waits(), comes(|time| (18.0 - 3.0 * time).max(0.0))], 6.0);
    assert!(braked.iter().any(|(artefact, _)| artefact.is_none()), "{braked:?}");
}

/// A junction whose two links cross as drawn.
fn crossing_links(foes: [&str; 2]) -> Net {
    let text = format!(
        r#"<net>
        <edge id=":j_0" function="internal"><lane id=":j_0_0" length="20" shape="0,0 20,0"/></edge>
        <edge id=":j_1" function="internal"><lane id=":j_1_0" length="20" shape="10,-10 10,10"/></edge>
        <edge id="a" from="w" to="j"><lane id="a_0" length="100" shape="-100,0 0,0"/></edge>
        <edge id="b" from="s" to="j"><lane id="b_0" length="100" shape="10,-110 10,-10"/></edge>
        <edge id="c" from="j" to="e"><lane id="c_0" length="100" shape="20,0 120,0"/></edge>
        <edge id="d" from="j" to="n"><lane id="d_0" length="100" shape="10,10 10,110"/></edge>
        <junction id="j" x="10" y="0" intLanes=":j_0_0 :j_1_0" shape="0,-10 20,-10 20,10 0,10">
            <request index="0" response="00" foes="{}" cont="0"/>
            <request index="1" response="00" foes="{}" cont="0"/>
        </junction>
        <connection from="a" to="c" fromLane="0" toLane="0" via=":j_0_0" dir="s" state="M"/>
        <connection from="b" to="d" fromLane="0" toLane="0" via=":j_1_0" dir="s" state="M"/>
        <connection from=":j_0" to="c" fromLane="0" toLane="0" dir="s" state="M"/>
        <connection from=":j_1" to="d" fromLane="0" toLane="0" dir="s" state="M"/>
    </net>"#,
        foes[0], foes[1]
    );
    closecall_run::net::parse(Path::new("a.net.xml"), text).unwrap()
}

#[test]
fn links_that_are_no_foes_cross_only_as_drawn() {
    let found = |foes: [&str; 2]| {
        let net = crossing_links(foes);
        let routes = [["a_0", ":j_0_0", "c_0"], ["b_0", ":j_1_0", "d_0"]];
        let drives = routes.map(|lanes| drive(&lanes, 60.0, |_| 12.0));
        set_aside(&net, &drives, 6.0)
    };
    assert_eq!(found(["00", "00"]), [(Some(Artefact::DrawnOverlap), Severity::Critical)]);
    assert_eq!(found(["10", "01"]), [(None, Severity::Critical)]);
}

#[test]
fn foes_of_the_junction_are_traffic() {
    let net = net_of("left_turn");
    let length = |lane: &str| net.lanes[net.lane(lane).unwrap()].length;
    let crash =
        [drive(&LEFT, length(LEFT[0]) - 15.0, |_| 10.0), drive(&ONCOMING, length(ONCOMING[0]) - 18.0, |_| 12.0)];
    let found = set_aside(&net, &crash, 5.0);
    assert!(found.contains(&(None, Severity::Critical)), "{found:?}");
}

#[test]
fn what_appears_stops_or_jumps_at_once_is_set_aside() {
    let net = road();
    let follower = || drive(&["road_0"], 10.0, |_| 20.0);
    let appears = Drive { enters: 3.0, ..drive(&["road_0"], 76.0, |time| if time < 3.1 { 0.0 } else { 20.0 }) };
    let stops = drive(&["road_0"], 30.0, |time| if time < 3.0 { 20.0 } else { 0.0 });
    for (other, artefact) in [(appears, Artefact::Appeared), (stops, Artefact::StoppedAtOnce)] {
        let found = set_aside(&net, &[follower(), other], 3.4);
        assert_eq!(found.iter().map(|(found, _)| *found).collect::<Vec<_>>(), [Some(artefact)]);
    }
    let jumps = Drive { change: Some((3.0, "road_0")), ..drive(&["road_1"], 12.0, |_| 20.0) };
    let found = set_aside(&net, &[follower(), jumps], 3.1);
    assert_eq!(found.iter().map(|(found, _)| *found).collect::<Vec<_>>(), [Some(Artefact::Jumped)]);
}

#[test]
fn a_leader_that_brakes_as_cars_do_is_traffic() {
    let brakes = |time: f64| if time < 3.0 { 20.0 } else { (20.0 - 9.0 * (time - 3.0)).max(0.0) };
    let found = set_aside(&road(), &[drive(&["road_0"], 10.0, |_| 20.0), drive(&["road_0"], 30.0, brakes)], 5.0);
    assert_eq!(found, [(None, Severity::Critical)]);
}

#[test]
fn a_person_on_the_pavement_is_not_in_the_way() {
    let text = r#"<net><edge id="a">
        <lane id="a_0" length="200" speed="1.4" allow="pedestrian" width="2" shape="0,-2.6 200,-2.6"/>
        <lane id="a_1" length="200" speed="30" shape="0,0 200,0"/></edge></net>"#;
    let beside = |y: f64| {
        let shape = format!("0,{y} 200,{y}");
        let net = closecall_run::net::parse(Path::new("a.net.xml"), text.replace("0,0 200,0", &shape)).unwrap();
        let person = Drive { category: Category::Person, ..drive(&["a_0"], 80.0, |_| 0.0) };
        set_aside(&net, &[drive(&["a_1"], 10.0, |_| 15.0), person], 6.0)
    };
    // The car cuts the pavement as drawn.
    let found = beside(-1.2);
    assert!(
        !found.is_empty() && found.iter().all(|(artefact, _)| *artefact == Some(Artefact::DrawnOverlap)),
        "{found:?}"
    );
}

/// The numbers of collisions and of set-aside conflicts when a car overlaps a person at this place.
fn over_a_person(x: f64, speed: f64) -> (u64, Option<u64>) {
    let text = r#"<net><edge id=":j_w0" function="walkingarea">
        <lane id=":j_w0_0" length="4" shape="0,-2 9,-2 9,2 0,2"/></edge></net>"#;
    let net = Arc::new(closecall_run::net::parse(Path::new("net"), text.to_owned()).unwrap());
    let options = Options { path: PathModel::Straight, ..Options::default() };
    let mut run = Run::new(&options.clone().into(), Some(net)).unwrap();
    let car = run.roster.profile(Profile::vehicle(&SumoType::car("car"), &options)).unwrap();
    let person = run.roster.profile(Profile::person(&SumoType::car("person"), &options, 0.1)).unwrap();
    let users = [run.enter("car", car), run.enter("person", person)];
    run.begin_step(0.0);
    for (user, (x, speed)) in users.into_iter().zip([(x, speed), (x - 1.0, 1.0)]) {
        run.frame.push(user, State { x, y: 0.0, z: 0.0, heading: 0.0, speed });
    }
    let stepped: Result<()> = run.step(|_, _| Ok::<_, Error>(()));
    stepped.unwrap();
    let summary = run.finish().unwrap();
    assert_eq!(summary.logged(), 1);
    (summary.collisions, summary.set_aside().get("drawn_overlap").copied())
}

#[test]
fn a_person_on_a_walking_area_is_not_in_the_way() {
    assert_eq!(over_a_person(5.0, 5.0), (0, Some(1)));
    assert_eq!(over_a_person(19.0, 5.0), (1, None));
}

#[test]
fn a_vehicle_that_stands_hits_no_person() {
    assert_eq!(over_a_person(19.0, 0.0), (0, Some(1)));
}

#[test]
fn a_follower_on_a_folded_lane_overlaps_only_as_drawn() {
    let net = |apart: f64| {
        let shape = format!("0,0 100,0 100,{apart} 0,{apart}");
        let text = format!(
            r#"<net><edge id="a"><lane id="a_0" length="{}" speed="30" shape="{shape}"/></edge></net>"#,
            200.0 + apart
        );
        closecall_run::net::parse(Path::new("a.net.xml"), text).unwrap()
    };
    let follow = |apart: f64| {
        let drives = [60.0, 40.0].map(|start| drive(&["a_0"], start, |_| 10.0));
        set_aside(&net(apart), &drives, 6.0)
    };
    let folded = follow(1.5);
    let severe =
        |(artefact, severity): &&(Option<Artefact>, Severity)| artefact.is_none() && *severity > Severity::Caution;
    assert!(folded.iter().any(|(artefact, _)| *artefact == Some(Artefact::DrawnOverlap)), "{folded:?}");
    assert_eq!(folded.iter().find(severe), None);
    assert!(follow(6.0).iter().all(|(artefact, _)| artefact.is_none()));
}
