//! When a moving convex outline first touches another, and when it leaves it again.
//!
//! Closed form for a translation: on each edge normal the two projections overlap during one interval of the way;
//! they touch where all intervals do (the swept form of the separating-axes test; Eberly, "Dynamic collision
//! detection using oriented bounding boxes"). A turn is cut into translations short enough for [`TOLERANCE`], by
//! [`super::halves`].
//!
//! Measured (`cargo bench --bench library`): 58 ns for a pair of rectangles, parry2d's `cast_shapes` 226 ns; its
//! `cast_shapes_nonlinear`, which would turn too, has no cap on its iterations and was seen not to return.

use super::outline::Outline;
use super::rectangle::Rectangle;
use super::{Point, Vector, cross, left_of};
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
    for normal in [moving, fixed].into_iter().flat_map(Outline::normals) {
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

/// The same of two rectangles.
///
/// All four normals are the axes of both, so that the products of these are all there is to know, as in
/// [`super::exact`]. Measured (`cargo bench --bench library`): 21 ns, 58 by their outlines.
pub fn slide(moving: &Rectangle, by: &Vector, fixed: &Rectangle) -> Option<Contact> {
    let between = fixed.centre - moving.centre;
    // Where they enter and, negated, where they leave: the same operations, so that a processor does both at once.
    let mut last = [0.0, f64::NEG_INFINITY];
    for (normal, reach) in normals(moving, fixed) {
        let (room, speed) = (between.dot(&normal), by.dot(&normal));
        if speed == 0.0 {
            if room.abs() > reach {
                return None;
            }
            continue;
        }
        let ahead = reach.copysign(speed);
        for (last, room) in last.iter_mut().zip([room, -room]) {
            let at = (room - ahead) / speed;
            // One instruction, which `max` is not, and no NaN gets here.
            *last = if at > *last { at } else { *last };
        }
    }
    let contact = Contact { enter: last[0], leave: -last[1] };
    (contact.enter <= contact.leave && contact.enter <= 1.0).then_some(contact)
}

/// The four normals across which two rectangles can be apart, and how far apart their centres are there when they touch.
pub(crate) fn normals(a: &Rectangle, b: &Rectangle) -> [(Vector, Metre); 4] {
    let (cosine, sine) = (a.axis.dot(&b.axis).abs(), cross(&a.axis, &b.axis).abs());
    let along = |a: &Rectangle, b: &Rectangle| a.half_length + b.half_length * cosine + b.half_width * sine;
    let across = |a: &Rectangle, b: &Rectangle| a.half_width + b.half_length * sine + b.half_width * cosine;
    [(a.axis, along(a, b)), (left_of(&a.axis), across(a, b)), (b.axis, along(b, a)), (left_of(&b.axis), across(b, a))]
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

    /// Whether it never turns: it is a translation.
    pub fn slides(&self) -> bool {
        self.from_axis == self.to_axis
    }

    /// The contact of one that never turns with a rectangle that stands.
    pub fn slide_to(&self, fixed: &Rectangle) -> Option<Contact> {
        slide(&self.rectangle(0.0), &(self.to - self.from), fixed)
    }

    /// The rectangle that the step covers, if it leads straight ahead.
    pub fn covered(&self) -> Option<Rectangle> {
        let by = self.to - self.from;
        let ahead = by.dot(&self.from_axis);
        let leads_ahead = self.slides() && ahead >= 0.0 && cross(&self.from_axis, &by).abs() <= STRAIGHT;
        leads_ahead.then(|| Rectangle::behind(self.to, self.from_axis, self.length + ahead, self.width))
    }

    /// A convex outline around the area that the step covers.
    pub fn hull(&self) -> Outline {
        match self.covered() {
            Some(covered) => Outline::rectangle(&covered),
            None => Outline::hull(&self.rectangle(0.0), &self.rectangle(1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::halves::{Halves, Touch};
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

    proptest! {
        #[test]
        fn rectangles_slide_as_their_outlines_do(
            x in -20.0..20.0, y in -20.0..20.0, turn in prop_oneof![Just(0.0), -4.0..4.0], along in -40.0..40.0,
            across in prop_oneof![Just(0.0), -40.0..40.0], heading in prop_oneof![Just(0.0), -4.0..4.0],
        ) {
            let moving = Rectangle::new(Point::new(3e3, -4e3), heading, 5.0, 1.8);
            let fixed = Rectangle::new(Point::new(3e3 + x, -4e3 + y), heading + turn, 12.0, 2.5);
            let by = moving.axis * along + left_of(&moving.axis) * across;
            let found = slide(&moving, &by, &fixed);
            let outlines = translation(&Outline::rectangle(&moving), &by, &Outline::rectangle(&fixed));
            match (found, outlines) {
                (Some(found), Some(outlines)) => {
                    prop_assert!((found.enter - outlines.enter).abs() * by.norm() < 1e-9, "{found:?} {outlines:?}");
                    prop_assert!((found.leave.min(1.0) - outlines.leave.min(1.0)).abs() * by.norm() < 1e-9, "{found:?} {outlines:?}");
                }
                (None, None) => {}
                _ => prop_assert!(false, "{found:?} {outlines:?}"),
            }
        }
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
        let mut halves = Halves::default();
        let part = halves.add(step);
        let found = halves.meet(part, &fixed.into(), Touch::First).unwrap();
        let touching =
            |part| translation(&Outline::rectangle(&step.rectangle(part)), &Vector::zeros(), &fixed).is_some();
        let sampled = (0..=10_000).map(|i| f64::from(i) / 10_000.0).find(|&part| touching(part)).unwrap();
        assert!((found - sampled).abs() < 0.01, "{found} against {sampled}");
    }
}
