//! A road user's place on lines that join: where its front bumper is, and how far they lead ahead.
//!
//! A track says which lines of a table it runs over, the net's lanes mostly, which nobody has to copy. Ways are those along
//! the line that the front bumper is on: behind its beginning they are negative, beyond its end larger than it is long.

use smallvec::SmallVec;

use crate::geometry::polylines::{Lines, ON_THE_LINE, Segment};
use crate::geometry::{Bounds, Point};
use crate::util::units::Metre;

/// A way along the line is at most this many times as long as the straight line between its ends, where a road user
/// drives on it for one step: a turn right back.
const LONGEST_DETOUR: f64 = 4.0;
/// Who gets further back than this on a line does not drive along it, in m: more than recordings round, to 1 cm.
const BACKWARDS: Metre = 0.02;
/// Of so many lines hardly a track has more: the lane behind, the junction's, the next two.
const MOSTLY: usize = 6;

/// Lines of a table that join, and a place on them.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// In their order.
    pub(super) lines: SmallVec<[u32; MOSTLY]>,
    /// On which of them the front bumper is.
    pub(super) at: u16,
    /// On which edge of the route the last of them is, or was when the route was left, as [`super::lanes`] counts them.
    pub(super) edge: u16,
    /// The last corner before it, in the table.
    pub(super) corner: u32,
    pub(super) front: Metre,
    /// Where the last line ends: whether a track reaches far enough is asked of everybody in every step.
    pub(super) end: Metre,
}

impl Track {
    /// Forgets the lines.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Begins with this line, which has two corners at least, the front bumper at this way.
    pub fn begin(&mut self, lines: &Lines, line: u32, front: Metre) {
        self.lines.clear();
        self.lines.push(line);
        self.at = 0;
        self.end = lines.length(line);
        self.set_front(lines, front);
    }

    /// Puts the front bumper at a way along the line that it is on.
    pub(super) fn set_front(&mut self, lines: &Lines, way: Metre) {
        let line = self.lines[self.at as usize];
        let corners = lines.line(line);
        let before = corners.partition_point(|corner| corner.way <= way).saturating_sub(1).min(corners.len() - 2);
        self.front = way;
        self.corner = lines.range(line).0 + before as u32;
    }

    /// Goes on over a line that joins the last one.
    pub fn go_on(&mut self, lines: &Lines, line: u32) {
        self.lines.push(line);
        self.end += lines.length(line);
    }

    /// Has come over a line that the first one joins.
    pub fn come_from(&mut self, line: u32) {
        self.lines.insert(0, line);
        self.at += 1;
    }

    /// Whether there is a line at all.
    pub fn is_laid(&self) -> bool {
        !self.lines.is_empty()
    }

    /// The way from the beginning of the line that the front bumper is on.
    pub fn front(&self) -> Metre {
        self.front
    }

    /// How far ahead the lines lead.
    pub fn ahead(&self) -> Metre {
        self.end - self.front
    }

    /// Follows the front bumper to where it is now; `false` if it is not on the lines ahead any more.
    pub fn follow(&mut self, lines: &Lines, front: Point) -> bool {
        if !self.is_laid() {
            return false;
        }
        let under = lines.segment(self.corner);
        if let Some(way) = under.way_to(front) {
            let goes_on = way >= self.front - BACKWARDS;
            self.front = way;
            return goes_on;
        }
        let moved = (front - under.at(self.front)).norm();
        let furthest = self.front + LONGEST_DETOUR * moved + ON_THE_LINE;
        let mut cursor = Cursor { way: furthest, ..self.cursor(lines) };
        while cursor.room() <= 0.0 {
            cursor.go_on();
            if let Some(way) = cursor.under.way_to(front) {
                let (at, corner) = (cursor.at, cursor.corner);
                let passed = self.lines[self.at as usize..at].iter();
                self.end -= passed.map(|line| lines.length(*line)).sum::<Metre>();
                (self.at, self.corner, self.front) = (at as u16, corner, way);
                return true;
            }
        }
        false
    }

    /// The box around the lines from the front bumper to this way ahead of it, or to their end.
    pub fn bounds_ahead(&self, lines: &Lines, way: Metre) -> Bounds {
        let mut cursor = self.cursor(lines);
        let mut bounds = Bounds::EMPTY;
        bounds.include(cursor.point());
        cursor.way = (self.front + way).min(self.end);
        while cursor.room() < 0.0 {
            cursor.go_on();
            bounds.include(cursor.under.start);
        }
        bounds.include(cursor.point());
        bounds
    }

