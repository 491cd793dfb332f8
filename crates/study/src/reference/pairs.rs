//! Pairs of rectangles for which contact is hard to decide.

use super::chance::Chance;
use closecall::detection::path::rotated;
use closecall::geometry::rectangle::Rectangle;
use closecall::geometry::{Point, left_of};

/// A road user of any size within 100 m of the origin along each axis.
pub fn car(chance: &mut Chance) -> Rectangle {
    let place = Point::new(chance.between(-100.0, 100.0), chance.between(-100.0, 100.0));
    Rectangle::new(place, chance.angle(), chance.between(0.5, 20.0), chance.between(0.3, 3.0))
}

/// Two cars that are a few metres apart or overlap.
pub fn random(chance: &mut Chance) -> (Rectangle, Rectangle) {
    let place = |chance: &mut Chance| Point::new(chance.between(0.0, 12.0), chance.between(0.0, 12.0));
    let a = Rectangle::new(place(chance), chance.angle(), 5.0, 1.8);
    (a, Rectangle::new(place(chance), chance.angle(), chance.between(1.0, 12.0), 2.5))
}

/// Two rectangles at any angle that touch to within a few units in the last place.
pub fn touching(chance: &mut Chance) -> (Rectangle, Rectangle) {
    let a = car(chance);
    let turn = chance.angle();
    (a, beside(chance, &a, turn))
}

/// Two touching rectangles whose headings differ by 0 to 1e-8 rad.
pub(crate) fn nearly_parallel(chance: &mut Chance) -> (Rectangle, Rectangle) {
    let a = car(chance);
    let turn = chance.pick(&[0.0, 1e-16, 1e-12, 1e-8]);
    (a, beside(chance, &a, turn))
}

/// A rectangle within the front of another.
pub(crate) fn nested(chance: &mut Chance) -> (Rectangle, Rectangle) {
    let a = car(chance);
    let share = chance.magnitude(1e-9, 1.0);
    let b = Rectangle {
        centre: a.centre + a.axis * (a.half_length * (1.0 - share)),
        half_length: a.half_length * share,
        half_width: a.half_width * share,
        ..a
    };
    (a, b)
}

/// Two long rectangles that cross, mostly without a corner of one in the other.
pub fn cross(chance: &mut Chance) -> (Rectangle, Rectangle) {
    let a = Rectangle { half_length: 50.0, ..car(chance) };
    let axis = rotated(&left_of(&a.axis), chance.between(-0.5, 0.5));
    (a, Rectangle { axis, centre: a.centre + a.axis * chance.between(-60.0, 60.0), ..a })
}

/// A turned copy that touches the rectangle's front to within a few units in the last place.
pub fn beside(chance: &mut Chance, a: &Rectangle, turn: f64) -> Rectangle {
    let axis = rotated(&a.axis, turn);
    against(chance, a, Rectangle { axis, ..*a })
}

/// The second, moved until it touches the front of the first to within a few units in the last place.
pub fn against(chance: &mut Chance, a: &Rectangle, b: Rectangle) -> Rectangle {
    let reach =
        a.half_length + b.half_length * a.axis.dot(&b.axis).abs() + b.half_width * a.axis.dot(&left_of(&b.axis)).abs();
    let aside = a.half_width * chance.between(-1.0, 1.0);
    let centre = a.centre + a.axis * reach + left_of(&a.axis) * aside;
    let nudge = |chance: &mut Chance, value: f64| value + value.abs() * f64::EPSILON * f64::from(chance.around(4));
    Rectangle { centre: Point::new(nudge(chance, centre.x), nudge(chance, centre.y)), ..b }
}
