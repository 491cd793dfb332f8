//! Straight on along the heading.

use super::Pose;
use crate::geometry::{Point, Vector};
use crate::units::Metre;

/// Adds the poses at the given ways, in ascending order.
pub fn poses(front: Point, axis: Vector, ways: &[Metre], poses: &mut Vec<Pose>) {
    poses.extend(ways.iter().map(|&way| Pose { way, front: front + axis * way, axis }));
}
