//! Measures of two that keep their velocities in the plane, whatever their paths are: SSAM's DeltaS (Gettman, Pu, Sayed and
//! Shelby 2008), the anticipated collision time (ACT, Venthuruthiyil and Chunchu 2022) and the emergency index (EI, Cheng,
//! Jiang, Zhang et al. 2024).
//!
//! ```text
//! DeltaS = |v − vᵢ|
//! ACT    = S / (closing speed along S),  S the shortest line between the two rectangles
//! EI     = InDepth / TDM:  TDM the time until the centres are nearest, InDepth how deep the rectangles then overlap across
//!          the relative velocity
//! ```
//!
//! ACT is published with accelerations and yaw rates; here both are 0, as in SSMsOnPlane (Jiao). The published EI adds a
//! safe distance to InDepth, 0 in its authors' code, and so here.

use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, Vector, cross, left_of};
use crate::util::units::{Metre, MetrePerSecond, Second};

/// A road user that keeps its velocity.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// Where it is.
    pub rectangle: Rectangle,
    /// Its speed in m/s.
    pub speed: MetrePerSecond,
}

impl Moving {
    fn velocity(&self) -> Vector {
        self.rectangle.axis * self.speed
    }
}

/// DeltaS in m/s: the size of the difference between both velocities.
pub fn delta_s(a: &Moving, b: &Moving) -> MetrePerSecond {
    (a.velocity() - b.velocity()).norm()
}

/// ACT in s; none if the two overlap, or their nearest points do not come nearer.
pub fn anticipated_collision_time(a: &Moving, b: &Moving) -> Option<Second> {
    let between = shortest_line(&a.rectangle, &b.rectangle);
    let distance = between.norm();
    let closing = (a.velocity() - b.velocity()).dot(&between) / distance;
    Some(distance / closing).filter(|time| distance > 0.0 && *time >= 0.0 && time.is_finite())
}

/// The vector from the first to the second of two rectangles at the points where they are nearest: one of these is a corner.
fn shortest_line(a: &Rectangle, b: &Rectangle) -> Vector {
    let from_corners = a.corners().map(|corner| nearest(b, corner) - corner);
    let to_corners = b.corners().map(|corner| corner - nearest(a, corner));
    let lines = from_corners.into_iter().chain(to_corners);
    lines.min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared())).unwrap_or_default()
}

/// The point of a rectangle that is nearest to a point.
fn nearest(rectangle: &Rectangle, point: Point) -> Point {
    let between = point - rectangle.centre;
    let along = between.dot(&rectangle.axis).clamp(-rectangle.half_length, rectangle.half_length);
    let across = cross(&rectangle.axis, &between).clamp(-rectangle.half_width, rectangle.half_width);
    rectangle.centre + rectangle.axis * along + left_of(&rectangle.axis) * across
}

/// EI in m/s; none if the two would pass each other, or are nearest already.
pub fn emergency_index(a: &Moving, b: &Moving) -> Option<MetrePerSecond> {
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
    use crate::geometry::contact;
    use fastrand::Rng;

    fn random(chance: &mut Rng) -> Moving {
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let centre = Point::new(between(-30.0, 30.0), between(-30.0, 30.0));
        let (length, width) = (between(1.0, 12.0), between(0.5, 2.5));
        let rectangle = Rectangle::new(centre, between(-3.0, 3.0), length, width);
        Moving { rectangle, speed: between(0.0, 20.0) }
    }

    fn after(moving: &Moving, time: f64) -> Rectangle {
        Rectangle { centre: moving.rectangle.centre + moving.velocity() * time, ..moving.rectangle }
    }

    #[test]
    fn act_is_the_distance_over_its_decrease() {
        const STEP: f64 = 1e-7;
        let mut chance = Rng::with_seed(2);
        let mut approaching = 0;
        for _ in 0..500 {
            let (a, b) = (random(&mut chance), random(&mut chance));
            let at = |time| contact::distance(&after(&a, time), &after(&b, time));
            let (now, decrease) = (at(0.0), (at(0.0) - at(STEP)) / STEP);
            if now < 0.1 || decrease.abs() < 0.1 {
                continue;
            }
            let found = anticipated_collision_time(&a, &b);
            assert_eq!(found.is_some(), decrease > 0.0);
            if let Some(found) = found {
                approaching += 1;
                assert!((found / (now / decrease) - 1.0).abs() < 1e-3, "{found}, not {}", now / decrease);
            }
        }
        assert!(approaching > 100, "{approaching}");
    }

    #[test]
    fn ei_parts_the_two_until_they_are_nearest() {
        // By the corners, as its authors compute it.
        let mut chance = Rng::with_seed(4);
        let mut intruding = 0;
        for _ in 0..500 {
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
    fn two_that_keep_their_distance_have_neither() {
        let car = |x, speed| Moving { rectangle: Rectangle::new(Point::new(x, 0.0), 0.0, 5.0, 2.0), speed };
        assert_eq!(anticipated_collision_time(&car(0.0, 9.0), &car(20.0, 9.0)), None);
        assert_eq!(emergency_index(&car(0.0, 9.0), &car(20.0, 9.0)), None);
        assert_eq!(anticipated_collision_time(&car(0.0, 20.0), &car(25.0, 10.0)), Some(2.0));
        assert_eq!((delta_s(&car(0.0, 20.0), &car(25.0, 10.0)), delta_s(&car(0.0, 9.0), &car(20.0, 9.0))), (10.0, 0.0));
    }
}
