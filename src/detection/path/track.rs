//! A road user's place on lines that join: where its front bumper is, and how far they lead ahead.
//!
//! A track refers to lines of a table, mostly the lanes of the net, which therefore need not be copied. Distances are
//! measured along the line that the front bumper is on: negative before its beginning, above its length beyond its end.

use smallvec::SmallVec;

use super::chord;
use super::cursor::Cursor;
use crate::geometry::polylines::{Lines, ON_THE_LINE};
use crate::geometry::{Bounds, Point, Vector};
use crate::util::units::Metre;

/// Within one simulation step a road user drives at most this many times the straight distance along the line: enough
/// for a U-turn.
const LONGEST_DETOUR: f64 = 4.0;
/// A road user that moves back by more than this has left the line, in m: more than recordings round, to 1 cm.
const BACKWARDS: Metre = 0.02;
/// Directions that differ by less than this are equal: poses between them add nothing.
pub(super) const SAME_DIRECTION: f64 = 1e-10;
/// Inline capacity: few tracks have more lines; longer ones spill to the heap.
const FEW: usize = 6;

/// Lines of a table that join, and a place on them.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// Lines in driving order.
    pub(super) lines: SmallVec<[u32; FEW]>,
    /// Index of the line that the front bumper is on.
    pub at: usize,
    /// The last vertex before the front bumper, in the table.
    pub(super) vertex: u32,
    /// Distance of the front bumper from the beginning of its line.
    pub(super) front: Metre,
    /// Distance of the end of the last line. It is kept because every step asks whether the track reaches far enough.
    pub(super) end: Metre,
}

impl Track {
    /// Removes all lines.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Begins with a line of at least two vertices, with the front bumper at a distance along it.
    pub fn begin(&mut self, lines: &Lines, line: u32, front: Metre) {
        self.lines.clear();
        self.lines.push(line);
        self.at = 0;
        self.end = lines.length(line);
        self.set_front(lines, front);
    }

    /// Puts the front bumper at a distance along the line that it is on.
    pub(super) fn set_front(&mut self, lines: &Lines, distance: Metre) {
        let line = self.lines[self.at];
        let vertices = lines.line(line);
        let before =
            vertices.partition_point(|vertex| vertex.distance <= distance).saturating_sub(1).min(vertices.len() - 2);
        self.front = distance;
        self.vertex = lines.range(line).0 + before as u32;
    }

    /// Appends a line that begins where the last one ends.
    pub fn append(&mut self, lines: &Lines, line: u32) {
        self.lines.push(line);
        self.end += lines.length(line);
    }

    /// Prepends a line that ends where the first one begins.
    pub fn prepend(&mut self, line: u32) {
        self.lines.insert(0, line);
        self.at += 1;
    }

    /// Whether the track has no lines.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Distance of the front bumper from the beginning of the line that it is on.
    pub fn front(&self) -> Metre {
        self.front
    }

    /// How far ahead the lines lead.
    pub fn ahead(&self) -> Metre {
        self.end - self.front
    }

    /// Updates the place of the front bumper, which has driven at most this far; `false` if it has left the lines ahead.
    pub fn follow(&mut self, lines: &Lines, front: Point, driven: Metre) -> bool {
        if self.is_empty() {
            return false;
        }
        let (under, stretch) = (lines.segment(self.vertex), lines.most_stretch());
        if let Some(distance) = under.distance_of(front) {
            if distance > self.front + driven * stretch + ON_THE_LINE {
                return false;
            }
            let goes_on = distance >= self.front - BACKWARDS;
            self.front = distance;
            return goes_on;
        }
        let moved = (front - under.at(self.front)).norm();
        let searched = (LONGEST_DETOUR * moved).min(driven) * stretch;
        let furthest = self.front + searched + ON_THE_LINE;
        let beyond = driven * stretch - searched;
        let mut cursor = self.cursor(lines);
        cursor.distance = furthest;
        while cursor.room() <= 0.0 {
            cursor.enter_next();
            let within = |distance: &Metre| *distance <= cursor.distance + beyond;
            if let Some(distance) = cursor.under.distance_of(front).filter(within) {
                let Cursor { at, vertex, .. } = cursor;
                let passed = self.lines[self.at..at].iter();
                self.end -= passed.map(|line| lines.length(*line)).sum::<Metre>();
                self.at = at;
                self.vertex = vertex;
                self.front = distance;
                return true;
            }
        }
        false
    }

