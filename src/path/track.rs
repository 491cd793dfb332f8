//! A line on the ground and a road user's place on it: the front bumper is on the line, and so is the rear.

use super::segment::{Corner, ON_THE_LINE, Segment};
use super::{Pose, largest_turn, rotated, turn};
use crate::geometry::{Bounds, Point, Vector, cross};
use crate::units::{Metre, Radian};

/// A heading that differs by less than this from the line's chord is the chord, in rad.
const SAME_HEADING: Radian = 1e-6;
/// A way along the line is at most this many times as long as the straight line between its ends, where a road user
/// drives on it for one step: a turn right back.
const LONGEST_DETOUR: f64 = 4.0;
/// Who gets further back than this on a line does not drive along it, in m: more than recordings round, to 1 cm.
const BACKWARDS: Metre = 0.02;
/// Directions that differ by less than this are one: poses in between say nothing.
const SAME_DIRECTION: f64 = 1e-10;

/// A polyline with a place on it.
///
/// What following needs stands in front: most steps end on the segment that they began on, and look at nothing else.
#[derive(Clone, Debug, Default)]
pub struct Track {
    under: Segment,
    front: Metre,
    /// The last corner's way: whether a path reaches far enough is asked of everybody in every step.
    end: Metre,
    segment: usize,
    corners: Vec<Corner>,
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

    fn part(&self, segment: usize) -> Segment {
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

    /// Whether a road user of this length and heading drives straight on for so long, along the part of the line that it
    /// is on now; `false` also where that takes looking further ahead to know.
    pub fn goes_straight(&self, axis: &Vector, length: Metre, way: Metre) -> bool {
        let Segment { direction, length: whole, way: begin, .. } = &self.under;
        self.front - length >= *begin && self.front + way <= begin + whole && turns_less(direction, axis, SAME_HEADING)
    }

    /// How far the way of who goes straight, so long as this, lies at most beside where it heads: as far as it may be off
    /// the line now and as its heading takes it, and twice that, for rounding.
    pub fn beside_heading(way: Metre) -> Metre {
        2.0 * (ON_THE_LINE + SAME_HEADING * way)
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

    /// Adds the poses at the given ways ahead of the front bumper (ascending, from 0 on), where the line's points
    /// make the road user turn, and as many between as the sweep's tolerance needs. Ends where the line ends, unless
    /// `beyond`: then it goes straight on from there.
    ///
    /// `axis` is the heading of now. Where it differs from the chord (a lane change, a rear on a lane that is not
    /// known) the difference fades out over the road user's own length.
    pub fn poses(&self, axis: Vector, length: Metre, ways: &[Metre], beyond: bool, poses: &mut Vec<Pose>) {
        let limit = if beyond { f64::INFINITY } else { self.end() - self.front };
        let mut front = Cursor { track: self, segment: self.segment, under: self.under, way: self.front };
        let rear_way = self.front - length;
        let mut rear = if rear_way >= self.under.way {
            Cursor { way: rear_way, ..front }
        } else {
            Cursor::at(self, self.corner_before(rear_way).min(self.segment), rear_way)
        };
        let chord_now = chord(&front, &rear, axis);
        let skew = if turns_less(&chord_now, &axis, SAME_HEADING) { 0.0 } else { turn(&chord_now, &axis) };
        let skew = if skew.abs() < SAME_HEADING { 0.0 } else { skew };
        let widest = largest_turn(length);
        let start = poses.len();
        let first = if skew == 0.0 { chord_now } else { axis };
        poses.push(Pose { way: 0.0, front: front.point(), axis: first });
        let mut way = 0.0;
        let furthest = ways.last().map_or(0.0, |last| last.min(limit));
        if skew == 0.0 && rear.segment == front.segment && furthest <= front.room() {
            return front.straight_on(ways, limit, first, poses);
        }
        for &target in ways {
            let target = target.min(limit);
            while way < target {
                let mut next = target.min(way + front.room()).min(way + rear.room());
                if skew != 0.0 && way < length {
                    next = next.min(length);
                }
                // Rounding may leave a room too small to move by; the next point is then as good as reached.
                let step = (next - way).max(f64::EPSILON * self.end().max(1.0));
                let before = [(front.segment, front.way), (rear.segment, rear.way)];
                let before_axis = axis_of_last(poses, axis);
                front.advance(step);
                rear.advance(step);
                let after = skewed(chord(&front, &rear, before_axis), skew, way + step, length);
                let parts = if turns_less(&before_axis, &after, widest) {
                    1.0
                } else {
                    (turn(&before_axis, &after).abs() / widest).ceil().max(1.0)
                };
                for part in 1..parts as u32 {
                    let share = step * f64::from(part) / parts;
                    let [front, rear] = before.map(|(segment, way)| Cursor::at(self, segment, way + share));
                    let axis = skewed(chord(&front, &rear, before_axis), skew, way + share, length);
                    poses.push(Pose { way: way + share, front: front.point(), axis });
                }
                way += step;
                let pose = Pose { way, front: front.point(), axis: after };
                push_merged(poses, start, pose, ways);
            }
            if way >= limit {
                break;
            }
        }
    }
}

/// The axis of the last pose.
fn axis_of_last(poses: &[Pose], otherwise: Vector) -> Vector {
    poses.last().map_or(otherwise, |pose| pose.axis)
}

/// Adds a pose, in place of the last one where that lies on the straight line between its neighbours and is not one
/// of those that were asked for.
fn push_merged(poses: &mut Vec<Pose>, start: usize, pose: Pose, asked: &[Metre]) {
    if let [.., before, last] = &poses[start..]
        && last.axis == before.axis
        && (pose.axis - last.axis).norm() < SAME_DIRECTION
        && !asked.contains(&last.way)
        && (pose.front - before.front).norm() > (pose.way - before.way) * (1.0 - SAME_DIRECTION)
    {
        let index = poses.len() - 1;
        poses[index] = Pose { axis: before.axis, ..pose };
        return;
    }
    let axis = match poses.last() {
        Some(last) if (pose.axis - last.axis).norm() < SAME_DIRECTION => last.axis,
        _ => pose.axis,
    };
    poses.push(Pose { axis, ..pose });
}

fn skewed(chord: Vector, skew: Radian, way: Metre, length: Metre) -> Vector {
    if skew == 0.0 || way >= length { chord } else { rotated(&chord, skew * (1.0 - way / length)) }
}

/// The direction from the rear to the front; another where both are in one place (a hairpin of no width).
fn chord(front: &Cursor, rear: &Cursor, otherwise: Vector) -> Vector {
    (front.point() - rear.point()).try_normalize(1e-9).unwrap_or(otherwise)
}

/// Whether the angle from one direction to another is surely smaller than this one, without any trigonometry: an
/// angle is smaller than its tangent.
fn turns_less(from: &Vector, to: &Vector, angle: Radian) -> bool {
    /// Far more than rounding can add to either side.
    const SURELY: f64 = 1.0 - 1e-9;
    cross(from, to).abs() < from.dot(to) * (angle * SURELY)
}

/// A place on a track that moves ahead.
#[derive(Clone, Copy)]
struct Cursor<'a> {
    track: &'a Track,
    segment: usize,
    under: Segment,
    way: Metre,
}

impl<'a> Cursor<'a> {
    fn at(track: &'a Track, segment: usize, way: Metre) -> Self {
        Self { track, segment, under: track.part(segment), way }
    }

