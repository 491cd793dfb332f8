//! Conversion between our types and parry2d's.

use parry2d_f64::math::{Pose, Rotation, Vector as ParryVector};
use parry2d_f64::shape::Cuboid;

use super::Point;
use super::rectangle::Rectangle;

/// The rectangle as parry2d's shape and its pose.
pub fn cuboid(rectangle: &Rectangle) -> (Pose, Cuboid) {
    let axis = rectangle.axis;
    let pose = Pose { rotation: Rotation { re: axis.x, im: axis.y }, translation: vector(rectangle.centre) };
    (pose, Cuboid::new(ParryVector::new(rectangle.half_length, rectangle.half_width)))
}

/// The point as parry2d's vector.
pub(crate) fn vector(point: Point) -> ParryVector {
    ParryVector::new(point.x, point.y)
}

/// parry2d's vector as our point.
pub(crate) fn point(vector: ParryVector) -> Point {
    Point::new(vector.x, vector.y)
}