    /// Moves the front bumper back; before the first line, straight back.
    pub(crate) fn move_back(&mut self, lines: &Lines, distance: Metre) {
        let Cursor { at, vertex, distance: front, .. } = self.behind(lines, distance);
        self.end += self.lines[at..self.at].iter().map(|line| lines.length(*line)).sum::<Metre>();
        (self.at, self.vertex, self.front) = (at, vertex, front);
    }

    /// Moves the front bumper forward; beyond the end, straight on.
    pub(crate) fn move_on(&mut self, lines: &Lines, distance: Metre) {
        let Cursor { at, vertex, distance: front, .. } = self.before(lines, distance);
        self.end -= self.lines[self.at..at].iter().map(|line| lines.length(*line)).sum::<Metre>();
        (self.at, self.vertex, self.front) = (at, vertex, front);
    }

    /// The place and the direction at a distance ahead of the front bumper; beyond the end, straight on.
    pub(crate) fn ahead_at(&self, lines: &Lines, distance: Metre) -> (Point, Vector) {
        let cursor = self.before(lines, distance);
        (cursor.point(), cursor.under.direction)
    }

    /// The place and the direction at a distance behind the front bumper; before the first line, straight back.
    pub(crate) fn behind_at(&self, lines: &Lines, distance: Metre) -> (Point, Vector) {
        let cursor = self.behind(lines, distance);
        (cursor.point(), cursor.under.direction)
    }

    /// A cursor at a distance ahead of the front bumper.
    fn before<'a>(&'a self, lines: &'a Lines, distance: Metre) -> Cursor<'a> {
        let mut cursor = self.cursor(lines);
        cursor.distance += distance;
        while cursor.room() <= 0.0 {
            cursor.enter_next();
        }
        cursor
    }

    /// Where the front bumper is.
    pub fn point(&self, lines: &Lines) -> Point {
        lines.segment(self.vertex).at(self.front)
    }

    /// The direction from a point this far behind the front bumper to it.
    pub fn chord(&self, lines: &Lines, length: Metre) -> Vector {
        let front = self.cursor(lines);
        chord(front.point(), front.back(length).point(), front.under.direction)
    }

    /// Metres of the plane per metre of the line that the front bumper is on.
    pub fn scale(&self, lines: &Lines) -> f64 {
        if self.is_empty() { 1.0 } else { lines.segment(self.vertex).scale() }
    }

    /// How long a road user is in the plane that is this long along the lines behind its front bumper.
    pub(crate) fn drawn_length(&self, lines: &Lines, length: Metre) -> Metre {
        if self.is_empty() {
            return length;
        }
        let mut cursor = self.cursor(lines);
        let (mut rest, mut longer) = (length, 0.0);
        // On lines to scale nothing is added, so that the length stays the same to the last digit.
        loop {
            let begins = cursor.under.begins_at;
            let here = (cursor.distance - begins).clamp(0.0, rest);
            longer += (cursor.under.scale() - 1.0) * here;
            rest -= here;
            cursor.distance = begins.min(cursor.distance);
            if rest == 0.0 || !cursor.enter_previous() {
                return length + longer + (cursor.under.scale() - 1.0) * rest;
            }
        }
    }

    /// The box around the lines from a distance `behind` the front bumper to a distance ahead of it, or to their end.
    pub fn bounds(&self, lines: &Lines, behind: Metre, ahead: Metre) -> Bounds {
        let mut cursor = self.behind(lines, behind);
        let mut bounds = Bounds::EMPTY;
        bounds.include(cursor.point());
        cursor.distance = (self.front + ahead).min(self.end) + (cursor.distance + behind - self.front);
        while cursor.room() < 0.0 {
            cursor.enter_next();
            bounds.include(cursor.under.start);
        }
        bounds.include(cursor.point());
        bounds
    }

    /// Whether the lines are straight from a distance `behind` the front bumper to a distance ahead of it.
    pub fn is_straight(&self, lines: &Lines, behind: Metre, ahead: Metre) -> bool {
        let mut cursor = self.behind(lines, behind);
        let direction = cursor.under.direction;
        cursor.distance += behind + ahead.min(self.ahead());
        while cursor.room() < 0.0 {
            cursor.enter_next();
            if (cursor.under.direction - direction).norm() > SAME_DIRECTION {
                return false;
            }
        }
        true
    }

    /// The last vertex up to a distance ahead of the front bumper, or behind it if negative, and the line that it is on.
    pub(super) fn vertex_ahead(&self, lines: &Lines, distance: Metre) -> (u32, u32) {
        let mut cursor = self.behind(lines, (-distance).max(0.0));
        cursor.distance += distance.max(0.0);
        while cursor.room() <= 0.0 {
            cursor.enter_next();
        }
        (cursor.vertex, self.lines[cursor.at])
    }

