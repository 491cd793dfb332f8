//! Measures of two that keep their velocities in the plane, whatever their paths are: SSAM's DeltaS (Gettman, Pu, Sayed and
//! Shelby 2008) and the anticipated collision time (ACT, Venthuruthiyil and Chunchu 2022).
//!
//! ```text
//! DeltaS = |v − vᵢ|
//! ACT    = S / (closing speed along S),  S the shortest line between the two rectangles
//! ```
//!
//! ACT is published with accelerations and yaw rates; here both are 0, as in SSMsOnPlane (Jiao).

use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, Vector, cross, left_of};
use crate::util::units::{MetrePerSecond, Second};

/// A road user that keeps its velocity.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// Where it is.
    pub rectangle: Rectangle,
    /// Its speed in m/s.
    pub speed: MetrePerSecond,
}

impl Moving {
    /// Its velocity in m/s.
    pub fn velocity(&self) -> Vector {
        self.rectangle.axis * self.speed
    }
}

/// DeltaS in m/s: the size of the difference between both velocities.
pub fn delta_s(a: &Moving, b: &Moving) -> MetrePerSecond {
    (a.velocity() - b.velocity()).norm()
}

/// ACT in s; none if the two overlap, or their nearest points do not come nearer.
pub(crate) fn anticipated_collision_time(a: &Moving, b: &Moving) -> Option<Second> {
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geometry::contact;
    use fastrand::Rng;

    /// A road user anywhere, with any heading and size.
    pub(in crate::detection::measures) fn random(chance: &mut Rng) -> Moving {
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
    fn two_that_keep_their_distance_have_none() {
        let car = |x, speed| Moving { rectangle: Rectangle::new(Point::new(x, 0.0), 0.0, 5.0, 2.0), speed };
        assert_eq!(anticipated_collision_time(&car(0.0, 9.0), &car(20.0, 9.0)), None);
        assert_eq!(anticipated_collision_time(&car(0.0, 20.0), &car(25.0, 10.0)), Some(2.0));
        assert_eq!((delta_s(&car(0.0, 20.0), &car(25.0, 10.0)), delta_s(&car(0.0, 9.0), &car(20.0, 9.0))), (10.0, 0.0));
    }
}
