//! The part of a route that is still ahead.

use std::sync::Arc;

use crate::traffic::net::{EdgeIndex, LaneIndex, Net};

/// A route from one of its edges on, up to its end or to where the net has no link to its next edge.
#[derive(Clone, Debug, Default)]
pub struct RouteAhead {
    /// All edges of the route; none if no route is known, so that any edge may come next.
    edges: Option<Arc<[EdgeIndex]>>,
    /// The first edge that is still ahead.
    begin: usize,
    /// One past the last edge that can be reached.
    end: usize,
}

impl RouteAhead {
    /// The route from this position on.
    pub fn new(net: &Net, route: &Arc<[EdgeIndex]>, position: usize) -> Self {
        if route.is_empty() {
            return Self::default();
        }
        let end = position + connected(net, route, position).len();
        Self { edges: Some(Arc::clone(route)), begin: position, end }
    }

    /// Whether no route is known, so that any edge may come next.
    pub fn is_free(&self) -> bool {
        self.edges.is_none()
    }

    /// Whether it begins at or before this position of the whole route.
    pub fn begins_before(&self, position: usize) -> bool {
        self.begin <= position
    }

    /// Whether it is the same as this route, from this position on.
    pub fn is_same(&self, net: &Net, route: &[EdgeIndex], position: usize) -> bool {
        match &self.edges {
            None => route.is_empty(),
            Some(_) if route.is_empty() => false,
            Some(_) => self.begins_before(position) && self.from(position) == connected(net, route, position),
        }
    }

    /// Advances to this position of the whole route.
    pub fn advance(&mut self, position: usize) {
        if !self.is_free() {
            self.begin = self.begin.max(position);
        }
    }

    /// The edges that are ahead; empty if no route is known.
    pub fn edges(&self) -> &[EdgeIndex] {
        self.from(self.begin)
    }

    /// Whether it has passed the edge of a lane, or the edges before and behind where the lane is within a junction.
    pub(crate) fn has_passed(&self, net: &Net, lane: LaneIndex) -> bool {
        let passed = self.edges.as_ref().and_then(|edges| edges.get(..=self.begin)).unwrap_or_default();
        let lane = &net.lanes[lane];
        let has_edge_of = |lane: &LaneIndex| passed.contains(&net.lanes[*lane].edge);
        passed.contains(&lane.edge)
            || (lane.from.iter().any(has_edge_of) && lane.links.iter().any(|link| has_edge_of(&link.to)))
    }

    fn from(&self, position: usize) -> &[EdgeIndex] {
        self.edges.as_ref().and_then(|edges| edges.get(position..self.end)).unwrap_or_default()
    }
}

/// The edges of a route from this position on, up to its end or to where the net has no link to its next edge.
fn connected<'a>(net: &Net, route: &'a [EdgeIndex], position: usize) -> &'a [EdgeIndex] {
    let rest = route.get(position..).unwrap_or_default();
    let linked = rest.windows(2).take_while(|pair| has_link(net, pair[0], pair[1])).count();
    &rest[..rest.len().min(linked + 1)]
}

/// Whether a link leads from one edge to another.
fn has_link(net: &Net, from: EdgeIndex, to: EdgeIndex) -> bool {
    let lanes = net.edges[from].lanes.iter().map(|lane| &net.lanes[*lane]);
    lanes.flat_map(|lane| &lane.links).any(|link| net.lanes[link.to].edge == to)
}
