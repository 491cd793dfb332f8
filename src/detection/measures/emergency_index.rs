//! Emergency index (EI, Cheng, Jiang, Zhang et al. 2024) of two that keep their velocities in the plane: how fast an evasion has
//! to take them apart.
//!
//! ```text
//! EI = InDepth / TDM:  TDM the time until the centres are nearest, InDepth how deep the rectangles then overlap across the
//!      relative velocity
//! ```
//!
//! The published InDepth includes a safe distance, which is 0 in its authors' code, and so here.

use super::plane::Moving;
use crate::geometry::cross;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::{Metre, MetrePerSecond};

/// EI in m/s; none if the two would pass each other, or are nearest already.
pub(crate) fn emergency_index(a: &Moving, b: &Moving) -> Option<MetrePerSecond> {
    let (between, relative) = (b.rectangle.centre - a.rectangle.centre, b.velocity() - a.velocity());
    let nearest_after = -between.dot(&relative) / relative.norm_squared();
    if nearest_after.is_nan() || nearest_after <= 0.0 {
        return None;
    }
    let direction = relative.normalize();
    let reach = |of: &Rectangle| -> Metre {
        cross(&of.axis, &direction).abs() * of.half_length + of.axis.dot(&direction).abs() * of.half_width
    };
    let depth = reach(&a.rectangle) + reach(&b.rectangle) - cross(&direction, &between).abs();
    Some(depth / nearest_after).filter(|index| *index > 0.0 && index.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::measures::plane::tests::random;
    use crate::geometry::{Point, Vector};
    use fastrand::Rng;

    #[test]
    fn ei_parts_the_two_until_they_are_nearest() {
        // By the corners, as its authors compute it.
        let mut chance = Rng::with_seed(4);
        let mut intruding = 0;
        for _ in 0..2000 {
            let (a, b) = (random(&mut chance), random(&mut chance));
            let relative = b.velocity() - a.velocity();
            let theta = relative / relative.norm();
            let delta = b.rectangle.centre - a.rectangle.centre;
            let tdm = -delta.dot(&theta) / relative.norm();
            let off = |vector: Vector| (vector - theta * vector.dot(&theta)).norm();
            let reach = |of: &Moving| {
                let corners = of.rectangle.corners().map(|corner| off(corner - of.rectangle.centre));
                corners.into_iter().fold(0.0, f64::max)
            };
            let depth = reach(&a) + reach(&b) - off(delta);
            let expected = Some(depth / tdm).filter(|_| tdm > 0.0 && depth > 0.0);
            let found = emergency_index(&a, &b);
            assert_eq!(found.is_some(), expected.is_some());
            if let (Some(found), Some(expected)) = (found, expected) {
                intruding += 1;
                assert!((found / expected - 1.0).abs() < 1e-9, "{found}, not {expected}");
            }
        }
        assert!(intruding > 50, "{intruding}");
    }

    #[test]
    fn two_that_keep_their_distance_have_none() {
        let car = |x| Moving { rectangle: Rectangle::new(Point::new(x, 0.0), 0.0, 5.0, 2.0), speed: 9.0 };
        assert_eq!(emergency_index(&car(0.0), &car(20.0)), None);
    }
}