    /// The corner at this way ahead of the front bumper, or the last one before it, and which line has it.
    pub(super) fn corner_ahead(&self, lines: &Lines, way: Metre) -> (u32, u32) {
        let mut cursor = Cursor { way: self.front + way, ..self.cursor(lines) };
        while cursor.room() <= 0.0 {
            cursor.go_on();
        }
        (cursor.corner, self.lines[cursor.at])
    }

    /// Drops the lines that lie wholly further behind the front bumper than this.
    pub fn forget_behind(&mut self, lines: &Lines, behind: Metre) {
        let (mut begin, mut first) = (self.front, self.at as usize);
        while begin < behind && first > 0 {
            first -= 1;
            begin += lines.length(self.lines[first]);
        }
        self.lines.drain(..first);
        self.lines.shrink_to_fit();
        self.at -= first as u16;
    }

    /// How long its lines are, all together.
    pub(super) fn length(&self, lines: &Lines) -> Metre {
        self.end + self.lines[..self.at as usize].iter().map(|line| lines.length(*line)).sum::<Metre>()
    }

    /// Where the front bumper is.
    #[inline]
    pub(super) fn cursor<'a>(&'a self, lines: &'a Lines) -> Cursor<'a> {
        let (chain, at, way) = (&self.lines[..], self.at as usize, self.front);
        let (range, under) = (lines.range(chain[at]), lines.segment(self.corner));
        let mut cursor = Cursor { lines, chain, at, range, corner: self.corner, under, next: under.end, way };
        cursor.look_ahead();
        cursor
    }
}

/// A place on a track that moves.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    lines: &'a Lines,
    chain: &'a [u32],
    /// On which of these lines it is, and where its corners are.
    at: usize,
    range: (u32, u32),
    /// The last corner before it.
    pub corner: u32,
    pub under: Segment,
    /// Where the next corner is; from the track's last part there is none, however far.
    next: Metre,
    /// Along the line that it is on.
    pub way: Metre,
}

impl Cursor<'_> {
    /// Before the track's beginning and beyond its end, straight on.
    pub fn point(&self) -> Point {
        self.under.at(self.way)
    }

    /// Way to the next corner; behind it less than 0.
    #[inline]
    pub fn room(&self) -> Metre {
        self.next - self.way
    }

    /// How far the part of the track reaches that it is on.
    #[inline]
    fn look_ahead(&mut self) {
        let is_last = self.corner + 2 == self.range.1 && self.at + 1 == self.chain.len();
        self.next = if is_last { f64::INFINITY } else { self.under.end };
    }

    /// On to the next part of the track, if there is one; the place stays where it is.
    pub fn go_on(&mut self) {
        if self.corner + 2 < self.range.1 {
            self.corner += 1;
        } else if let Some(line) = self.chain.get(self.at + 1) {
            self.way -= self.under.end;
            self.at += 1;
            self.range = self.lines.range(*line);
            self.corner = self.range.0;
        }
        self.enter();
    }

    #[inline]
    fn enter(&mut self) {
        self.under = self.lines.segment(self.corner);
        self.look_ahead();
    }

    /// Back to where this way ends; before the track's beginning on its first part.
    pub fn back(mut self, way: Metre) -> Self {
        self.way -= way;
        while self.way < self.under.way {
            if self.corner > self.range.0 {
                self.corner -= 1;
                self.enter();
            } else if self.at > 0 {
                self.at -= 1;
                self.range = self.lines.range(self.chain[self.at]);
                self.corner = self.range.1 - 2;
                self.enter();
                self.way += self.under.end;
            } else {
                break;
            }
        }
        self
    }
}

#[cfg(test)]
impl Track {
    /// On one line through these points, the front bumper at this way; and the line.
    pub(super) fn through(points: &[(f64, f64)], front: f64) -> (Self, Lines) {
        let lines = Lines::through(points.iter().map(|&(x, y)| Point::new(x, y)));
        let mut track = Self::default();
        track.begin(&lines, 0, front);
        (track, lines)
    }
}

#[cfg(test)]
mod tests {
    use crate::detection::path::track::*;

    #[test]
    fn it_is_followed_as_long_as_the_front_is_on_it() {
        let (mut corner, lines) = Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        assert!(corner.follow(&lines, Point::new(9.5, 0.0)));
        assert!(corner.follow(&lines, Point::new(10.0, 3.0)));
        assert_eq!(corner.front(), 13.0);
        assert!(!corner.follow(&lines, Point::new(11.0, 4.0)));
    }

    #[test]
    fn who_drives_back_on_it_is_not_on_it() {
        let (mut line, lines) = Track::through(&[(0.0, 0.0), (100.0, 0.0)], 50.0);
        assert!(line.follow(&lines, Point::new(49.99, 0.0)), "a rounded position");
        assert!(!line.follow(&lines, Point::new(49.0, 0.0)));
    }
}
