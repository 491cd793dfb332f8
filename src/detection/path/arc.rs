//! Poses on a circle with the current curvature.

use super::{Pose, largest_turn, rotated};
use crate::geometry::{Point, Vector, left_of};
use crate::util::units::Metre;

/// Below this curvature, in 1/m, the path is straight: a lateral deviation of 1 mm after 450 m.
const STRAIGHT: f64 = 1e-8;

/// Adds the poses at the given distances, in ascending order, and as many between as the turn needs.
///
/// `curvature` is in 1/m, positive to the left. The heading is the chord from the rear to the front bumper, so the
/// circle's tangent at the front is ahead of it by the angle asin(κ·L/2). If the circle is smaller than the chord, the
/// road user turns about the middle of the chord.
pub fn poses(front: Point, axis: Vector, curvature: f64, length: Metre, distances: &[Metre], poses: &mut Vec<Pose>) {
    if curvature.abs() < STRAIGHT {
        super::straight::poses(front, axis, distances, poses);
        return;
    }
    let tightest = 2.0 / length;
    let curvature = curvature.clamp(-tightest, tightest);
    let lead = (curvature * length / 2.0).clamp(-1.0, 1.0).asin();
    let tangent = rotated(&axis, lead);
    let centre = front + left_of(&tangent) / curvature;
    // The corners are at most this far from the centre; between two poses each cuts its own circle.
    let widest = largest_turn(1.0 / curvature.abs() + length);
    let mut last = 0.0;
    for &distance in distances {
        let parts = ((distance - last) * curvature.abs() / widest).ceil().clamp(1.0, 1e4);
        for part in 1..=parts as u32 {
            let distance = last + (distance - last) * f64::from(part) / parts;
            let angle = distance * curvature;
            poses.push(Pose {
                distance,
                front: centre + rotated(&(front - centre), angle),
                axis: rotated(&axis, angle),
            });
        }
        last = distance;
    }
}

#[cfg(test)]
mod tests {
    use crate::detection::path::arc::*;

    #[test]
    fn a_quarter_circle_ends_a_radius_ahead_and_aside() {
        let mut found = Vec::new();
        let quarter = 10.0 * std::f64::consts::FRAC_PI_2;
        poses(Point::origin(), Vector::new(1.0, 0.0), 0.1, 0.0, &[0.0, quarter], &mut found);
        let end = found.last().unwrap();
        assert!((end.front - Point::new(10.0, 10.0)).norm() < 1e-12);
        assert!((end.axis - Vector::new(0.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn no_corner_leaves_the_line_between_two_poses_by_a_millimetre() {
        for radius in [5.0_f64, 50.0, 500.0] {
            let mut found = Vec::new();
            poses(Point::origin(), Vector::new(1.0, 0.0), 1.0 / radius, 4.0, &[0.0, 60.0], &mut found);
            for pair in found.windows(2) {
                let chord = (pair[1].front - pair[0].front).norm();
                let sagitta = radius - (radius * radius - chord * chord / 4.0).sqrt();
                assert!(sagitta <= 1e-3, "{radius}: {sagitta}");
            }
        }
    }

    #[test]
    fn front_and_rear_stay_on_the_same_circle() {
        let mut found = Vec::new();
        poses(Point::origin(), Vector::new(1.0, 0.0), 0.1, 5.0, &[0.0, 8.0], &mut found);
        let centre = Point::origin() + left_of(&rotated(&Vector::new(1.0, 0.0), 0.25_f64.asin())) * 10.0;
        for pose in found {
            assert!(((pose.front - centre).norm() - 10.0).abs() < 1e-12);
            assert!(((pose.front - pose.axis * 5.0 - centre).norm() - 10.0).abs() < 1e-12);
        }
    }
}
