//! The edges that a road user still has before it, on a net.

use std::sync::Arc;

use closecall::detection::path::route::RouteAhead;
use closecall::traffic::net::{EdgeIndex, Net};
use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;

/// Read once for all cases.
static TOWN: LazyLock<Net> = LazyLock::new(|| {
    closecall_run::net::read(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../sumo_nets/town/town.net.xml")))
        .unwrap()
});

/// A drive through a net: at each edge the link of this number is taken.
fn route(net: &Net, begin: usize, choices: &[usize]) -> Vec<EdgeIndex> {
    let mut route = vec![EdgeIndex((begin % net.edges.len()) as u32)];
    for choice in choices {
        let lanes = &net.edges[route[route.len() - 1]].lanes;
        let links = lanes.iter().flat_map(|lane| &net.lanes[*lane].links).collect::<Vec<_>>();
        let Some(link) = links.get(choice % links.len().max(1)) else { break };
        route.push(net.lanes[link.to].edge);
    }
    route
}

proptest! {
    #[test]
    fn its_edges_are_the_rest_of_the_route(
        begin in any::<usize>(),
        choices in prop::collection::vec(any::<usize>(), 0..60),
        positions in any::<[prop::sample::Index; 2]>(),
    ) {
        let net = &*TOWN;
        let route = Arc::<[EdgeIndex]>::from(route(net, begin, &choices));
        let mut positions = positions.map(|position| position.index(route.len()));
        positions.sort_unstable();
        let [first, second] = positions;
        let mut ahead = RouteAhead::new(net, &route, first);
        prop_assert_eq!(ahead.edges(), &route[first..]);
        prop_assert!(ahead.begins_before(second) && (first == 0 || !ahead.begins_before(first - 1)));
        prop_assert!(ahead.is_same(net, &route, second));
        ahead.advance(second);
        prop_assert_eq!(ahead.edges(), &route[second..]);
        ahead.advance(route.len());
        prop_assert!(ahead.edges().is_empty() && !ahead.is_free());
    }
}

#[test]
fn a_route_ends_where_no_link_leads_on() {
    let mut route = route(&TOWN, 0, &[0; 5]);
    let linked = route.len();
    route.push(route[linked - 1]);
    assert_eq!(RouteAhead::new(&TOWN, &Arc::from(route), 0).edges().len(), linked);
}
