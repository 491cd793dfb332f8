//! The expected path of a road user while it brakes, as poses.
//!
//! A pose is the chord from the rear to the front bumper, both on the path, as in SUMO. [`straight`] needs only the state,
//! [`arc`] the [`turning`] too; [`lanes`] needs the net and the route, and [`driven`] the future. The last two build a
//! [`track::Track`]; `poses` has the poses along it.

pub mod arc;
mod cursor;
pub mod driven;
mod foot;
pub mod lanes;
mod lateral_offset;
mod next_lane;
mod own_line;
mod poses;
pub mod route;
pub mod straight;
pub mod track;
pub mod turning;

pub use foot::Foot;

use crate::geometry::movement::{Movement, POSES};
use crate::geometry::{Point, Vector};
use crate::util::units::{Metre, Radian};

/// A place on a path, and the heading of the road user there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Distance from the current place of the road user, in m.
    pub distance: Metre,
    /// Front-bumper centre.
    pub front: Point,
    /// Unit vector from the rear to the front.
    pub axis: Vector,
}

impl Pose {
    /// The movement from this pose to the next of a road user of this size.
    pub(crate) fn movement_to(&self, next: &Self, length: Metre, width: Metre) -> Movement {
        Movement { from: self.front, from_axis: self.axis, to: next.front, to_axis: next.axis, length, width }
    }
}

/// The largest turn between two poses for which a corner of a road user of this length stays within
/// [`POSES`] of a straight line: the sagitta is L·Δ²/8.
pub(crate) fn largest_turn(length: Metre) -> Radian {
    (8.0 * POSES / length.max(1.0)).sqrt()
}

/// The direction from the rear to the front; `otherwise` if both are in one place (a hairpin without width).
pub(super) fn chord(front: Point, rear: Point, otherwise: Vector) -> Vector {
    (front - rear).try_normalize(1e-9).unwrap_or(otherwise)
}

/// The angle from one direction to another, −π to π.
pub(crate) fn turn(from: &Vector, to: &Vector) -> Radian {
    crate::geometry::cross(from, to).atan2(from.dot(to))
}

/// The direction turned by an angle.
pub fn rotated(axis: &Vector, by: Radian) -> Vector {
    let (sine, cosine) = by.sin_cos();
    Vector::new(axis.x * cosine - axis.y * sine, axis.x * sine + axis.y * cosine)
}
