//! Poses straight on along the heading.

use super::Pose;
use crate::geometry::{Point, Vector};
use crate::util::units::Metre;

/// The pose at a distance.
pub fn pose(front: Point, axis: Vector, distance: Metre) -> Pose {
    Pose { distance, front: front + axis * distance, axis }
}

/// Adds the poses at the given distances, in ascending order.
pub fn poses(front: Point, axis: Vector, distances: &[Metre], poses: &mut Vec<Pose>) {
    poses.extend(distances.iter().map(|&distance| pose(front, axis, distance)));
}