    /// Removes the lines that lie wholly further behind the front bumper than this.
    pub fn remove_behind(&mut self, lines: &Lines, behind: Metre) {
        let mut begin = self.front;
        let mut first = self.at;
        while begin < behind && first > 0 {
            first -= 1;
            begin += lines.length(self.lines[first]);
        }
        self.lines.drain(..first);
        self.lines.shrink_to_fit();
        self.at -= first;
    }

    /// Total length of its lines.
    pub(super) fn length(&self, lines: &Lines) -> Metre {
        self.end + self.passed(lines)
    }

    /// Length of the lines before the one that the front bumper is on.
    pub(super) fn passed(&self, lines: &Lines) -> Metre {
        self.lines[..self.at].iter().map(|line| lines.length(*line)).sum()
    }

    /// Whether the front bumper was here when the track was last followed.
    pub fn is_at(&self, lines: &Lines, front: Point) -> bool {
        !self.is_empty() && (lines.segment(self.vertex).at(self.front) - front).norm() <= ON_THE_LINE
    }

    /// A cursor at a distance behind the front bumper.
    #[inline]
    pub(super) fn behind<'a>(&'a self, lines: &'a Lines, distance: Metre) -> Cursor<'a> {
        let front = self.cursor(lines);
        if distance > 0.0 { front.back(distance) } else { front }
    }

    /// A cursor at the front bumper.
    #[inline]
    pub(super) fn cursor<'a>(&'a self, lines: &'a Lines) -> Cursor<'a> {
        Cursor::new(lines, &self.lines, self.at, self.vertex, self.front)
    }
}

#[cfg(test)]
impl Track {
    /// A track on one line through these points, with the front bumper at a distance along it; and the line.
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
    fn it_is_followed_while_the_front_is_on_it() {
        let (mut track, lines) = Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        assert!(!track.clone().follow(&lines, Point::new(10.0, 3.0), 3.0), "further than it has driven");
        assert!(track.follow(&lines, Point::new(9.5, 0.0), f64::INFINITY));
        assert!(track.follow(&lines, Point::new(10.0, 3.0), f64::INFINITY));
        assert_eq!(track.front(), 13.0);
        assert!(!track.follow(&lines, Point::new(11.0, 4.0), f64::INFINITY));
    }

    #[test]
    fn it_is_straight_as_far_as_it_does_not_turn() {
        let (track, lines) = Track::through(&[(0.0, 0.0), (10.0, 0.0), (40.0, 0.0), (40.0, 20.0)], 30.0);
        let straight = |behind: f64, ahead: f64| track.is_straight(&lines, behind, ahead);
        assert_eq!([straight(25.0, 10.0), straight(25.0, 10.1), straight(0.0, 10.0)], [true, false, true]);
        let (track, lines) = Track::through(&[(0.0, 0.0), (40.0, 0.0), (40.0, 20.0)], 50.0);
        assert_eq!([10.0, 10.1].map(|behind| track.is_straight(&lines, behind, 5.0)), [true, false]);
    }

    #[test]
    fn a_vehicle_that_drives_back_is_not_on_it() {
        let (mut track, lines) = Track::through(&[(0.0, 0.0), (100.0, 0.0)], 50.0);
        assert!(track.follow(&lines, Point::new(49.99, 0.0), f64::INFINITY), "a rounded position");
        assert!(!track.follow(&lines, Point::new(49.0, 0.0), f64::INFINITY));
    }

    #[test]
    fn moved_back_it_is_where_it_came_from() {
        let lines = Lines::through([(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)].map(|(x, y)| Point::new(x, y)));
        let mut track = Track::default();
        track.begin(&lines, 0, 14.0);
        track.move_back(&lines, 6.0);
        assert_eq!((track.front(), track.ahead(), track.point(&lines)), (8.0, 22.0, Point::new(8.0, 0.0)));
        assert_eq!(track.chord(&lines, 5.0), Vector::x());
        track.move_back(&lines, 9.0);
        assert_eq!(track.point(&lines), Point::new(-1.0, 0.0));
        track.move_on(&lines, 15.0);
        assert_eq!((track.front(), track.ahead(), track.point(&lines)), (14.0, 16.0, Point::new(10.0, 4.0)));
        track.move_back(&lines, 15.0);
        assert!(track.follow(&lines, Point::new(10.0, 1.0), f64::INFINITY));
    }
}
