//! Corners of pavements that junction lanes cut, in nets as files.

use closecall::geometry::Point;
use closecall::traffic::net::corners::cut_corners;
use closecall::util::units::Metre;
use std::path::Path;

/// How far a vehicle on a junction lane of this shape cuts a corner of 4 m by 4 m.
fn cut(shape: &str, attributes: &str) -> Option<Metre> {
    let text = format!(
        r#"<net><edge id=":j_0" function="internal"><lane id=":j_0_0" length="9" shape="{shape}" {attributes}/></edge>
        <edge id=":j_w0" function="walkingarea"><lane id=":j_w0_0" length="4" shape="0,0 4,0 4,4 0,4"/></edge>
        <edge id=":k_w0" function="walkingarea"><lane id=":k_w0_0" length="4" shape="0,0 4,0 4,4 0,4"/></edge></net>"#
    );
    let found = cut_corners(&closecall_run::net::parse(Path::new("net"), text).unwrap(), 0.1);
    assert!(found.len() < 2, "only in its own junction");
    found.first().map(|place| place.depth)
}

#[test]
fn a_vehicle_cuts_the_corner_that_its_lane_passes_too_near() {
    for (shape, depth) in [
        ("-5,-0.5 9,-0.5", Some(0.4)),
        ("-5,-0.5 5,-0.7 9,-3", Some(0.3)),
        ("-5,-0.82 9,-0.82", None),
        ("-5,-1 9,-1", None),
        ("-5,0.5 1,0.5 2,-9", Some(1.4)),
        ("-5,2 2,2 9,2", None),
        ("-3,0 -0.3,-0.4 0,-3", Some(0.4)),
    ] {
        let found = cut(shape, "");
        assert!(found.is_some() == depth.is_some(), "{shape}: {found:?}");
        assert!((found.unwrap_or(0.0) - depth.unwrap_or(0.0)).abs() < 0.02, "{shape}: {found:?}");
    }
    assert_eq!(cut("-5,-0.5 9,-0.5", r#"width="1""#), None, "a bicycle lane");
    assert_eq!(cut("-5,-0.5 9,-0.5", r#"allow="pedestrian""#), None, "for persons");
}

#[test]
fn a_person_on_a_walking_area_or_just_beside_it_is_known() {
    let text = r#"<net><edge id=":j_w0" function="walkingarea">
        <lane id=":j_w0_0" length="9" shape="0,0 9,0 9,9 6,3"/></edge></net>"#;
    let net = closecall_run::net::parse(Path::new("net"), text.to_owned()).unwrap();
    let places = [(7.0, 2.5, true), (8.5, 7.0, true), (-3.9, 0.0, true), (4.0, -3.9, true)];
    let others = [(-4.1, 0.0, false), (0.0, 8.0, false), (13.5, 1.5, false), (20.0, 1.0, false)];
    for (x, y, is_on) in places.into_iter().chain(others) {
        assert_eq!(net.walking_area_at(Point::new(x, y)).is_some(), is_on, "{x}, {y}");
    }
}
