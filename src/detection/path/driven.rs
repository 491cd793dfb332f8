//! Path along the places where a road user really drove afterwards, from a recording.
//!
//! The line runs through places of the front bumper that are at least `SPACING` apart, and through where it is now. Noise
//! below that, and a road user that stands, therefore make no knots. Beyond the last place that is known, the line goes
//! straight on: as the road user last moved, or as it heads if it moves no more.

use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6};

use super::lanes::LanePath;
use super::turn;
use crate::geometry::{Point, Vector, cross};
use crate::util::limits::SPEED;
use crate::util::units::{Metre, Radian, Second};

/// The least distance between two places, in m: noise of 1 cm turns the line between them by 2°, and on a circle of 6 m radius,
/// a tight turn, the line is 5 mm beside it.
const SPACING: Metre = 0.5;
/// Places nearer than this to where the road user is now are left out, in m.
const CLEAR: Metre = SPACING / 2.0;
/// A place is ahead of the last one if the way to it differs by less than this from the way before, or from the mean of both
/// headings, which is that of an arc, in rad. Any other place comes from reversing.
const AHEAD: Radian = FRAC_PI_3;
/// The same after a jump to the side, in rad: 15°. SUMO changes lanes within a step; 3.2 m to the side are driven within the next 12 m
/// instead.
const AHEAD_OF_JUMP: Radian = FRAC_PI_3 / 4.0;
/// Between two positions a road user jumps to the side if it moves by more than this across its heading, in m, and so far from it, in
/// rad. A recording with steps of 1 s has arcs of which the chord and the heading of a long vehicle differ by 20°.
const LEAST_JUMP: Metre = 1.0;
const LEAST_ASIDE: Radian = FRAC_PI_6;
/// Further to the side or behind than this, in m, a road user does not come back to its former line: no lane of a street is wider.
const ELSEWHERE: Metre = 10.0;
/// Before its first place a road user drove straight on for this distance, in m: no vehicle of a street is longer.
const CAME_FROM: Metre = 30.0;
/// The line is built this much longer than needed, in m.
const SPARE: Metre = 10.0;

/// Where a front bumper is at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenPlace {
    /// Simulated time in s.
    pub time: Second,
    /// The place.
    pub point: Point,
    /// Whether the road user did not drive here from the place before.
    pub begins: bool,
}

/// Chooses the places of a line from all positions of a road user, in the order of time.
#[derive(Debug, Default)]
pub struct DrivenCourse {
    last: Option<DrivenPlace>,
    /// The way from the place before to the last.
    displacement: Vector,
    /// The heading at the last place.
    axis: Vector,
    /// The time of the last position, which may be no place, and the position and heading.
    time: Second,
    before: Point,
    axis_before: Vector,
    /// Whether it has jumped to the side since the last place.
    is_aside: bool,
}

impl DrivenCourse {
    /// Takes a position and the heading there; adds the places that follow from it.
    pub fn take(&mut self, time: Second, point: Point, axis: Vector, places: &mut Vec<DrivenPlace>) {
        let (step, along) = (point - self.before, self.axis_before + axis);
        let jumps = step.norm() > SPEED.most * (time - self.time);
        let across = cross(&along, &step).abs() / along.norm();
        self.is_aside |= across > LEAST_JUMP && turn(&along, &step).abs() > LEAST_ASIDE;
        (self.time, self.before, self.axis_before) = (time, point, axis);
        let Some(last) = self.last.filter(|_| !jumps) else { return self.begin(time, point, axis, places) };
        let displacement = point - last.point;
        if displacement.norm() < SPACING {
            return;
        }
        let ahead = if self.is_aside { AHEAD_OF_JUMP } else { AHEAD };
        if turn(&(self.axis + axis), &displacement).abs() < ahead
            || turn(&self.displacement, &displacement).abs() < ahead
        {
            (self.displacement, self.axis, self.is_aside) = (displacement, axis, false);
            self.push(DrivenPlace { time, point, begins: false }, places);
        } else if cross(&axis, &displacement).abs().max(-axis.dot(&displacement)) > ELSEWHERE {
            self.begin(time, point, axis, places);
        }
    }

    fn begin(&mut self, time: Second, point: Point, axis: Vector, places: &mut Vec<DrivenPlace>) {
        (self.displacement, self.axis, self.is_aside) = (axis, axis, false);
        places.push(DrivenPlace { time, point: point - axis * CAME_FROM, begins: true });
        self.push(DrivenPlace { time, point, begins: false }, places);
    }

