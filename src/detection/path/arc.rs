//! On a circle: the curvature of now is kept.

use super::{Pose, largest_turn, rotated};
use crate::geometry::{Point, Vector, left_of};
use crate::util::units::Metre;

/// Below this curvature, in 1/m, the path is straight: a lateral deviation of 1 mm after 450 m.
const STRAIGHT: f64 = 1e-8;

/// Adds the poses at the given ways, in ascending order, and as many between as the sweep's tolerance needs.
///
/// `curvature` is in 1/m, positive to the left. The heading is the chord from the rear to the front bumper, so at
/// the front the circle's tangent is ahead of it by the angle asin(κ·L/2). On a circle smaller than the chord it
/// turns about the chord's middle, as far as its front gets that way.
pub fn poses(front: Point, axis: Vector, curvature: f64, length: Metre, ways: &[Metre], poses: &mut Vec<Pose>) {
    if curvature.abs() < STRAIGHT {
        super::straight::poses(front, axis, ways, poses);
        return;
    }
    let tightest = 2.0 / length;
    let curvature = curvature.clamp(-tightest, tightest);
    let lead = (curvature * length / 2.0).clamp(-1.0, 1.0).asin();
    let tangent = rotated(&axis, lead);
    let centre = front + left_of(&tangent) / curvature;
    let widest = largest_turn(length);
    let mut last = 0.0;
    for &way in ways {
        let parts = ((way - last) * curvature.abs() / widest).ceil().clamp(1.0, 1e4);
        for part in 1..=parts as u32 {
            let way = last + (way - last) * f64::from(part) / parts;
            let angle = way * curvature;
            poses.push(Pose { way, front: centre + rotated(&(front - centre), angle), axis: rotated(&axis, angle) });
        }
        last = way;
    }
}

/// The curvature, in 1/m, of the circle through two states, `between` apart, with a turn in rad from one to the other;
/// 0 where they are too close to tell. `between` is the circle's chord: 2 sin(turn/2) of its radii.
pub fn curvature(turn: f64, between: Metre) -> f64 {
    /// A shorter way than this says more of rounding than of a curve.
    const SHORTEST: Metre = 0.05;
    /// A smaller radius than SUMO's tightest hairpins is a vehicle that was moved, in m.
    const SMALLEST_RADIUS: Metre = 2.0;
    if between < SHORTEST {
        return 0.0;
    }
    (2.0 * (turn / 2.0).sin() / between).clamp(-1.0 / SMALLEST_RADIUS, 1.0 / SMALLEST_RADIUS)
}

#[cfg(test)]
mod tests {
    use crate::detection::path::arc::*;

    #[test]
    fn a_quarter_circle_ends_a_radius_ahead_and_a_radius_aside() {
        let mut found = Vec::new();
        let quarter = 10.0 * std::f64::consts::FRAC_PI_2;
        poses(Point::origin(), Vector::new(1.0, 0.0), 0.1, 0.0, &[0.0, quarter], &mut found);
        let end = found.last().unwrap();
        assert!((end.front - Point::new(10.0, 10.0)).norm() < 1e-12);
        assert!((end.axis - Vector::new(0.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn two_states_on_a_circle_have_its_curvature_however_far_apart() {
        let (start, radius) = (Point::origin(), 10.0_f64);
        for angle in [-3.0, -0.8, -0.1, 0.1, 0.8, 3.0] {
            let left = Vector::new(0.0, radius.copysign(angle));
            let end = start + left - rotated(&left, angle);
            let found = curvature(angle, (end - start).norm());
            assert!((found * radius.copysign(angle) - 1.0).abs() < 1e-14, "{found}");
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
