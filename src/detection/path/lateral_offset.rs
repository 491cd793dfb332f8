//! A line beside the lanes' centre line: the path of a road user that keeps to one side or changes lanes.

use crate::geometry::polylines::Lines;
use crate::geometry::{Point, Vector, left_of};
use crate::util::units::Metre;

/// Lateral offset from the centre line, positive to the left: `now` at distance 0, changing evenly to `target` over a
/// distance of `over`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Offset {
    pub now: Metre,
    pub target: Metre,
    pub over: Metre,
}

impl Offset {
    fn at(&self, distance: Metre) -> Metre {
        if distance <= 0.0 || self.over <= 0.0 {
            self.now
        } else {
            self.now + (self.target - self.now) * (distance / self.over).min(1.0)
        }
    }
}

/// Builds a line beside the centre line from the points of the latter, in driving order.
#[derive(Clone, Debug)]
pub(super) struct OffsetLine {
    offset: Offset,
    /// The last two points of the centre line. The vertex beside the last one depends on the next point.
    before: Option<Point>,
    last: Option<Point>,
    /// Distance of the last point along the centre line, from where the front bumper was when the line was begun.
    distance: Metre,
}

impl OffsetLine {
    /// None if the line is the centre line itself.
    pub fn new(offset: Offset) -> Option<Self> {
        let is_aside = offset.now != 0.0 || offset.target != 0.0;
        is_aside.then_some(Self { offset, before: None, last: None, distance: f64::NEG_INFINITY })
    }

    /// The offset where the line was begun.
    pub fn aside(&self) -> Metre {
        self.offset.now
    }

    /// Adds the next point of the centre line behind the front bumper.
    pub fn push_behind(&mut self, line: &mut Lines, point: Point) {
        self.push(line, point, f64::NEG_INFINITY);
    }

    /// Adds the point of the centre line beside the front bumper.
    pub fn push_front(&mut self, line: &mut Lines, point: Point) {
        self.distance = 0.0;
        self.push(line, point, 0.0);
    }

    /// Adds the next point of the centre line ahead.
    pub fn push_ahead(&mut self, line: &mut Lines, point: Point) {
        let distance = self.distance + self.last.map_or(0.0, |last| (point - last).norm());
        // A changing offset needs a vertex where the change ends.
        if self.distance < self.offset.over
            && self.offset.over < distance
            && let Some(last) = self.last
        {
            let part = (self.offset.over - self.distance) / (distance - self.distance);
            self.push(line, last + (point - last) * part, self.offset.over);
        }
        self.push(line, point, distance);
    }

    /// Adds a point of the centre line, and the vertex beside the point before.
    fn push(&mut self, line: &mut Lines, point: Point, distance: Metre) {
        if self.last.is_some_and(|last| (point - last).norm() < 1e-3) {
            return;
        }
        if let (Some(before), Some(last)) = (self.before, self.last) {
            line.push(last + miter(&(last - before), &(point - last)) * self.offset.at(self.distance));
        } else if let Some(first) = self.last {
            let normal = left_of(&(point - first).try_normalize(0.0).unwrap_or_else(Vector::x));
            line.push(first + normal * self.offset.at(self.distance));
        }
        self.before = self.last.replace(point);
        self.distance = distance;
    }

    /// Adds the vertex beside the last point of the centre line, for as long as no further point is known.
    pub fn flush(&self, line: &mut Lines) {
        if let (Some(before), Some(last)) = (self.before, self.last) {
            let normal = left_of(&(last - before).try_normalize(0.0).unwrap_or_else(Vector::x));
            line.push(last + normal * self.offset.at(self.distance));
        }
    }
}

/// The shift of the vertex between two segments of a line, for an offset of 1 to the left.
fn miter(before: &Vector, after: &Vector) -> Vector {
    /// Longest shift: the miter of a sharp corner would lie far away.
    const LONGEST: f64 = 2.0;
    let (a, b) = (left_of(&before.normalize()), left_of(&after.normalize()));
    let sum = a + b;
    let length = 2.0 / sum.norm_squared().max(1e-12);
    (sum * length).cap_magnitude(LONGEST)
}
