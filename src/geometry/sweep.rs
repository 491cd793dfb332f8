//! When a moving convex outline first touches another, and when it leaves it again.
//!
//! Closed form for a translation: on each edge normal the two projections overlap during one interval of the way;
//! they touch where all intervals do (the swept form of the separating-axes test; Eberly, "Dynamic collision
//! detection using oriented bounding boxes"). A turn is cut into translations short enough for [`TOLERANCE`].
//!
//! Measured (`cargo bench --bench library`): 66 ns for a pair of rectangles, parry2d's `cast_shapes` 211 ns; its
//! `cast_shapes_nonlinear`, which would turn too, has no cap on its iterations and was seen not to return.

use super::outline::Outline;
use super::rectangle::Rectangle;
use super::{Bounds, Point, Vector, cross};
use crate::units::Metre;

/// How far a corner of a sweeping rectangle may be from where it really goes, in m.
pub const TOLERANCE: Metre = 0.01;

/// A step that leaves its own direction by less than this covers a rectangle, in m: more than rounding, far less than
/// the tolerance.
const STRAIGHT: Metre = 1e-9;

/// The part of a movement, 0 at its beginning and 1 at its end, during which two outlines touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Where they begin to touch.
    pub enter: f64,
    /// Where they touch last; above 1 where they still do at the end.
    pub leave: f64,
}

/// Contact of `moving`, displaced by `by`, with `fixed`; none if they do not touch on the way.
pub fn translation(moving: &Outline, by: &Vector, fixed: &Outline) -> Option<Contact> {
    let mut contact = Contact { enter: 0.0, leave: f64::INFINITY };
    for normal in moving.normals().chain(fixed.normals()) {
        let (low, high) = moving.extent(&normal);
        let (fixed_low, fixed_high) = fixed.extent(&normal);
        let speed = by.dot(&normal);
        let before = fixed_low - high;
        let behind = fixed_high - low;
        if speed == 0.0 {
            if before > 0.0 || behind < 0.0 {
                return None;
            }
            continue;
        }
        let (enter, leave) =
            if speed > 0.0 { (before / speed, behind / speed) } else { (behind / speed, before / speed) };
        contact.enter = contact.enter.max(enter);
        contact.leave = contact.leave.min(leave);
        if contact.enter > contact.leave || contact.enter > 1.0 {
            return None;
        }
    }
    Some(contact)
}

/// A rectangle on its way from one pose to the next: the front-bumper centre moves straight, the axis turns evenly.
#[derive(Clone, Copy, Debug)]
pub struct Step {
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

impl Step {
    /// The rectangle at a part of the step, 0 to 1.
    pub fn rectangle(&self, part: f64) -> Rectangle {
        let axis = if self.from_axis == self.to_axis {
            self.from_axis
        } else {
            (self.from_axis + (self.to_axis - self.from_axis) * part).normalize()
        };
        Rectangle::behind(self.from + (self.to - self.from) * part, axis, self.length, self.width)
    }

    /// A convex outline around the area that the step covers.
    pub fn hull(&self) -> Outline {
        let by = self.to - self.from;
        let ahead = by.dot(&self.from_axis);
        if self.from_axis == self.to_axis && ahead >= 0.0 && cross(&self.from_axis, &by).abs() <= STRAIGHT {
            let covered = Rectangle::behind(self.to, self.from_axis, self.length + ahead, self.width);
            return Outline::rectangle(&covered);
        }
        Outline::hull(&self.rectangle(0.0), &self.rectangle(1.0))
    }

    /// How far the hull reaches beyond what the step covers: on the inner side of a turn it cuts the corner between
    /// the sides of the first and the last rectangle.
    fn excess(&self) -> Metre {
        (self.to_axis - self.from_axis).norm() * self.length / 4.0
    }

    /// The part of this step at which its rectangle first touches the area that another step covers.
    pub fn first_touch(&self, other: &Self) -> Option<f64> {
        self.touch(other, Self::enter, f64::min)
    }

    /// The part of this step at which its rectangle touches the area that another step covers last; above 1 where it
    /// still does at the end, none if it never does.
    pub fn last_touch(&self, other: &Self) -> Option<f64> {
        self.touch(other, Self::leave, f64::max)
    }

    /// The other's hull decides quickly where they do not touch; where they do, the hull is cut in halves until it fits.
    fn touch(
        &self,
        other: &Self,
        of_hull: fn(&Self, &Outline) -> Option<f64>,
        choose: fn(f64, f64) -> f64,
    ) -> Option<f64> {
        if !self.bounds().meet(&other.bounds()) {
            return None;
        }
        let part = of_hull(self, &other.hull())?;
        if other.excess() <= TOLERANCE {
            return Some(part);
        }
        let halves = [other.between(0.0, 0.5), other.between(0.5, 1.0)];
        halves.iter().filter_map(|half| self.touch(half, of_hull, choose)).reduce(choose)
    }

    /// The same step between two of its parts.
    fn between(&self, start: f64, end: f64) -> Self {
        let (first, last) = (self.rectangle(start), self.rectangle(end));
        Self {
            from: self.from + (self.to - self.from) * start,
            from_axis: first.axis,
            to: self.from + (self.to - self.from) * end,
            to_axis: last.axis,
            ..*self
        }
    }

