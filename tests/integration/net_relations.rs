//! Which lanes of a net are related.

use std::path::Path;

#[test]
fn lanes_of_a_junction_are_related_as_its_matrix_has_it() {
    let net =
        closecall_run::net::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/town/town.net.xml")))
            .unwrap();
    let mut counts = [0; 2];
    for (junction, number) in net.junctions.iter().zip(0..) {
        let links = junction.link_lanes.iter().enumerate().filter_map(|(link, lane)| Some((link as u32, (*lane)?)));
        let links = links.filter(|(_, lane)| net.is_internal(*lane)).collect::<Vec<_>>();
        for (link, lane) in &links {
            for (foe, other) in &links {
                let [a, b] = [*lane, *other].map(|lane| net.passage(lane).unwrap());
                assert!(a.junction == number && b.junction == number);
                let by_design = lane == other || a.from == b.from || a.to == b.to;
                let expected = by_design || junction.are_foes(*link, *foe);
                if !net.are_opposite(*lane, *other) && a.to != b.from && b.to != a.from {
                    assert_eq!(net.relates(*lane, *other), expected, "{} {}", net.lane_id(*lane), net.lane_id(*other));
                    counts[usize::from(expected)] += 1;
                }
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
}

#[test]
fn a_lane_is_related_to_what_leads_there_and_goes_on() {
    let net = closecall_run::net::read(Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../sumo_nets/left_turn/left_turn.net.xml"
    )))
    .unwrap();
    for lane in net.lanes.keys() {
        for link in &net.lanes[lane].links {
            let next = link.via.unwrap_or(link.to);
            assert!(net.relates(lane, next) && net.relates(next, lane));
        }
    }
}
