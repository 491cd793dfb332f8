//! The links, lanes and errors of nets as files.

use closecall::traffic::net::{Link, Net};
use std::path::Path;

use closecall::geometry::Point;
use closecall_run::Result;

fn net(text: &str) -> Result<Net> {
    closecall_run::net::parse(Path::new("corner.net.xml"), text)
}

const CORNER: &str = r#"<net>
    <edge id=":b_0" function="internal"><lane id=":b_0_0" length="5" shape="100,0 102,2 102,5"/></edge>
    <edge id="ab" from="a" to="b"><lane id="ab_0" length="100" shape="0,0 100,0"/></edge>
    <edge id="bc" from="b" to="c"><lane id="bc_0" length="50" shape="102,5 102,5 102,55" width="2.5"/></edge>
    <junction id="b" x="100" y="0" shape="100,0 102,2 102,5"/>
    <connection from="ab" to="bc" fromLane="0" toLane="0" via=":b_0_0" dir="l" state="M"/>
    <connection from=":b_0" to="bc" fromLane="0" toLane="0" dir="l" state="M"/>
</net>"#;

#[test]
fn lanes_have_links_through_the_junction() {
    let net = net(CORNER).unwrap();
    let (ab, via, bc) = (net.lane("ab_0").unwrap(), net.lane(":b_0_0").unwrap(), net.lane("bc_0").unwrap());
    assert_eq!(net.lanes[ab].links, [Link { to: bc, via: Some(via) }]);
    assert_eq!(net.lanes[via].links, [Link { to: bc, via: None }]);
    assert_eq!(net.lanes[bc].from, [via]);
    assert_eq!(net.edges[net.edge(":b_0").unwrap()].junction, "b");
}

#[test]
fn a_place_is_on_the_nearest_lane() {
    let net = net(CORNER).unwrap();
    assert_eq!(net.lane_at(Point::new(40.0, 1.0)), net.lane("ab_0"));
    assert_eq!(net.lane_at(Point::new(103.0, 30.0)), net.lane("bc_0"));
    assert_eq!(net.lane_at(Point::new(40.0, 30.0)), None);
}

#[test]
fn a_repeated_point_is_dropped() {
    let net = net(CORNER).unwrap();
    let index = net.lane("bc_0").unwrap();
    let lane = &net.lanes[index];
    assert_eq!((lane.shape.len(), lane.width, net.lines.length(index.0)), (2, 2.5, 50.0));
}

#[test]
fn an_escaped_id_is_the_one_that_sumo_uses() {
    let net = net(&CORNER.replace("ab_0", "a&amp;b_0")).unwrap();
    assert!(net.lane("a&b_0").is_some());
}

#[test]
fn errors_name_the_line() {
    for (from, to, expected) in [
        ("0,0 100,0", "0,0", r#"line 3: lane "ab_0" has 1 shape point(s); at least two are needed"#),
        ("0,0 100,0", "0,0 nan,0", r#"line 3: "ab_0": x is NaN, it must be -1e8 to 1e8 m"#),
        ("0,0 100,0", "0,0 x", r#"line 3: "ab_0": shape point "x" is not x,y or x,y,z"#),
        (r#"via=":b_0_0""#, r#"via="gone""#, r#"line 6: no lane "gone""#),
        (r#"length="100""#, r#"length="-1""#, r#"line 3: "ab_0": length is -1, it must be 0 to 10000000 m"#),
        ("</net>", "", "the file ends before its elements do"),
        ("<net>", "<routes>", "not a SUMO net: its root element is not <net>"),
    ] {
        let message = net(&CORNER.replace(from, to)).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}