    /// How far turning takes a corner from where a translation in the middle's direction would take it.
    fn bend(&self) -> Metre {
        (self.to_axis - self.from_axis).norm() * (self.length + self.width) / 2.0
    }

    /// The part of the step at which the moving rectangle first touches a fixed outline; none if it does not.
    pub fn enter(&self, fixed: &Outline) -> Option<f64> {
        self.enter_within(fixed, &fixed.bounds())
    }

    fn enter_within(&self, fixed: &Outline, bounds: &Bounds) -> Option<f64> {
        if self.bend() <= TOLERANCE {
            return self.as_translation(fixed).map(|contact| contact.enter);
        }
        if self.misses(fixed, bounds) {
            return None;
        }
        let first = self.between(0.0, 0.5).enter_within(fixed, bounds).map(|enter| enter / 2.0);
        first.or_else(|| self.between(0.5, 1.0).enter_within(fixed, bounds).map(|enter| 0.5 + enter / 2.0))
    }

    /// The part of the step at which the moving rectangle touches a fixed outline last; above 1 where it still does
    /// at the end, none if it never does.
    pub fn leave(&self, fixed: &Outline) -> Option<f64> {
        self.leave_within(fixed, &fixed.bounds())
    }

    fn leave_within(&self, fixed: &Outline, bounds: &Bounds) -> Option<f64> {
        if self.bend() <= TOLERANCE {
            return self.as_translation(fixed).map(|contact| contact.leave);
        }
        if self.misses(fixed, bounds) {
            return None;
        }
        let second = self.between(0.5, 1.0).leave_within(fixed, bounds).map(|leave| 0.5 + leave / 2.0);
        second.or_else(|| self.between(0.0, 0.5).leave_within(fixed, bounds).map(|leave| (leave / 2.0).min(0.5)))
    }

    /// A step that hardly turns, as a translation of the rectangle in its middle.
    fn as_translation(&self, fixed: &Outline) -> Option<Contact> {
        let middle = self.rectangle(0.5);
        let by = self.to - self.from;
        let start = Rectangle { centre: middle.centre - by * 0.5, ..middle };
        translation(&Outline::rectangle(&start), &by, fixed)
    }

    /// Whether the step stays clear of a fixed outline: by the boxes around both, then by the hull.
    fn misses(&self, fixed: &Outline, bounds: &Bounds) -> bool {
        !self.bounds().meet(bounds) || translation(&self.hull(), &Vector::zeros(), fixed).is_none()
    }

    /// The box around the area that the step covers.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = self.rectangle(0.0).bounds();
        bounds.join(&self.rectangle(1.0).bounds());
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x: f64, y: f64, heading: f64) -> Outline {
        Outline::rectangle(&Rectangle::new(Point::new(x, y), heading, 4.0, 2.0))
    }

    #[test]
    fn a_follower_touches_after_the_room_between_the_bumpers() {
        let contact =
            translation(&rectangle(0.0, 0.0, 0.0), &Vector::new(10.0, 0.0), &rectangle(9.0, 0.0, 0.0)).unwrap();
        assert!((contact.enter - 0.5).abs() < 1e-12);
    }

    #[test]
    fn it_leaves_when_its_rear_has_passed() {
        let contact =
            translation(&rectangle(0.0, 0.0, 0.0), &Vector::new(20.0, 0.0), &rectangle(9.0, 0.0, 0.0)).unwrap();
        assert!((contact.leave - 13.0 / 20.0).abs() < 1e-12);
    }

    #[test]
    fn passing_beside_is_no_contact() {
        assert_eq!(translation(&rectangle(0.0, 0.0, 0.0), &Vector::new(20.0, 0.0), &rectangle(9.0, 2.01, 0.0)), None);
    }

    #[test]
    fn who_touches_already_enters_at_once() {
        let contact = translation(&rectangle(0.0, 0.0, 0.0), &Vector::zeros(), &rectangle(1.0, 0.0, 1.0)).unwrap();
        assert_eq!(contact.enter, 0.0);
    }

    #[test]
    fn a_turning_rectangle_touches_where_sampling_says_it_does() {
        let step = Step {
            from: Point::new(0.0, 0.0),
            from_axis: Vector::new(1.0, 0.0),
            to: Point::new(3.0, 0.5),
            to_axis: Vector::new(0.8, 0.6),
            length: 8.0,
            width: 2.0,
        };
        let fixed = Outline::rectangle(&Rectangle::new(Point::new(-3.0, -2.5), 0.0, 1.0, 1.0));
        let found = step.enter(&fixed).unwrap();
        let touching =
            |part| translation(&Outline::rectangle(&step.rectangle(part)), &Vector::zeros(), &fixed).is_some();
        let sampled = (0..=10_000).map(|i| f64::from(i) / 10_000.0).find(|&part| touching(part)).unwrap();
        assert!((found - sampled).abs() < 0.01, "{found} against {sampled}");
    }
}