    fn push(&mut self, place: DrivenPlace, places: &mut Vec<DrivenPlace>) {
        self.last = Some(place);
        places.push(place);
    }
}

/// Where a road user is, and how much of its line is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrivenNow {
    /// Simulated time in s.
    pub time: Second,
    /// Front-bumper centre.
    pub front: Point,
    /// Unit vector of the heading.
    pub axis: Vector,
    /// How far back, in m.
    pub behind: Metre,
    /// How far ahead, in m.
    pub ahead: Metre,
}

/// The places of one road user from behind it to as far ahead as they are known.
#[derive(Debug, Default)]
pub(crate) struct DrivenPlaces {
    places: VecDeque<DrivenPlace>,
    /// How many of them are behind it.
    passed: usize,
    /// How many of them its line has taken.
    taken: usize,
    /// Reused.
    behind: Vec<Point>,
}

impl DrivenPlaces {
    /// Adds places in the order of time.
    pub fn add(&mut self, places: impl IntoIterator<Item = DrivenPlace>) {
        self.places.extend(places);
    }

    /// Forgets all places.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Lays the path of the road user anew.
    pub(crate) fn lay(&mut self, path: &mut LanePath, now: &DrivenNow) {
        while self.places.get(self.passed).is_some_and(|place| place.time <= now.time) {
            self.passed += 1;
        }
        self.find_behind(now);
        path.begin_driven(self.behind.drain(..).rev(), now.front);
        let is_clear = |place: &DrivenPlace| {
            let displacement = place.point - now.front;
            displacement.norm() >= CLEAR && (displacement.norm() > ELSEWHERE || displacement.dot(&now.axis) > 0.0)
        };
        let ahead = self.places.range(self.passed..).take_while(|place| !place.begins);
        self.taken = self.passed + ahead.take_while(|place| !is_clear(place)).count();
        self.lengthen(path, now.axis, now.ahead);
    }

    /// Extends the path as last laid to this far ahead of the road user.
    pub(crate) fn lengthen(&mut self, path: &mut LanePath, axis: Vector, ahead: Metre) {
        while path.track.ahead() < ahead
            && let Some(place) = self.places.get(self.taken).filter(|place| !place.begins)
        {
            path.drive_to(place.point);
            self.taken += 1;
        }
        if path.track.ahead() < ahead {
            path.drive_on(axis, ahead + SPARE);
        }
    }

    /// Finds the places behind the road user, nearest first, and forgets those that it needs no more.
    fn find_behind(&mut self, now: &DrivenNow) {
        let (mut nearest, mut driven) = (now.front, 0.0);
        let mut first = self.passed;
        while first > 0 && driven < now.behind && (first == self.passed || !self.places[first].begins) {
            first -= 1;
            let place = self.places[first].point;
            let back = nearest - place;
            // Only the nearest may be in the way: it has reversed, or was moved.
            if !self.behind.is_empty() || (back.norm() >= CLEAR && back.dot(&now.axis) > 0.0) {
                driven += back.norm();
                nearest = place;
                self.behind.push(place);
            }
        }
        self.places.drain(..first);
        self.passed -= first;
        if self.behind.is_empty() {
            self.behind.push(now.front - now.axis * now.behind);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::path::Pose;
    use crate::traffic::profile::Carriage;

    /// The places of a road user that is at these points, a tenth of a second after each other.
    fn places(points: impl IntoIterator<Item = (f64, f64, f64)>) -> Vec<DrivenPlace> {
        let (mut course, mut places) = (DrivenCourse::default(), Vec::new());
        for (step, (x, y, heading)) in (0..).zip(points) {
            let axis = Vector::new(f64::cos(heading), f64::sin(heading));
            course.take(f64::from(step) / 10.0, Point::new(x, y), axis, &mut places);
        }
        places
    }

    /// The front bumpers of a car along its path, from where it is at a time on.
    fn fronts(places: &[DrivenPlace], time: f64, front: (f64, f64), ahead: f64) -> Vec<Point> {
        let (mut all, mut path, mut poses) = (DrivenPlaces::default(), LanePath::default(), Vec::<Pose>::new());
        all.add(places.iter().copied());
        let front = Point::new(front.0, front.1);
        let now = DrivenNow { time, front, axis: Vector::x(), behind: 10.0, ahead };
        all.lay(&mut path, &now);
        let carriage = Carriage { behind: 0.0, length: 5.0 };
        let lines = path.lines(crate::geometry::polylines::Lines::NONE);
        path.track.poses(lines, Vector::x(), carriage, &[ahead], false, &mut poses);
        poses.iter().map(|pose| pose.front).collect()
    }

    #[test]
    fn standing_and_noise_make_no_knots() {
        let noise = |step: u32| 0.009 * (f64::from(step * 37 % 19) / 9.0 - 1.0);
        let drives = |step: u32| (f64::from(step) * 0.05 + noise(step), noise(step + 5), 0.0);
        let stands = |step: u32| (10.0 + noise(step), noise(step + 3), 0.0);
        let found = places((0..200).map(drives).chain((0..500).map(stands)).chain((200..400).map(drives)));
        let line = found.iter().skip(1).map(|place| place.point).collect::<Vec<_>>();
        assert!(line.len() > 35 && line.windows(2).all(|pair| pair[1].x - pair[0].x >= 0.49), "{line:?}");
        let fronts = fronts(&found, 15.0, (7.5, 0.0), 10.0);
        assert!(fronts.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].y.abs() < 0.02), "{fronts:?}");
    }

