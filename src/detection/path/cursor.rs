//! A place that moves along the lines of a track, segment by segment.

use crate::geometry::Point;
use crate::geometry::polylines::{Lines, Segment};
use crate::util::units::Metre;

/// A moving place on a track.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    lines: &'a Lines,
    chain: &'a [u32],
    /// Index of the line that it is on.
    pub at: usize,
    /// The vertices of that line.
    range: (u32, u32),
    /// The last vertex before it.
    pub vertex: u32,
    /// The segment that it is on.
    pub under: Segment,
    /// Distance of the next vertex; infinite on the last segment of the track.
    next: Metre,
    /// Distance along the line that it is on.
    pub distance: Metre,
}

impl<'a> Cursor<'a> {
    /// At a distance along the line at `at` of a chain of lines, behind this vertex.
    #[inline]
    pub fn new(lines: &'a Lines, chain: &'a [u32], at: usize, vertex: u32, distance: Metre) -> Self {
        let under = lines.segment(vertex);
        let range = lines.range(chain[at]);
        let mut cursor = Self { lines, chain, at, range, vertex, under, next: under.ends_at, distance };
        cursor.look_ahead();
        cursor
    }

    /// Its place in the plane; beyond either end of the track, straight on.
    pub fn point(&self) -> Point {
        self.under.at(self.distance)
    }

    /// Distance to the next vertex; negative beyond it.
    #[inline]
    pub fn room(&self) -> Metre {
        self.next - self.distance
    }

    /// Finds the next vertex.
    #[inline]
    fn look_ahead(&mut self) {
        let is_last = self.vertex + 2 == self.range.1 && self.at + 1 == self.chain.len();
        self.next = if is_last { f64::INFINITY } else { self.under.ends_at };
    }

    /// Enters the next segment of the track, if there is one; the place does not change.
    pub(crate) fn enter_next(&mut self) {
        if self.vertex + 2 < self.range.1 {
            self.vertex += 1;
        } else if let Some(line) = self.chain.get(self.at + 1) {
            self.distance -= self.under.ends_at;
            self.at += 1;
            self.range = self.lines.range(*line);
            self.vertex = self.range.0;
        }
        self.enter();
    }

    #[inline]
    fn enter(&mut self) {
        self.under = self.lines.segment(self.vertex);
        self.look_ahead();
    }

    /// Moves back by a distance; before the beginning of the track it stays on the first segment.
    pub fn back(mut self, distance: Metre) -> Self {
        self.distance -= distance;
        while self.distance < self.under.begins_at && self.enter_previous() {}
        self
    }

    /// Enters the previous segment of the track; `false` if there is none. The place does not change.
    pub(crate) fn enter_previous(&mut self) -> bool {
        if self.vertex > self.range.0 {
            self.vertex -= 1;
            self.enter();
        } else if self.at > 0 {
            self.at -= 1;
            self.range = self.lines.range(self.chain[self.at]);
            self.vertex = self.range.1 - 2;
            self.enter();
            self.distance += self.under.ends_at;
        } else {
            return false;
        }
        true
    }
}
