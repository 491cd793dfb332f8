//! Straight on along the heading.

use super::Pose;
use crate::geometry::{Point, Vector};
use crate::util::units::Metre;

/// The pose at a way.
pub fn pose(front: Point, axis: Vector, way: Metre) -> Pose {
    Pose { way, front: front + axis * way, axis }
}

/// Adds the poses at the given ways, in ascending order.
pub fn poses(front: Point, axis: Vector, ways: &[Metre], poses: &mut Vec<Pose>) {
    poses.extend(ways.iter().map(|&way| pose(front, axis, way)));
}
