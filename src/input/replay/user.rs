//! A road user in the scene of a replay, and how far along its route it is.

use std::sync::Arc;

use super::routes::Route;
use crate::traffic::net::EdgeIndex;
use crate::traffic::roster::UserIndex;

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
    pub fn advance_to(&mut self, step: u32) {
        let Some(route) = &self.route else { return };
        let ahead = route.reached.iter().skip(self.route_position + 1);
        self.route_position += ahead.take_while(|reached| **reached <= step).count();
    }
}
