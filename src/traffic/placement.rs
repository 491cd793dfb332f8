//! Where on the net a road user is, and where it is going.

use std::sync::Arc;

use super::net::{EdgeIndex, LaneIndex};
use crate::util::units::{Metre, MetrePerSecond};

/// Where on the net a road user is, and where it is going: what the path along the lanes starts from.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// The lane that its front bumper is on.
    pub lane: LaneIndex,
    /// Distance of its front bumper from the lane's beginning, in SUMO's lane length, in m.
    pub position: Metre,
    /// Its route, where that is new or may have changed; none where it has not changed or is unknown.
    pub route: Option<Arc<[EdgeIndex]>>,
    /// The edge of the route that it is on; within a junction, the edge that it left last.
    pub route_position: usize,
    /// SUMO's speed across the lane, in m/s, positive towards lanes of a higher index: to the left, in a left-hand net to
    /// the right. Other than 0 while a lane change is under way.
    pub lateral_speed: MetrePerSecond,
}