    #[test]
    fn beyond_the_last_place_it_goes_straight_on() {
        let diagonal = places((0..30).map(|step| (f64::from(step), f64::from(step), 0.8)));
        let end = *fronts(&diagonal, 2.0, (20.0, 20.0), 100.0).last().unwrap();
        assert!((end.x - end.y).abs() < 1e-9 && (end - Point::new(20.0, 20.0)).norm() > 99.9, "{end}");
        assert_eq!(fronts(&diagonal, 5.0, (40.0, 29.0), 50.0).last(), Some(&Point::new(90.0, 29.0)), "as it heads");
    }

    #[test]
    fn reversing_and_jumps_to_the_side_are_not_driven_forward() {
        let ahead = (0..20).map(|step| (f64::from(step), 0.0, 0.0));
        let back = (0..10).map(|step| (19.0 - f64::from(step) * 0.5, 0.0, 0.0));
        let again = (0..20).map(|step| (14.5 + f64::from(step), 0.0, 0.0));
        let found = places(ahead.chain(back).chain(again));
        let fronts = fronts(&found, 2.9, (14.5, 0.0), 15.0);
        assert_eq!([fronts.first(), fronts.last()].map(|front| front.unwrap().x), [14.5, 29.5]);
        assert!(fronts.windows(2).all(|pair| pair[1].x > pair[0].x), "{fronts:?}");
        let found = places((0..40).map(|step| (f64::from(step), if step < 20 { 0.0 } else { 3.2 }, 0.0)));
        let steepest =
            found.windows(2).map(|pair| (pair[1].point.y - pair[0].point.y) / (pair[1].point.x - pair[0].point.x));
        assert!(steepest.fold(0.0, f64::max) < 0.27, "{found:?}");
        assert!(found.iter().skip(1).all(|place| !place.begins));
    }

    #[test]
    fn a_teleport_ends_the_path() {
        let found = places((0..40).map(|step| (f64::from(step), if step < 20 { 0.0 } else { 500.0 }, 0.0)));
        let fronts = fronts(&found, 1.0, (10.0, 0.0), 30.0);
        assert_eq!(fronts.last(), Some(&Point::new(40.0, 0.0)));
    }

    #[test]
    fn a_sharp_bend_of_a_lane_is_driven() {
        // The heading of a bus of 12 m lags behind: its rear is still before the bend.
        let bend = |step: u32| {
            let driven = f64::from(step) * 0.32 - 20.0;
            let (beyond, heading) = (driven.max(0.0), (driven / 12.0).clamp(0.0, 1.0) * 0.8);
            (driven.min(0.0) + beyond * f64::cos(0.8), beyond * f64::sin(0.8), heading)
        };
        let found = places((0..150).map(bend));
        assert!(found.iter().skip(1).all(|place| !place.begins));
        let ways = found.windows(2).skip(1).map(|pair| (pair[1].point - pair[0].point).norm());
        assert!(ways.fold(0.0, f64::max) < 1.0, "{found:?}");
    }

    #[test]
    fn it_turns_where_it_turned() {
        let turn = |step: u32| {
            let angle = f64::from(step) * 0.1;
            (6.0 * f64::sin(angle), 6.0 - 6.0 * f64::cos(angle), angle)
        };
        let found = places((0..30).map(turn));
        let fronts = fronts(&found, 0.0, (0.0, 0.0), 12.0);
        let off = fronts.iter().map(|front| ((front - Point::new(0.0, 6.0)).norm() - 6.0).abs());
        assert!(off.fold(0.0, f64::max) < 0.02);
    }
}