    /// Before the line's beginning and beyond its end, straight on.
    fn point(&self) -> Point {
        self.under.at(self.way)
    }

    /// Way to the next point of the line.
    fn room(&self) -> Metre {
        match self.track.corners.get(self.segment + 1) {
            Some(next) if self.segment + 2 < self.track.corners.len() => next.way - self.way,
            _ => f64::INFINITY,
        }
    }

    /// Adds the poses at these ways from here, all on this part of the line, as [`Track::poses`] has them.
    fn straight_on(mut self, ways: &[Metre], limit: Metre, axis: Vector, poses: &mut Vec<Pose>) {
        let mut way = 0.0;
        for target in ways.iter().map(|target| target.min(limit)) {
            if way < target {
                let step = target - way;
                self.way += step;
                way += step;
                poses.push(Pose { way, front: self.point(), axis });
            }
        }
    }

    fn advance(&mut self, way: Metre) {
        self.way += way;
        while self.room() <= f64::EPSILON * self.track.end() {
            self.segment += 1;
            self.under = self.track.part(self.segment);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(points: &[(f64, f64)], front: f64) -> Track {
        let mut track = Track::default();
        for &(x, y) in points {
            track.push(Point::new(x, y));
        }
        track.set_front(front);
        track
    }

    fn poses(track: &Track, ways: &[f64]) -> Vec<Pose> {
        let mut found = Vec::new();
        let front = Cursor::at(track, track.segment, track.front);
        let rear = Cursor::at(track, 0, track.front - 5.0);
        track.poses(chord(&front, &rear, Vector::x()), 5.0, ways, false, &mut found);
        found
    }

    #[test]
    fn a_straight_line_needs_only_the_poses_asked_for() {
        let line = track(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (100.0, 0.0)], 8.0);
        let ways: Vec<_> = poses(&line, &[30.0, 30.5]).iter().map(|pose| pose.way).collect();
        assert_eq!(ways, [0.0, 30.0, 30.5]);
    }

    #[test]
    fn front_and_rear_are_both_on_the_line_round_a_corner() {
        let corner = track(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        for pose in poses(&corner, &[10.0]) {
            let on_line = |way: f64| if way < 10.0 { Point::new(way, 0.0) } else { Point::new(10.0, way - 10.0) };
            let chord = on_line(8.0 + pose.way) - on_line(3.0 + pose.way);
            assert!((pose.front - on_line(8.0 + pose.way)).norm() < 1e-9);
            assert!((pose.axis - chord.normalize()).norm() < 1e-9, "{pose:?}");
        }
    }

    #[test]
    fn it_goes_straight_as_long_as_front_and_rear_are_on_one_part_of_the_line() {
        let corner = |front: f64| track(&[(0.0, 0.0), (30.0, 0.0), (30.0, 20.0)], front);
        assert!(corner(8.0).goes_straight(&Vector::x(), 5.0, 22.0));
        assert!(!corner(8.0).goes_straight(&Vector::x(), 5.0, 22.1), "the front comes round the corner");
        assert!(!corner(33.0).goes_straight(&Vector::y(), 5.0, 1.0), "the rear does");
        assert!(!corner(8.0).goes_straight(&rotated(&Vector::x(), 1e-5), 5.0, 1.0), "it changes lanes");
    }

    #[test]
    fn the_box_ahead_holds_every_front_and_no_more() {
        let corner = |front: f64| track(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0), (0.0, 20.0)], front);
        for (front, way) in [(2.0, 3.0), (8.0, 10.0), (8.0, 30.0), (12.0, 5.0), (8.0, 100.0)] {
            let (line, mut fronts) = (corner(front), Bounds::EMPTY);
            poses(&line, &[way]).iter().for_each(|pose| fronts.include(pose.front));
            assert_eq!(line.bounds_ahead(way), fronts, "{way} m from {front} m on");
        }
    }

