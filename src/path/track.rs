//! A line on the ground and a road user's place on it.

use super::segment::{Corner, ON_THE_LINE, Segment};
use crate::geometry::{Bounds, Point};
use crate::units::Metre;

/// A way along the line is at most this many times as long as the straight line between its ends, where a road user
/// drives on it for one step: a turn right back.
const LONGEST_DETOUR: f64 = 4.0;
/// Who gets further back than this on a line does not drive along it, in m: more than recordings round, to 1 cm.
const BACKWARDS: Metre = 0.02;

/// A polyline with a place on it.
///
/// What following needs stands in front: most steps end on the segment that they began on, and look at nothing else.
#[derive(Clone, Debug, Default)]
pub struct Track {
    pub(super) under: Segment,
    pub(super) front: Metre,
    /// The last corner's way: whether a path reaches far enough is asked of everybody in every step.
    end: Metre,
    pub(super) segment: usize,
    pub(super) corners: Vec<Corner>,
}

impl Track {
    /// Forgets the line.
    pub fn clear(&mut self) {
        self.corners.clear();
        (self.under, self.front, self.end, self.segment) = Default::default();
    }

    /// Appends a point; one that repeats the last is left out.
    pub fn push(&mut self, point: Point) {
        let way = match self.corners.last() {
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
        self.end = way;
        if self.corners.len() == self.segment + 2 {
            self.enter(self.segment);
        }
    }

    /// Takes the memory for so many further points, no more.
    pub fn reserve(&mut self, points: usize) {
        self.corners.reserve_exact(points);
    }

    /// Gives back the memory for further points.
    pub fn shrink(&mut self) {
        self.corners.shrink_to_fit();
    }

    /// Whether there is a line at all.
    pub fn is_laid(&self) -> bool {
        self.corners.len() >= 2
    }

    /// The way from the line's beginning to the front bumper.
    pub fn front(&self) -> Metre {
        self.front
    }

    /// The way from the line's beginning to its end.
    pub fn end(&self) -> Metre {
        self.end
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The last point at this way from the line's beginning, or before it.
    pub fn corner_before(&self, way: Metre) -> usize {
        self.corners.partition_point(|corner| corner.way <= way).saturating_sub(1)
    }

    /// Puts the front bumper at a way from the line's beginning.
    pub fn set_front(&mut self, way: Metre) {
        self.front = way;
        self.segment = self.corner_before(way).min(self.corners.len().saturating_sub(2));
        if self.is_laid() {
            self.enter(self.segment);
        }
    }

    fn enter(&mut self, segment: usize) {
        self.segment = segment;
        self.under = self.part(segment);
    }

    pub(super) fn part(&self, segment: usize) -> Segment {
        Segment::between(&self.corners[segment], &self.corners[segment + 1])
    }

    /// Follows the front bumper to where it is now; `false` if it is not on the line ahead any more.
    pub fn follow(&mut self, front: Point) -> bool {
        if self.under.length <= 0.0 {
            return false;
        }
        if let Some(way) = self.under.way_to(front) {
            let goes_on = way >= self.front - BACKWARDS;
            self.front = way;
            return goes_on;
        }
        let moved = (front - self.under.at(self.front)).norm();
        let furthest = self.front + LONGEST_DETOUR * moved + ON_THE_LINE;
        for segment in self.segment + 1..self.corners.len() - 1 {
            if self.corners[segment].way > furthest {
                return false;
            }
            if let Some(way) = self.part(segment).way_to(front) {
                self.enter(segment);
                self.front = way;
                return true;
            }
        }
        false
    }

    /// The box around the line from the front bumper to this way ahead of it, or to the line's end.
    pub fn bounds_ahead(&self, way: Metre) -> Bounds {
        let (mut bounds, mut last) = (Bounds::EMPTY, self.under);
        bounds.include(last.at(self.front));
        let end = (self.front + way).min(self.end());
        for pair in self.corners[self.segment + 1..].windows(2).take_while(|pair| pair[0].way < end) {
            bounds.include(pair[0].point);
            last = Segment::between(&pair[0], &pair[1]);
        }
        bounds.include(last.at(end));
        bounds
    }

    /// Drops the points that lie further behind the front bumper than `behind`, but the last of them; returns how many.
    /// All ways stay as they are.
    pub fn drop_behind(&mut self, behind: Metre) -> usize {
        let dropped = self.corner_before(self.front - behind);
        self.corners.drain(..dropped);
        self.segment -= dropped;
        dropped
    }

    /// Does so, and lets the line begin at the first point that is left: along a long way its points stay precise.
    pub fn forget_behind(&mut self, behind: Metre) -> usize {
        let dropped = self.drop_behind(behind);
        let shift = self.corners.first().map_or(0.0, |first| first.way);
        if shift > 0.0 {
            for corner in &mut self.corners {
                corner.way -= shift;
            }
            self.front -= shift;
            self.end -= shift;
            self.enter(self.segment);
        }
        dropped
    }
}

#[cfg(test)]
impl Track {
    /// A line through these points, the front bumper at this way.
    pub(super) fn through(points: &[(f64, f64)], front: f64) -> Self {
        let mut track = Self::default();
        for &(x, y) in points {
            track.push(Point::new(x, y));
        }
        track.set_front(front);
        track
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_followed_as_long_as_the_front_is_on_it() {
        let mut corner = Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        assert!(corner.follow(Point::new(9.5, 0.0)));
        assert!(corner.follow(Point::new(10.0, 3.0)));
        assert_eq!(corner.front(), 13.0);
        assert!(!corner.follow(Point::new(11.0, 4.0)));
    }

    #[test]
    fn who_drives_back_on_it_is_not_on_it() {
        let mut line = Track::through(&[(0.0, 0.0), (100.0, 0.0)], 50.0);
        assert!(line.follow(Point::new(49.99, 0.0)), "a rounded position");
        assert!(!line.follow(Point::new(49.0, 0.0)));
    }
}
