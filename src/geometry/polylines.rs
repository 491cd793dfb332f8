//! Lines on the ground, all in one table: the points of each, and the way to them from where their line begins.

use super::{Point, Vector};
use crate::util::units::Metre;

/// What is nearer than this to a line is on it, in m.
pub(crate) const ON_THE_LINE: Metre = 1e-3;

/// A point of a line and the way to it from the line's beginning.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Where it is.
    pub point: Point,
    /// Along the line, in m.
    pub way: Metre,
}

/// Lines, numbered from 0, each with its corners one after the other.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    corners: Vec<Corner>,
    /// By line, its first corner; then where the last line ends.
    begins: Vec<u32>,
}

impl Lines {
    /// No lines.
    pub const NONE: &'static Self = &Self { corners: Vec::new(), begins: Vec::new() };

    /// One line through these points.
    pub fn through(points: impl IntoIterator<Item = Point>) -> Self {
        let mut lines = Self::default();
        lines.begin();
        points.into_iter().for_each(|point| lines.push(point));
        lines
    }

    /// Begins another line.
    pub fn begin(&mut self) {
        let end = self.corners.len() as u32;
        if self.begins.is_empty() {
            self.begins.push(end);
        }
        self.begins.push(end);
    }

    /// Appends a point to the last line; one that repeats the one before, within a millimetre, is left out.
    pub fn push(&mut self, point: Point) {
        let [.., begin, end] = &mut self.begins[..] else { return };
        let way = match self.corners[*begin as usize..].last() {
            Some(last) => {
                let step = (point - last.point).norm();
                if step < ON_THE_LINE {
                    return;
                }
                last.way + step
            }
            None => 0.0,
        };
        self.corners.push(Corner { point, way });
        *end += 1;
    }

    /// Takes the memory for so many further points, no more.
    pub(crate) fn reserve(&mut self, points: usize) {
        self.corners.reserve_exact(points);
    }

    /// Gives back what memory is not needed.
    pub(crate) fn shrink(&mut self) {
        self.corners.shrink_to_fit();
        self.begins.shrink_to_fit();
    }

    /// How many lines there are.
    pub fn count(&self) -> u32 {
        self.begins.len().saturating_sub(1) as u32
    }

    /// How many corners all lines have.
    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// Where the corners of a line are.
    pub(crate) fn range(&self, line: u32) -> (u32, u32) {
        (self.begins[line as usize], self.begins[line as usize + 1])
    }

    /// The corners of a line.
    pub fn line(&self, line: u32) -> &[Corner] {
        let (begin, end) = self.range(line);
        &self.corners[begin as usize..end as usize]
    }

    /// How long a line is.
    pub fn length(&self, line: u32) -> Metre {
        self.line(line).last().map_or(0.0, |last| last.way)
    }

    /// Whether one line goes on exactly where another ends.
    pub(crate) fn join(&self, line: u32, next: u32) -> bool {
        match (self.line(line), self.line(next)) {
            ([_, .., end], [begin, _, ..]) => end.point == begin.point,
            _ => false,
        }
    }

    /// The part of a line that begins at this corner, which is not the line's last.
    pub(crate) fn segment(&self, corner: u32) -> Segment {
        Segment::between(&self.corners[corner as usize], &self.corners[corner as usize + 1])
    }

    /// Drops so many corners of the only line, which then begins at the next; returns the way that was cut off.
    pub(crate) fn cut(&mut self, corners: usize) -> Metre {
        self.corners.drain(..corners);
        self.begins[1] = self.corners.len() as u32;
        let shift = self.corners.first().map_or(0.0, |first| first.way);
        self.corners.iter_mut().for_each(|corner| corner.way -= shift);
        shift
    }
}

/// The part of a line between two corners.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub start: Point,
    pub direction: Vector,
    /// The way from the line's beginning to its start.
    pub way: Metre,
    /// The same to its end.
    pub end: Metre,
}

impl Segment {
    #[inline]
    fn between(start: &Corner, end: &Corner) -> Self {
        let length = end.way - start.way;
        Self { start: start.point, direction: (end.point - start.point) / length, way: start.way, end: end.way }
    }

    /// The way from the line's beginning to a front bumper, if that is on this segment.
    pub fn way_to(&self, front: Point) -> Option<Metre> {
        let along = (front - self.start).dot(&self.direction);
        let aside = (front - (self.start + self.direction * along)).norm_squared();
        let is_on = along <= self.end - self.way && along >= -ON_THE_LINE && aside <= ON_THE_LINE * ON_THE_LINE;
        is_on.then_some(self.way + along.max(0.0))
    }

    /// The place at a way from the line's beginning; before this segment and beyond it, straight on.
    pub fn at(&self, way: Metre) -> Point {
        self.start + self.direction * (way - self.way)
    }
}
