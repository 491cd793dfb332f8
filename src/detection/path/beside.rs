//! The line beside the centre line of lanes: where somebody drives who keeps to one side, or changes to another.

use crate::geometry::polylines::Lines;
use crate::geometry::{Point, Vector, left_of};
use crate::util::units::Metre;

/// Lateral offset from the centre line, to the left: `now` at way 0, changing evenly to `target` over `over`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Offset {
    pub now: Metre,
    pub target: Metre,
    pub over: Metre,
}

impl Offset {
    fn at(&self, way: Metre) -> Metre {
        if way <= 0.0 || self.over <= 0.0 {
            self.now
        } else {
            self.now + (self.target - self.now) * (way / self.over).min(1.0)
        }
    }
}

/// Lays a line beside the centre line, whose points it is given one after the other.
#[derive(Clone, Debug)]
pub(super) struct Beside {
    offset: Offset,
    /// The last two points of the centre line: the offset line's corner between them waits for the next.
    before: Option<Point>,
    last: Option<Point>,
    /// Way along the centre line up to the last of them, from the front bumper at laying.
    way: Metre,
}

impl Beside {
    /// None where it is the centre line itself.
    pub fn new(offset: Offset) -> Option<Self> {
        let is_aside = offset.now != 0.0 || offset.target != 0.0;
        is_aside.then_some(Self { offset, before: None, last: None, way: f64::NEG_INFINITY })
    }

    /// The next point of the centre line that is at or behind the front bumper.
    pub fn push_behind(&mut self, line: &mut Lines, point: Point) {
        self.push(line, point, f64::NEG_INFINITY);
    }

    /// The point of the centre line beside the front bumper.
    pub fn push_front(&mut self, line: &mut Lines, point: Point) {
        self.way = 0.0;
        self.push(line, point, 0.0);
    }

    /// The next point of the centre line ahead.
    pub fn push_ahead(&mut self, line: &mut Lines, point: Point) {
        let way = self.way + self.last.map_or(0.0, |last| (point - last).norm());
        // An offset that changes needs a corner where the change ends.
        if self.way < self.offset.over
            && self.offset.over < way
            && let Some(last) = self.last
        {
            let part = (self.offset.over - self.way) / (way - self.way);
            self.push(line, last + (point - last) * part, self.offset.over);
        }
        self.push(line, point, way);
    }

    /// Adds a point of the centre line; the offset line's corner before it is settled by it.
    fn push(&mut self, line: &mut Lines, point: Point, way: Metre) {
        if self.last.is_some_and(|last| (point - last).norm() < 1e-3) {
            return;
        }
        if let (Some(before), Some(last)) = (self.before, self.last) {
            line.push(last + miter(&(last - before), &(point - last)) * self.offset.at(self.way));
        } else if let Some(first) = self.last {
            let normal = left_of(&(point - first).try_normalize(0.0).unwrap_or_else(Vector::x));
            line.push(first + normal * self.offset.at(self.way));
        }
        self.before = self.last.replace(point);
        self.way = way;
    }

    /// Ends the line beside the last point of the centre line for now.
    pub fn flush(&self, line: &mut Lines) {
        if let (Some(before), Some(last)) = (self.before, self.last) {
            let normal = left_of(&(last - before).try_normalize(0.0).unwrap_or_else(Vector::x));
            line.push(last + normal * self.offset.at(self.way));
        }
    }
}

/// The shift, for an offset of 1 to the left, of the corner between two edges of a line.
fn miter(before: &Vector, after: &Vector) -> Vector {
    /// Sharper corners than this are cut: their miter would lie far away.
    const LONGEST: f64 = 2.0;
    let (a, b) = (left_of(&before.normalize()), left_of(&after.normalize()));
    let sum = a + b;
    let length = 2.0 / sum.norm_squared().max(1e-12);
    (sum * length).cap_magnitude(LONGEST)
}
