//! When a convex shape that moves in a straight line touches another: closed form, by separating axes.
//!
//! On each edge normal the two projections overlap during one interval of the distance; the shapes touch where all
//! intervals overlap (the swept form of the separating-axes test; Eberly, "Dynamic collision detection using oriented
//! bounding boxes").

use super::convex::{ConvexOutline, UNSURE};
use super::rectangle::Rectangle;
use super::{Vector, cross, left_of};
use crate::util::units::Metre;

/// Which contact a query looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contact {
    /// Where two outlines begin to touch.
    Entry,
    /// Where two outlines touch last; 1 or more where they still touch at the end.
    Exit,
}

impl Contact {
    /// Stands for no contact: worse than every contact.
    pub fn none(self) -> f64 {
        match self {
            Self::Entry => f64::INFINITY,
            Self::Exit => f64::NEG_INFINITY,
        }
    }

    /// Whether no place on a movement can be better than this one.
    pub(super) fn is_best(self, part: f64) -> bool {
        match self {
            Self::Entry => part <= 0.0,
            Self::Exit => part >= 1.0,
        }
    }

    pub(super) fn better(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Entry => a.min(b),
            Self::Exit => a.max(b),
        }
    }

    /// The halves of a movement in the order in which they are searched.
    pub(super) fn halves(self) -> [u32; 2] {
        match self {
            Self::Entry => [0, 1],
            Self::Exit => [1, 0],
        }
    }
}

/// The part of a movement, 0 at its beginning and 1 at its end, during which two outlines touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactInterval {
    /// Where they begin to touch.
    pub enter: f64,
    /// Where they touch last; above 1 where they still touch at the end.
    pub leave: f64,
}

impl ContactInterval {
    /// One end of the interval.
    pub fn at(&self, which: Contact) -> f64 {
        match which {
            Contact::Entry => self.enter,
            Contact::Exit => self.leave,
        }
    }
}

/// The contact of `moving`, displaced by `by`, with `fixed`; none if they never touch.
pub fn translation(moving: &ConvexOutline, by: &Vector, fixed: &ConvexOutline) -> Option<ContactInterval> {
    let mut contact = ContactInterval { enter: 0.0, leave: f64::INFINITY };
    for normal in [moving, fixed].into_iter().flat_map(ConvexOutline::normals) {
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

/// Whether two outlines share a point; touching counts.
pub(crate) fn outlines_touch(a: &ConvexOutline, b: &ConvexOutline) -> bool {
    let room = a.room_to(b, -UNSURE, UNSURE);
    if room.abs() > UNSURE {
        return room < 0.0;
    }
    translation(a, &Vector::zeros(), b).is_some()
}

/// [`translation`] for two rectangles.
///
/// The four normals are the axes of the two rectangles, so only the products of these axes are needed, as in
/// `geometry::exact`. Measured (`cargo bench --bench library`): 21 ns; by their outlines, 58 ns.
pub fn slide(moving: &Rectangle, by: &Vector, fixed: &Rectangle) -> Option<ContactInterval> {
    let between = fixed.centre - moving.centre;
    // Entry and, negated, exit: the same operations on both, so that the compiler vectorises them.
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
            // Compiles to one instruction, unlike `f64::max`, which also handles NaN, and no value here is NaN.
            *last = if at > *last { at } else { *last };
        }
    }
    let contact = ContactInterval { enter: last[0], leave: -last[1] };
    (contact.enter <= contact.leave && contact.enter <= 1.0).then_some(contact)
}

/// The four normals that can separate two rectangles, each with the distance of the centres along it at contact.
pub fn normals(a: &Rectangle, b: &Rectangle) -> [(Vector, Metre); 4] {
    let (cosine, sine) = (a.axis.dot(&b.axis).abs(), cross(&a.axis, &b.axis).abs());
    let along = |a: &Rectangle, b: &Rectangle| a.half_length + b.half_length * cosine + b.half_width * sine;
    let across = |a: &Rectangle, b: &Rectangle| a.half_width + b.half_length * sine + b.half_width * cosine;
    [(a.axis, along(a, b)), (left_of(&a.axis), across(a, b)), (b.axis, along(b, a)), (left_of(&b.axis), across(b, a))]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::Point;

    fn rectangle(x: f64, y: f64, heading: f64) -> ConvexOutline {
        ConvexOutline::rectangle(&Rectangle::new(Point::new(x, y), heading, 4.0, 2.0))
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
    fn passing_beside_is_not_a_contact() {
        assert_eq!(translation(&rectangle(0.0, 0.0, 0.0), &Vector::new(20.0, 0.0), &rectangle(9.0, 2.01, 0.0)), None);
    }

    #[test]
    fn rectangles_that_touch_already_enter_at_once() {
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
            let outlines = translation(&ConvexOutline::rectangle(&moving), &by, &ConvexOutline::rectangle(&fixed));
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
}
