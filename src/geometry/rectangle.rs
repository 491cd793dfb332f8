//! The rectangle that a road user covers.

use std::f64::consts::FRAC_PI_2;

use super::{Bounds, Point, Vector, cross, left_of};
use crate::util::units::{Metre, Radian};

/// A rectangle that may stand at any angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Its centre.
    pub centre: Point,
    /// Unit vector from the rear to the front.
    pub axis: Vector,
    /// Half the length, along the axis, in m.
    pub half_length: Metre,
    /// Half the width, across the axis, in m.
    pub half_width: Metre,
}

impl Rectangle {
    /// A rectangle around a centre.
    pub fn new(centre: Point, heading: Radian, length: Metre, width: Metre) -> Self {
        Self { centre, axis: direction(heading), half_length: length / 2.0, half_width: width / 2.0 }
    }

    /// The rectangle behind a front-bumper centre: SUMO's reference point.
    pub fn behind(front: Point, axis: Vector, length: Metre, width: Metre) -> Self {
        let half_length = length / 2.0;
        Self { centre: front - axis * half_length, axis, half_length, half_width: width / 2.0 }
    }

    /// The corners counter-clockwise: front left, rear left, rear right, front right.
    pub fn corners(&self) -> [Point; 4] {
        let along = self.axis * self.half_length;
        let across = left_of(&self.axis) * self.half_width;
        [
            self.centre + along + across,
            self.centre - along + across,
            self.centre - along - across,
            self.centre + along - across,
        ]
    }

    /// The rectangle along the same axis around the area that this one covers while it moves `by` without turning,
    /// larger by `margin` on every side.
    pub fn swept(&self, by: &Vector, margin: Metre) -> Self {
        Self {
            centre: self.centre + by / 2.0,
            half_length: self.half_length + by.dot(&self.axis).abs() / 2.0 + margin,
            half_width: self.half_width + cross(&self.axis, by).abs() / 2.0 + margin,
            ..*self
        }
    }

    /// The smallest rectangle along `axis` around all `parts`, larger by `margin` on every side; none without parts.
    pub fn around(axis: Vector, parts: impl IntoIterator<Item = Self>, margin: Metre) -> Option<Self> {
        let mut parts = parts.into_iter();
        let first = parts.next()?;
        // Relative to the first centre, so that nothing cancels far from the origin.
        let extent = |part: &Self, direction: &Vector| {
            let (middle, reach) = ((part.centre - first.centre).dot(direction), reach(part, direction));
            (middle - reach, middle + reach)
        };
        let across = left_of(&axis);
        let (mut along, mut aside) = (extent(&first, &axis), extent(&first, &across));
        for part in parts {
            let (low, high) = extent(&part, &axis);
            along = (along.0.min(low), along.1.max(high));
            let (low, high) = extent(&part, &across);
            aside = (aside.0.min(low), aside.1.max(high));
        }
        Some(Self {
            centre: first.centre + axis * ((along.0 + along.1) / 2.0) + across * ((aside.0 + aside.1) / 2.0),
            axis,
            half_length: (along.1 - along.0) / 2.0 + margin,
            half_width: (aside.1 - aside.0) / 2.0 + margin,
        })
    }

    /// The axis-parallel box around it.
    pub fn bounds(&self) -> Bounds {
        let reach = Vector::new(
            self.axis.x.abs() * self.half_length + self.axis.y.abs() * self.half_width,
            self.axis.y.abs() * self.half_length + self.axis.x.abs() * self.half_width,
        );
        Bounds { low: self.centre - reach, high: self.centre + reach }
    }
}

impl From<Bounds> for Rectangle {
    fn from(bounds: Bounds) -> Self {
        let half = (bounds.high - bounds.low) / 2.0;
        Self { centre: bounds.low + half, axis: Vector::x(), half_length: half.x, half_width: half.y }
    }
}

/// The directions of 0, 1, 2 and 3 quarter turns.
const ALONG_AXES: [Vector; 4] =
    [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0), Vector::new(-1.0, 0.0), Vector::new(0.0, -1.0)];

/// The unit vector of a heading; exact for the four directions along the axes.
pub fn direction(heading: Radian) -> Vector {
    let quarters = heading / FRAC_PI_2;
    let whole = quarters as i64;
    if whole as f64 == quarters {
        return ALONG_AXES[whole.rem_euclid(4) as usize];
    }
    let (sine, cosine) = heading.sin_cos();
    Vector::new(cosine, sine)
}

/// How far a rectangle reaches from its centre along a direction.
fn reach(rectangle: &Rectangle, direction: &Vector) -> Metre {
    rectangle.axis.dot(direction).abs() * rectangle.half_length
        + left_of(&rectangle.axis).dot(direction).abs() * rectangle.half_width
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_corner_is_the_front_left_one() {
        let car = Rectangle::new(Point::new(2.5, 0.0), 0.0, 5.0, 1.8);
        assert_eq!(car.corners()[0], Point::new(5.0, 0.9));
    }

    #[test]
    fn the_directions_along_the_axes_are_exact_no_others_are() {
        for turns in -1..=1 {
            for (quarters, (x, y)) in [(0, (1.0, 0.0)), (1, (0.0, 1.0)), (2, (-1.0, 0.0)), (3, (0.0, -1.0))] {
                let (heading, axis) = (f64::from(4 * turns + quarters) * FRAC_PI_2, Vector::new(x, y));
                assert_eq!(direction(heading), axis, "{turns} turns and {quarters} quarters");
                let beside = direction(heading + 1e-9);
                assert!(beside != axis && (beside - axis).norm() < 2e-9, "beside {heading}: {beside}");
            }
        }
    }
}
