//! Where a road user will go while it brakes: the poses along its path.
//!
//! A pose is what SUMO's is: the chord from the rear to the front bumper, both on the path. [`straight`] and [`arc`]
//! need nothing but the state, [`lanes`] the net and the route; the latter lays a [`track::Track`] once and follows it; what stands on
//! that is in `poses`.

pub mod arc;
mod beside;
pub mod lanes;
mod own;
mod poses;
pub mod straight;
pub mod track;
mod turns;

use crate::geometry::sweep::Step;
use crate::geometry::{Point, Vector};
use crate::util::units::{Metre, Radian};

/// A place on a path and how the road user stands there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Way from where the road user is now, in m.
    pub way: Metre,
    /// Front-bumper centre.
    pub front: Point,
    /// Unit vector from the rear to the front.
    pub axis: Vector,
}

impl Pose {
    /// The movement from this pose to the next of a road user of this size.
    pub fn step_to(&self, next: &Self, length: Metre, width: Metre) -> Step {
        Step { from: self.front, from_axis: self.axis, to: next.front, to_axis: next.axis, length, width }
    }
}

/// The largest turn between two poses that keeps a corner of a road user of this length within the sweep's
/// tolerance of a straight line between them: the sagitta L·Δ²/8.
pub(crate) fn largest_turn(length: Metre) -> Radian {
    (8.0 * crate::geometry::sweep::TOLERANCE / length.max(1.0)).sqrt()
}

/// The angle from one direction to another, −π to π.
pub(crate) fn turn(from: &Vector, to: &Vector) -> Radian {
    crate::geometry::cross(from, to).atan2(from.dot(to))
}

/// The direction turned by an angle.
pub(crate) fn rotated(axis: &Vector, by: Radian) -> Vector {
    let (sine, cosine) = by.sin_cos();
    Vector::new(axis.x * cosine - axis.y * sine, axis.x * sine + axis.y * cosine)
}
