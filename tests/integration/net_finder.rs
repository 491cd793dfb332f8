//! The lane at a place of a net.

use closecall::traffic::net::finder::{Finder, REACH, distance};
use std::path::Path;

use closecall::geometry::Vector;

#[test]
fn the_lane_found_is_the_nearest_of_all_lanes() {
    let net =
        closecall_run::net::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/town/town.net.xml")))
            .unwrap();
    let finder = Finder::new(&net.lanes);
    let asides = [(0.0, 0.0), (7.0, -7.5), (-9.0, 4.0), (3.0, 30.0)].map(|(x, y)| Vector::new(x, y));
    let mut found = 0;
    for (place, aside) in net.lanes.iter().map(|lane| lane.shape[1]).zip(asides.into_iter().cycle()) {
        let place = place + aside;
        let of_all = net.lanes.iter_enumerated().map(|(index, lane)| (distance(lane, place), index));
        let nearest = of_all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, _)| *distance <= REACH);
        assert_eq!(finder.lane_at(&net.lanes, place), nearest.map(|(_, lane)| lane));
        found += usize::from(nearest.is_some());
    }
    assert!((100..net.lanes.len()).contains(&found), "{found}");
}
