//! The area that a road user may cover until it stands.

use crate::geometry::{Bounds, Point, Vector};
use crate::util::units::Metre;

/// Holds all that a road user may cover until it stands, whichever way it turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre, x.
    pub x: Metre,
    /// Centre, y.
    pub y: Metre,
    /// Radius: own stopping distance + half diagonal + ε.
    pub radius: Metre,
}

/// A road user stays within the box, and within the circle around the box's middle, until it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// The box.
    pub bounds: Bounds,
    /// The circle's radius; infinite where the box alone decides.
    pub radius: Metre,
}

impl Area {
    /// Whether the circle cuts the corners of the box.
    pub(crate) fn is_round(&self) -> bool {
        self.radius < f64::INFINITY
    }

    /// Whether two areas meet.
    pub fn meets(&self, other: &Self) -> bool {
        self.bounds.meet(&other.bounds) && self.circles_meet(other)
    }

    /// Whether the circles of two areas meet; only of use where their boxes do.
    pub(crate) fn circles_meet(&self, other: &Self) -> bool {
        let (middle, other_middle) = (self.middle(), other.middle());
        let reach = self.radius + other.radius;
        (middle - other_middle).norm_squared() <= reach * reach
    }

    fn middle(&self) -> Point {
        self.bounds.low + self.bounds.size() / 2.0
    }
}

impl From<Circle> for Area {
    fn from(circle: Circle) -> Self {
        let (middle, reach) = (Point::new(circle.x, circle.y), Vector::new(circle.radius, circle.radius));
        Self { bounds: Bounds { low: middle - reach, high: middle + reach }, radius: circle.radius }
    }
}

impl From<Bounds> for Area {
    fn from(bounds: Bounds) -> Self {
        Self { bounds, radius: f64::INFINITY }
    }
}