    #[test]
    fn the_path_ends_where_the_line_ends() {
        let line = track(&[(0.0, 0.0), (20.0, 0.0)], 8.0);
        assert_eq!(poses(&line, &[30.0, 30.5]).last().unwrap().way, 12.0);
    }

    #[test]
    fn another_heading_fades_out_over_the_length() {
        let line = track(&[(0.0, 0.0), (100.0, 0.0)], 20.0);
        let mut found = Vec::new();
        line.poses(rotated(&Vector::x(), 0.1), 5.0, &[30.0], false, &mut found);
        assert!((turn(&Vector::x(), &found[0].axis) - 0.1).abs() < 1e-12);
        assert!(found.iter().filter(|pose| pose.way >= 5.0).all(|pose| pose.axis.y.abs() < 1e-12));
    }

    #[test]
    fn it_is_followed_as_long_as_the_front_is_on_it() {
        let mut corner = track(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        assert!(corner.follow(Point::new(9.5, 0.0)));
        assert!(corner.follow(Point::new(10.0, 3.0)));
        assert_eq!(corner.front(), 13.0);
        assert!(!corner.follow(Point::new(11.0, 4.0)));
    }

    #[test]
    fn who_drives_back_on_it_is_not_on_it() {
        let mut line = track(&[(0.0, 0.0), (100.0, 0.0)], 50.0);
        assert!(line.follow(Point::new(49.99, 0.0)), "a rounded position");
        assert!(!line.follow(Point::new(49.0, 0.0)));
    }

    #[test]
    fn where_the_line_turns_back_the_front_has_been() {
        let back = track(&[(0.0, 0.0), (50.0, 0.0), (47.0, 0.0)], 40.0);
        assert!(poses(&back, &[13.0]).iter().any(|pose| pose.front == Point::new(50.0, 0.0)));
    }

    #[test]
    fn repeated_points_and_a_turn_back_are_no_trouble() {
        let back = track(&[(0.0, 0.0), (0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (0.0, 0.0)], 8.0);
        let found = poses(&back, &[6.0, 8.0]);
        assert!(found.iter().all(|pose| (pose.axis.norm() - 1.0).abs() < 1e-9));
        assert!(found.windows(2).all(|pair| pair[0].way < pair[1].way));
    }
}
