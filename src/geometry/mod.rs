//! Rectangles, convex outlines, and where moving ones touch.
//!
//! Vectors and points are nalgebra's. parry2d serves where it is fast enough ([`polygon::distance`],
//! [`polygon::convex_parts`]); the conversion to its types is in `parry.rs` alone.

pub mod bisection;
pub mod bow;
pub mod contact;
pub mod convex;
pub mod exact;
pub mod movement;
pub mod outline;
pub mod parry;
pub mod polygon;
pub mod polylines;
pub mod rectangle;
pub mod separating_axes;
mod swept_part;

use nalgebra::{Point2, Vector2};

use crate::util::units::{Metre, Radian};

/// A place in the plane, in m.
pub type Point = Point2<Metre>;
/// A direction or displacement in the plane.
pub type Vector = Vector2<Metre>;

/// An axis-parallel box: compared before anything costlier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest x and y.
    pub low: Point,
    /// Largest x and y.
    pub high: Point,
}

impl Bounds {
    /// Bounds that hold nothing yet.
    pub const EMPTY: Self =
        Self { low: Point::new(f64::INFINITY, f64::INFINITY), high: Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY) };

    /// Bounds that hold the whole plane.
    pub(crate) const EVERYTHING: Self = Self { low: Self::EMPTY.high, high: Self::EMPTY.low };

    /// Whether nothing is within these bounds.
    pub fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    /// Extent along x and y.
    pub fn size(&self) -> Vector {
        self.high - self.low
    }

    /// Grows to hold a point.
    pub fn include(&mut self, point: Point) {
        self.low = self.low.inf(&point);
        self.high = self.high.sup(&point);
    }

    /// Grows to hold other bounds.
    pub fn join(&mut self, other: &Self) {
        self.low = self.low.inf(&other.low);
        self.high = self.high.sup(&other.high);
    }

    /// Whether it holds a point.
    pub fn holds(&self, point: Point) -> bool {
        self.meet(&Self { low: point, high: point })
    }

    /// Whether the two share a point.
    pub fn meet(&self, other: &Self) -> bool {
        // All four without a branch: which of them fails is unpredictable.
        (self.low.x <= other.high.x)
            & (other.low.x <= self.high.x)
            & (self.low.y <= other.high.y)
            & (other.low.y <= self.high.y)
    }

    /// The intersection; none if the two do not meet.
    pub(crate) fn shared_with(&self, other: &Self) -> Option<Self> {
        self.meet(other).then(|| Self { low: self.low.sup(&other.low), high: self.high.inf(&other.high) })
    }

    /// The same, larger by `margin` on every side.
    pub fn grown(&self, margin: Metre) -> Self {
        let by = Vector::new(margin, margin);
        Self { low: self.low - by, high: self.high + by }
    }
}

/// The cross product's z: positive where `b` lies to the left of `a`.
pub fn cross(a: &Vector, b: &Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

/// The direction a quarter turn to the left.
pub fn left_of(direction: &Vector) -> Vector {
    Vector::new(-direction.y, direction.x)
}

/// The angle between two directions, 0 to π.
pub(crate) fn angle_between(a: &Vector, b: &Vector) -> Radian {
    let (across, along) = (cross(a, b).abs(), a.dot(b));
    // As atan2 would return, but without calling it: most followers have exactly the heading of their leader.
    if across == 0.0 && along > 0.0 { 0.0 } else { across.atan2(along) }
}
