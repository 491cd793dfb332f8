//! A road user in the scene of a replay, and how far along its route it is.

use std::sync::Arc;

use super::routes::Route;
use closecall::traffic::net::{EdgeIndex, Net};
use closecall::traffic::roster::UserIndex;

/// A road user in the scene.
pub(super) struct ReplayedUser {
    /// Its index in the roster.
    pub index: UserIndex,
    /// The number of its route; none for a person, and where paths do not follow lanes.
    pub number: Option<u64>,
    /// Read when it is first needed.
    pub route: Option<Route>,
    /// The position in its route that it has reached.
    pub route_position: usize,
}

impl ReplayedUser {
    pub fn new(index: UserIndex, number: Option<u64>) -> Self {
        Self { index, number, route: None, route_position: 0 }
    }

    /// The edges of its route; none if it has no route.
    pub fn edges(&self) -> Arc<[EdgeIndex]> {
        self.route.as_ref().map_or_else(|| Arc::from([]), |route| route.edges.clone())
    }

    /// Moves on along its route to where it is in this step.
    pub(crate) fn advance_to(&mut self, step: u32) {
        let Some(route) = &self.route else { return };
        let ahead = route.reached.iter().skip(self.route_position + 1);
        self.route_position += ahead.take_while(|reached| **reached <= step).count();
    }

    /// It is on this edge, and goes along it in the other direction. If that is the edge that it drove along, it has turned round
    /// onto the opposite lane: it is on its next edge already, and overtakes there.
    pub(crate) fn oppose(&mut self, net: &Net, edge: EdgeIndex) {
        let Some(route) = &self.route else { return };
        let Some([current, next]) = route.edges.get(self.route_position..self.route_position + 2) else { return };
        let [[from, to], ends_of_next] = [current, next].map(|edge| net.edges[*edge].ends);
        if *current == edge && ends_of_next == [to, from] {
            self.route_position += 1;
        }
    }
}
