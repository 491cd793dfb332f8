//! A road user in the scene of a replay, and how far along its route it is.

use std::sync::Arc;

use crate::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};
use crate::traffic::roster::UserIndex;

/// A road user in the scene.
pub(super) struct ReplayedUser {
    /// Its index in the roster.
    pub index: UserIndex,
    /// The number of its route; none for a person, and where paths do not follow lanes.
    pub number: Option<u64>,
    /// Read when it is first needed.
    pub route: Option<Arc<[EdgeIndex]>>,
    /// The position in its route that it has reached.
    pub route_position: usize,
    /// The recording's number of the lane that it was last on.
    pub lane: u32,
}

impl ReplayedUser {
    pub fn new(index: UserIndex, number: Option<u64>) -> Self {
        Self { index, number, route: None, route_position: 0, lane: u32::MAX }
    }

    /// Moves on along its route to this lane.
    pub fn advance_to(&mut self, net: &Net, lane: LaneIndex) {
        let Some(route) = &self.route else { return };
        let edge = net.lanes[lane.0 as usize].edge;
        let find = |edge: EdgeIndex| route[self.route_position..].iter().position(|known| *known == edge);
        let further = if net.edges[edge.0 as usize].function == EdgeFunction::Normal {
            find(edge).unwrap_or(0)
        } else if let Some(link) = net.lanes[lane.0 as usize].links.first() {
            // Inside a junction, the position is that of the edge before it.
            let to = net.lanes[link.to.0 as usize].edge;
            find(to).map_or(0, |further| further.saturating_sub(1))
        } else {
            0
        };
        self.route_position += further;
    }
}
