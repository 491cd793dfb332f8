//! The conflict point of a pair: the first pose of the ego at which it touches what the foe covers.

use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, Vector, angle_between};
use crate::util::units::{Metre, Radian};

/// Where an ego meets a foe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConflictPoint {
    /// Way of the ego to the meeting place.
    pub ego_distance: Metre,
    /// Way of the foe until it is there.
    pub foe_distance: Metre,
    /// The ego's rectangle there.
    pub ego: Rectangle,
    /// The foe's axis there; none for an obstacle, which the ego meets with its front.
    pub foe_axis: Option<Vector>,
    /// Whether the foe is out of the way as soon as it moves: a leader in the lane.
    pub leads: bool,
}

impl ConflictPoint {
    /// The angle α between the two headings.
    pub fn angle(&self) -> Radian {
        match self.foe_axis {
            Some(axis) => angle_between(&self.ego.axis, &axis),
            None => std::f64::consts::PI,
        }
    }

    /// The ego's front-bumper centre.
    pub fn place(&self) -> Point {
        self.ego.centre + self.ego.axis * self.ego.half_length
    }
}
