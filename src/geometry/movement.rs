//! A rectangle that moves from one pose to the next.
//!
//! The contact of a translation has a closed form ([`super::separating_axes`]). A turn is cut into translations short
//! enough for [`TOLERANCE`] ([`super::bisection`]).
//!
//! Measured (`cargo bench --bench library`): 58 ns for a pair of rectangles, parry2d's `cast_shapes` 226 ns. parry2d's
//! `cast_shapes_nonlinear` handles turns too, but has no cap on its iterations; in our tests it did not always return.

use super::convex::ConvexOutline;
use super::rectangle::Rectangle;
use super::separating_axes::{ContactInterval, slide};
use super::{Point, Vector, cross};
use crate::util::units::Metre;

/// How far a corner of a moving rectangle may be from where it is taken to be while pairs that do not meet are ruled out,
/// in m.
pub const TOLERANCE: Metre = 0.01;

/// The same where a pair is in conflict, in m: where one comes along the flank of another's path, a centimetre to the side is
/// metres along it.
pub const FINE: Metre = 1e-4;

/// The same between two poses of a path, where the line through them cuts a corner, in m.
pub const POSES: Metre = 1e-3;

/// A movement that deviates from the heading by less than this covers a rectangle, in m: more than rounding, far less
/// than the tolerance.
const STRAIGHT: Metre = 1e-9;

/// A rectangle that moves from one pose to the next: the front-bumper centre moves straight, the axis turns evenly.
#[derive(Clone, Copy, Debug)]
pub struct Movement {
    /// Front-bumper centre at the beginning.
    pub from: Point,
    /// Axis at the beginning.
    pub from_axis: Vector,
    /// Front-bumper centre at the end.
    pub to: Point,
    /// Axis at the end.
    pub to_axis: Vector,
    /// Length in m.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
}

impl Movement {
    /// The rectangle at a fraction of the movement, 0 to 1.
    pub fn rectangle(&self, part: f64) -> Rectangle {
        let axis = if self.from_axis == self.to_axis {
            self.from_axis
        } else {
            (self.from_axis + (self.to_axis - self.from_axis) * part).normalize()
        };
        Rectangle::behind(self.from + (self.to - self.from) * part, axis, self.length, self.width)
    }

    /// Whether the movement is a translation.
    pub(crate) fn slides(&self) -> bool {
        self.from_axis == self.to_axis
    }

    /// The contact of a translation with a standing rectangle.
    pub(crate) fn slide_to(&self, fixed: &Rectangle) -> Option<ContactInterval> {
        slide(&self.rectangle(0.0), &(self.to - self.from), fixed)
    }

    /// The rectangle that the movement covers, if it leads straight ahead.
    pub fn covered(&self) -> Option<Rectangle> {
        let by = self.to - self.from;
        let ahead = by.dot(&self.from_axis);
        let leads_ahead = self.slides() && ahead >= 0.0 && cross(&self.from_axis, &by).abs() <= STRAIGHT;
        leads_ahead.then(|| Rectangle::behind(self.to, self.from_axis, self.length + ahead, self.width))
    }

    /// A convex outline around the area that the movement covers.
    pub fn hull(&self) -> ConvexOutline {
        match self.covered() {
            Some(covered) => ConvexOutline::rectangle(&covered),
            None => ConvexOutline::hull(&self.rectangle(0.0), &self.rectangle(1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bisection::Bisection;
    use crate::geometry::separating_axes::{Contact, translation};

    #[test]
    fn a_turning_rectangle_touches_where_sampling_finds_it() {
        let step = Movement {
            from: Point::new(0.0, 0.0),
            from_axis: Vector::new(1.0, 0.0),
            to: Point::new(3.0, 0.5),
            to_axis: Vector::new(0.8, 0.6),
            length: 8.0,
            width: 2.0,
        };
        let fixed = ConvexOutline::rectangle(&Rectangle::new(Point::new(-3.0, -2.5), 0.0, 1.0, 1.0));
        let mut halves = Bisection::default();
        let part = halves.add(step);
        let found = halves.meet(part, &fixed.into(), Contact::Entry).unwrap();
        let touching =
            |part| translation(&ConvexOutline::rectangle(&step.rectangle(part)), &Vector::zeros(), &fixed).is_some();
        let sampled = (0..=10_000).map(|i| f64::from(i) / 10_000.0).find(|&part| touching(part)).unwrap();
        assert!((found - sampled).abs() < 0.01, "{found} against {sampled}");
    }
}
