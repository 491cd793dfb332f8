//! Lanes that are drawn over each other, in nets as files.

use closecall::traffic::net::Net;
use closecall::traffic::net::overlaps::{ROUNDING, VEHICLE_WIDTH};
use closecall::util::units::Metre;
use std::path::Path;

fn net(text: &str) -> Net {
    closecall_run::net::parse(Path::new("a.net.xml"), text).unwrap()
}

fn overlap(net: &Net, one: &str, other: &str) -> Metre {
    net.overlaps().drawn_overlap(net.lane(other).unwrap(), net.lane(one).unwrap())
}

/// Two links through a junction that come within 1.2 m of each other.
const JUNCTION: &str = r#"<net>
    <edge id=":j_0" function="internal"><lane id=":j_0_0" length="20" shape="0,0 10,0 20,10"/></edge>
    <edge id=":j_1" function="internal"><lane id=":j_1_0" length="15" shape="20,-10 10,-1.2 5,-1.2"/></edge>
    <edge id=":j_2" function="internal"><lane id=":j_2_0" length="5" shape="5,-1.2 0,-9"/></edge>
    <edge id="a"><lane id="a_0" length="50" shape="-50,0 0,0"/></edge>
    <edge id="b"><lane id="b_0" length="50" shape="70,-10 20,-10"/></edge>
    <edge id="c"><lane id="c_0" length="50" shape="20,10 70,10"/></edge>
    <edge id="d"><lane id="d_0" length="50" shape="0,-9 -50,-9"/></edge>
    <junction id="j" x="0" y="0" intLanes=":j_0_0 :j_2_0" shape="0,0 9,9 9,0">
        <request index="0" response="00" foes="00" cont="0"/>
        <request index="1" response="00" foes="00" cont="1"/>
    </junction>
    <connection from="a" to="c" fromLane="0" toLane="0" via=":j_0_0" dir="l" state="M"/>
    <connection from="b" to="d" fromLane="0" toLane="0" via=":j_1_0" dir="l" state="m"/>
    <connection from=":j_0" to="c" fromLane="0" toLane="0" dir="l" state="M"/>
    <connection from=":j_1" to="d" fromLane="0" toLane="0" via=":j_2_0" dir="l" state="m"/>
    <connection from=":j_2" to="d" fromLane="0" toLane="0" dir="l" state="M"/>
</net>"#;

#[test]
fn links_of_a_junction_overlap_unless_they_are_foes() {
    let junction = net(JUNCTION);
    assert!((overlap(&junction, ":j_0_0", ":j_1_0") - 0.6).abs() < 1e-9);
    assert_eq!(overlap(&junction, ":j_1_0", ":j_2_0"), 0.0, "they follow each other");
    // The first junction lane of a link is not a foe either, although only the last is among the junction's lanes.
    for foes in [r#"index="1" response="00" foes="01""#, r#"index="0" response="00" foes="10""#] {
        let number = &foes[..9];
        let junction = net(&JUNCTION.replace(&format!(r#"{number} response="00" foes="00""#), foes));
        assert_eq!(overlap(&junction, ":j_0_0", ":j_1_0"), 0.0);
    }
}

#[test]
fn links_from_or_to_the_same_lane_meet_by_design() {
    for (from, to) in [(r#"from="b" to="d""#, r#"from="a" to="d""#), (r#"to="c""#, r#"to="d""#)] {
        assert_eq!(overlap(&net(&JUNCTION.replace(from, to)), ":j_0_0", ":j_1_0"), 0.0, "{to}");
    }
}

/// A road beside another.
fn beside(shape: &str, attributes: &str) -> Metre {
    let text = format!(
        r#"<net><edge id="a"><lane id="a_0" length="100" shape="0,0 100,0"/></edge>
        <edge id="b"><lane id="b_0" length="100" shape="{shape}" {attributes}/></edge></net>"#
    );
    overlap(&net(&text), "a_0", "b_0")
}

#[test]
fn roads_overlap_where_they_are_beside_each_other() {
    for (shape, depth) in [
        ("80,1.2 20,1.2", 0.6),
        ("20,5 50,0.5 80,5", 1.3),
        ("20,0 80,0", 1.8),
        ("20,1.9 80,1.9", 0.0),
        ("0,0 40,1 60,1 100,0", 1.8),
        // They cross, begin or end together, follow each other, are one road in both directions.
        ("20,-9 80,9", 0.0),
        ("0,0 100,1", 0.0),
        ("0,1 100,0", 0.0),
        ("100.5,0.5 200,0.5", 0.0),
        ("100,0 0,0", 0.0),
    ] {
        assert!((beside(shape, "") - depth).abs() < 1e-9, "{shape}: {}", beside(shape, ""));
    }
    assert!((beside("80,1.2 20,1.2", r#"width="1""#) - 0.2).abs() < 1e-9, "a bicycle lane");
    assert_eq!(beside("80,1.2 20,1.2", r#"allow="pedestrian""#), 0.0, "a sidewalk");
    assert_eq!(beside("80,1.2 20,1.2", r#"disallow="all""#), 0.0, "a verge");
}

#[test]
fn a_lane_that_leads_on_within_metres_is_no_overlap() {
    let text = r#"<net>
        <edge id="a"><lane id="a_0" length="100" shape="0,0 100,0"/></edge>
        <edge id="b"><lane id="b_0" length="1" shape="100,0 100,1"/></edge>
        <edge id="c"><lane id="c_0" length="100" shape="100,1 0,2"/></edge>
        <connection from="a" to="b" fromLane="0" toLane="0" dir="l" state="M"/>
        <connection from="b" to="c" fromLane="0" toLane="0" dir="l" state="M"/>
    </net>"#;
    assert_eq!(overlap(&net(text), "a_0", "c_0"), 0.0);
    assert!(overlap(&net(&text.replace(r#"from="b" to="c""#, r#"from="c" to="b""#)), "a_0", "c_0") > 0.0);
}

#[test]
fn the_deepest_overlap_is_the_first() {
    let net =
        closecall_run::net::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/town/town.net.xml")))
            .unwrap();
    let found = net.overlaps();
    assert!(found.places().is_sorted_by(|a, b| a.depth >= b.depth));
    for place in found.places() {
        assert!((ROUNDING..=VEHICLE_WIDTH).contains(&place.depth) && place.lanes.0 < place.lanes.1);
    }
}
