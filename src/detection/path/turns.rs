//! A route, a byte an edge: at each edge, which of the links that leave it leads on. Whoever drives has one, and mostly
//! another than all others.

use smallvec::SmallVec;

use crate::traffic::net::{EdgeIndex, Link, Net};

/// So many edges hardly a route goes on over, counted from where its path was laid last; of more the rest has memory of its
/// own.
const MOSTLY: usize = 16;

/// Of a route that goes on over more edges the first so many count.
const MOST: usize = u16::MAX as usize - 1;

/// Nobody knows a route: whatever edge comes next may do.
const FREE: EdgeIndex = EdgeIndex(u32::MAX);

/// The route has been left, or was never on the net.
const NOWHERE: EdgeIndex = EdgeIndex(u32::MAX - 1);

/// A route from one of its edges on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RouteTurns {
    /// That edge.
    begin: EdgeIndex,
    /// Which edge of the whole route that is.
    passed: u32,
    links: SmallVec<[u8; MOSTLY]>,
}

impl Default for RouteTurns {
    fn default() -> Self {
        Self { begin: FREE, passed: 0, links: SmallVec::new() }
    }
}

impl RouteTurns {
    /// The rest of a route from this place on, until it ends or the net has no link to its next edge.
    pub fn of(net: &Net, route: &[EdgeIndex], position: usize) -> Self {
        if route.is_empty() {
            return Self::default();
        }
        let rest = route.get(position..).unwrap_or_default();
        let leads = |ends: &[EdgeIndex]| {
            let number = links(net, ends[0]).position(|link| net.lanes[link.to.0 as usize].edge == ends[1]);
            number.and_then(|number| u8::try_from(number).ok())
        };
        let mut turns = rest.windows(2).take(MOST).map_while(leads).collect::<SmallVec<_>>();
        turns.shrink_to_fit();
        Self { begin: rest.first().copied().unwrap_or(NOWHERE), passed: position as u32, links: turns }
    }

    /// Whether any edge may come next.
    pub fn are_free(&self) -> bool {
        self.begin == FREE
    }

    /// Whether it reaches back to this edge of the whole route.
    pub fn begin_before(&self, position: usize) -> bool {
        self.passed as usize <= position
    }

    /// Forgets what lies before this edge of the whole route.
    pub fn advance(&mut self, net: &Net, position: usize) {
        let further = position.saturating_sub(self.passed as usize);
        if self.are_free() || further == 0 {
            return;
        }
        let begin = self.edges(net).nth(further);
        self.begin = begin.unwrap_or(NOWHERE);
        self.passed = position as u32;
        self.links.drain(..further.min(self.links.len()));
        self.links.shrink_to_fit();
    }

    /// The edges from the first one on; none where there is no route.
    pub fn edges<'a>(&'a self, net: &'a Net) -> impl Iterator<Item = EdgeIndex> + 'a {
        let begin = Some(self.begin).filter(|edge| ![FREE, NOWHERE].contains(edge));
        let mut links_on = self.links.iter();
        std::iter::successors(begin, move |edge| {
            let link = links(net, *edge).nth(*links_on.next()? as usize)?;
            Some(net.lanes[link.to.0 as usize].edge)
        })
    }
}

/// The links that leave an edge.
fn links(net: &Net, edge: EdgeIndex) -> impl Iterator<Item = &Link> {
    net.edges[edge.0 as usize].lanes.iter().flat_map(|lane| &net.lanes[lane.0 as usize].links)
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::LazyLock;

    use proptest::prelude::*;

    use crate::detection::path::turns::*;

    static TOWN: LazyLock<Net> = LazyLock::new(|| Net::read(Path::new("sumo_nets/town/town.net.xml")).unwrap());

    /// A drive through a net: at each edge the link of this number leads on.
    fn route(net: &Net, begin: usize, choices: &[usize]) -> Vec<EdgeIndex> {
        let mut route = vec![EdgeIndex((begin % net.edges.len()) as u32)];
        for choice in choices {
            let from = route[route.len() - 1];
            let Some(link) = links(net, from).nth(choice % links(net, from).count().max(1)) else { break };
            route.push(net.lanes[link.to.0 as usize].edge);
        }
        route
    }

    proptest! {
        #[test]
        fn its_edges_are_those_of_the_route_from_any_place_in_it_on(
            begin in any::<usize>(),
            choices in prop::collection::vec(any::<usize>(), 0..60),
            places in any::<[prop::sample::Index; 2]>(),
        ) {
            let net = &*TOWN;
            let route = route(net, begin, &choices);
            let mut places = places.map(|place| place.index(route.len()));
            places.sort_unstable();
            let mut turns = RouteTurns::of(net, &route, places[0]);
            prop_assert!(turns.edges(net).eq(route[places[0]..].iter().copied()));
            prop_assert!(turns.begin_before(places[1]) && (places[0] == 0 || !turns.begin_before(places[0] - 1)));
            turns.advance(net, places[1]);
            prop_assert!(turns.edges(net).eq(route[places[1]..].iter().copied()));
            turns.advance(net, route.len());
            prop_assert!(turns.edges(net).next().is_none() && !turns.are_free());
        }
    }

    #[test]
    fn a_route_ends_where_no_link_leads_on() {
        let net = &*TOWN;
        let mut route = route(net, 0, &[0; 5]);
        let all = route.len();
        route.push(route[all - 1]);
        assert_eq!(RouteTurns::of(net, &route, 0).edges(net).count(), all);
    }
}
