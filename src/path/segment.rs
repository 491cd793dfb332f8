//! One straight part of a line.

use crate::geometry::{Point, Vector};
use crate::units::Metre;

/// How far from the line a front bumper may be found and still be on it, in m.
pub(super) const ON_THE_LINE: Metre = 1e-3;

/// A point of the line and the way to it from the line's beginning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub point: Point,
    pub way: Metre,
}

/// The part of the line between two points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Segment {
    pub start: Point,
    pub direction: Vector,
    /// 0 where there is none.
    pub length: Metre,
    /// The way from the line's beginning to its start.
    pub way: Metre,
}

impl Segment {
    pub fn between(start: &Corner, end: &Corner) -> Self {
        let length = end.way - start.way;
        Self { start: start.point, direction: (end.point - start.point) / length, length, way: start.way }
    }

    /// The way from the line's beginning to a front bumper, if that is on this segment.
    pub fn way_to(&self, front: Point) -> Option<Metre> {
        let along = (front - self.start).dot(&self.direction);
        let aside = (front - (self.start + self.direction * along)).norm_squared();
        let is_on = along <= self.length && along >= -ON_THE_LINE && aside <= ON_THE_LINE * ON_THE_LINE;
        is_on.then_some(self.way + along.max(0.0))
    }

    /// The place at a way from the line's beginning; before this segment and beyond it, straight on.
    pub fn at(&self, way: Metre) -> Point {
        self.start + self.direction * (way - self.way)
    }
}
