//! The conflict point of a pair: the first pose of the ego at which it touches the area that the foe covers.

use std::f64::consts::PI;

use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, Vector, angle_between};
use crate::util::units::{Metre, Radian};

/// Where an ego meets its foe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConflictPoint {
    /// Distance of the ego to the conflict point.
    pub ego_distance: Metre,
    /// Distance of the foe until it reaches the conflict point.
    pub foe_distance: Metre,
    /// The ego's rectangle at the conflict point; that of the carriage that touches.
    pub ego_rectangle: Rectangle,
    /// How far that carriage is behind the front bumper.
    pub ego_behind: Metre,
    /// The foe's axis at the conflict point; none for an obstacle, which the ego hits with its front.
    pub foe_axis: Option<Vector>,
    /// Whether the foe leaves the conflict area as soon as it moves: a leader in the lane.
    pub foe_leads: bool,
}

impl ConflictPoint {
    /// The angle α between the two headings.
    pub fn angle(&self) -> Radian {
        self.foe_axis.map_or(PI, |axis| angle_between(&self.ego_rectangle.axis, &axis))
    }

    /// Whether the foe first has to arrive and leave: the gap is known once that is. σ = cos α.
    pub(crate) fn foe_leaves(&self, sigma: f64) -> bool {
        !self.foe_leads && self.foe_axis.is_some() && sigma > 0.0
    }

    /// The centre of that rectangle's front: of the front bumper, unless a carriage further behind touches.
    pub fn front(&self) -> Point {
        self.ego_rectangle.centre + self.ego_rectangle.axis * self.ego_rectangle.half_length
    }
}
