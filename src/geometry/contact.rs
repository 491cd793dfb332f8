//! Whether two rectangles touch, and how far apart they are.

use super::rectangle::Rectangle;
use super::separating_axes::normals;
use super::{Point, Vector, cross, exact};
use crate::util::units::Metre;

/// Whether two rectangles share a point; touching counts. Every decision is exact: see `geometry::exact`.
pub fn touches(a: &Rectangle, b: &Rectangle) -> bool {
    exact::touches(a, b)
}

/// [`touches`] by separating axes in plain f64 (Gottschalk et al. 1996): for boxes with room to spare.
///
/// Measured (`cargo bench --bench library`): 3 ns; [`touches`] 7 ns; parry2d's `intersection_test` 33 ns.
pub fn plainly_touches(a: &Rectangle, b: &Rectangle) -> bool {
    let between = b.centre - a.centre;
    // All four without a branch: which of them separates is unpredictable.
    normals(a, b).into_iter().fold(true, |touch, (normal, reach)| touch & (between.dot(&normal).abs() <= reach))
}

/// The smallest distance between two rectangles in m; 0 where they touch or overlap.
///
/// Measured (`cargo bench --bench library`): 24 ns; parry2d's `distance` 60 ns.
pub fn distance(a: &Rectangle, b: &Rectangle) -> Metre {
    if touches(a, b) { 0.0 } else { room(a, b) }
}

/// [`distance`] for two rectangles that do not touch: at one of them a corner is nearest.
pub fn room(a: &Rectangle, b: &Rectangle) -> Metre {
    let from = |a: &Rectangle, b: &Rectangle| {
        b.corners().map(|corner| distance_squared(a, corner)).into_iter().fold(f64::INFINITY, f64::min)
    };
    from(a, b).min(from(b, a)).sqrt()
}

/// How deep two rectangles overlap in m: the shortest displacement that parts them; 0 where they do not overlap.
pub fn overlap(a: &Rectangle, b: &Rectangle) -> Metre {
    let between = b.centre - a.centre;
    let depths = normals(a, b).map(|(normal, reach)| reach - between.dot(&normal).abs());
    depths.into_iter().fold(f64::INFINITY, f64::min).max(0.0)
}

/// The square of the distance of a point from a rectangle, in m².
fn distance_squared(rectangle: &Rectangle, point: Point) -> f64 {
    let between = point - rectangle.centre;
    let along = between.dot(&rectangle.axis).abs() - rectangle.half_length;
    let across = cross(&rectangle.axis, &between).abs() - rectangle.half_width;
    Vector::new(along.max(0.0), across.max(0.0)).norm_squared()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use parry2d_f64::query;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Point, parry};

    #[test]
    fn touching_counts_and_a_hair_apart_does_not() {
        let a = Rectangle::new(Point::origin(), 0.0, 4.0, 2.0);
        assert!(touches(&a, &Rectangle::new(Point::new(4.0, 0.0), 0.0, 4.0, 2.0)));
        assert!(!touches(&a, &Rectangle::new(Point::new(4.0 + 1e-12, 0.0), 0.0, 4.0, 2.0)));
    }

    #[test]
    fn a_cross_touches_although_no_corner_lies_inside() {
        let a = Rectangle::new(Point::origin(), 0.0, 10.0, 1.0);
        assert!(touches(&a, &Rectangle::new(Point::origin(), FRAC_PI_2, 10.0, 1.0)));
    }

    #[test]
    fn two_in_line_are_apart_by_their_bumpers() {
        let a = Rectangle::new(Point::origin(), 0.0, 4.0, 2.0);
        let b = Rectangle::new(Point::new(9.0, 0.0), 0.0, 4.0, 2.0);
        assert!((distance(&a, &b) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn the_overlap_is_the_shortest_way_apart() {
        let a = Rectangle::new(Point::origin(), 0.0, 4.0, 2.0);
        for (x, y, depth) in [(3.0, 0.0, 1.0), (3.0, 1.75, 0.25), (4.0, 0.0, 0.0), (9.0, 0.0, 0.0)] {
            assert_eq!(overlap(&a, &Rectangle::new(Point::new(x, y), 0.0, 4.0, 2.0)), depth);
        }
    }

    proptest! {
        #[test]
        fn two_apart_by_their_overlap_just_touch(
            x in -4.0..4.0, y in -4.0..4.0, heading in -4.0..4.0, turn in -4.0..4.0, length in 1.0..20.0,
        ) {
            let a = Rectangle::new(Point::new(1e4, -2e3), heading, 5.0, 1.8);
            let b = Rectangle::new(Point::new(1e4 + x, -2e3 + y), heading + turn, length, 2.5);
            let depth = overlap(&a, &b);
            prop_assume!(depth > 0.0);
            let moved = |by: f64, direction: f64| Rectangle { centre: b.centre + super::super::rectangle::direction(direction) * by, ..b };
            let apart = |by: f64| (0..720).any(|step| !touches(&a, &moved(by, f64::from(step) * std::f64::consts::PI / 360.0)));
            prop_assert!(!apart(depth * 0.99) && apart(depth * 1.001 + 1e-9), "{depth}");
        }

        #[test]
        fn the_distance_is_parrys(
            x in -20.0..20.0, y in -20.0..20.0, heading in -4.0..4.0, turn in -4.0..4.0, length in 0.1..20.0,
        ) {
            let a = Rectangle::new(Point::new(1e4, -2e3), heading, 5.0, 1.8);
            let b = Rectangle::new(Point::new(1e4 + x, -2e3 + y), heading + turn, length, 2.5);
            let ((pose_a, shape_a), (pose_b, shape_b)) = (parry::cuboid(&a), parry::cuboid(&b));
            let reference = query::distance(&pose_a, &shape_a, &pose_b, &shape_b).unwrap().distance;
            prop_assert!((distance(&a, &b) - reference).abs() < 1e-6, "{} {reference}", distance(&a, &b));
        }
    }
}
