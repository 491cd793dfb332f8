//! Along a line on the ground: the poses of a road user whose front and rear bumper are both on it.

use super::track::{Cursor, Track};
use super::{Pose, largest_turn, rotated, turn};
use crate::geometry::polylines::{Lines, ON_THE_LINE};
use crate::geometry::{Point, Vector, cross};
use crate::util::units::{Metre, Radian};

/// A heading that differs by less than this from the line's chord is the chord, in rad.
const SAME_HEADING: Radian = 1e-6;
/// Directions that differ by less than this are one: poses in between say nothing.
const SAME_DIRECTION: f64 = 1e-10;

impl Track {
    /// Whether a road user of this length and heading drives straight on for so long, along the part of the line that it
    /// is on now; `false` also where that takes looking further ahead to know.
    pub fn goes_straight(&self, lines: &Lines, axis: &Vector, length: Metre, way: Metre) -> bool {
        let under = lines.segment(self.corner);
        self.front - length >= under.way
            && self.front + way <= under.end
            && turns_less(&under.direction, axis, SAME_HEADING)
    }

    /// How far the way of who goes straight, so long as this, lies at most beside where it heads: as far as it may be off
    /// the line now and as its heading takes it, and twice that, for rounding.
    pub fn beside_heading(way: Metre) -> Metre {
        2.0 * (ON_THE_LINE + SAME_HEADING * way)
    }

    /// Adds the poses at the given ways ahead of the front bumper (ascending, from 0 on), where the line's points
    /// make the road user turn, and as many between as the sweep's tolerance needs. Ends where the line ends, unless
    /// `beyond`: then it goes straight on from there.
    ///
    /// `axis` is the heading of now. Where it differs from the chord (a lane change, a rear on a lane that is not
    /// known) the difference fades out over the road user's own length.
    pub fn poses(
        &self,
        lines: &Lines,
        axis: Vector,
        length: Metre,
        ways: &[Metre],
        beyond: bool,
        poses: &mut Vec<Pose>,
    ) {
        let limit = if beyond { f64::INFINITY } else { self.ahead() };
        let mut front = self.cursor(lines);
        let mut rear = front.back(length);
        let chord_now = chord(front.point(), rear.point(), axis);
        let skew = if turns_less(&chord_now, &axis, SAME_HEADING) { 0.0 } else { turn(&chord_now, &axis) };
        let skew = if skew.abs() < SAME_HEADING { 0.0 } else { skew };
        let widest = largest_turn(length);
        let start = poses.len();
        let first = if skew == 0.0 { chord_now } else { axis };
        poses.push(Pose { way: 0.0, front: front.point(), axis: first });
        let mut way = 0.0;
        let furthest = ways.last().map_or(0.0, |last| last.min(limit));
        if skew == 0.0 && rear.corner == front.corner && furthest <= front.room() {
            return straight_on(front, ways, limit, first, poses);
        }
        let least = f64::EPSILON * self.length(lines).max(1.0);
        for &target in ways {
            let target = target.min(limit);
            while way < target {
                let mut next = target.min(way + front.room()).min(way + rear.room());
                if skew != 0.0 && way < length {
                    next = next.min(length);
                }
                // Rounding may leave a room too small to move by; the next point is then as good as reached.
                let step = (next - way).max(least);
                let before = [(front.under, front.way), (rear.under, rear.way)];
                let before_axis = axis_of_last(poses, axis);
                advance(&mut front, step, least);
                advance(&mut rear, step, least);
                let after = skewed(chord(front.point(), rear.point(), before_axis), skew, way + step, length);
                let parts = if turns_less(&before_axis, &after, widest) {
                    1.0
                } else {
                    (turn(&before_axis, &after).abs() / widest).ceil().max(1.0)
                };
                for part in 1..parts as u32 {
                    let share = step * f64::from(part) / parts;
                    let [front, rear] = before.map(|(under, way)| under.at(way + share));
                    let axis = skewed(chord(front, rear, before_axis), skew, way + share, length);
                    poses.push(Pose { way: way + share, front, axis });
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
fn chord(front: Point, rear: Point, otherwise: Vector) -> Vector {
    (front - rear).try_normalize(1e-9).unwrap_or(otherwise)
}

/// Whether the angle from one direction to another is surely smaller than this one, without any trigonometry: an
/// angle is smaller than its tangent.
fn turns_less(from: &Vector, to: &Vector, angle: Radian) -> bool {
    /// Far more than rounding can add to either side.
    const SURELY: f64 = 1.0 - 1e-9;
    cross(from, to).abs() < from.dot(to) * (angle * SURELY)
}

/// Adds the poses at these ways from here, all on this part of the line, as [`Track::poses`] has them.
fn straight_on(mut front: Cursor, ways: &[Metre], limit: Metre, axis: Vector, poses: &mut Vec<Pose>) {
    let mut way = 0.0;
    for target in ways.iter().map(|target| target.min(limit)) {
        if way < target {
            let step = target - way;
            front.way += step;
            way += step;
            poses.push(Pose { way, front: front.point(), axis });
        }
    }
}

/// Moves on; where no more than `least` is left to the next corner, as good as past that.
fn advance(place: &mut Cursor, way: Metre, least: Metre) {
    place.way += way;
    while place.room() <= least {
        place.go_on();
    }
}

#[cfg(test)]
mod tests {
    use crate::detection::path::poses::*;
    use crate::geometry::Bounds;

    fn poses((track, lines): &(Track, Lines), ways: &[f64]) -> Vec<Pose> {
        let mut found = Vec::new();
        let front = track.cursor(lines);
        track.poses(lines, chord(front.point(), front.back(5.0).point(), Vector::x()), 5.0, ways, false, &mut found);
        found
    }

    #[test]
    fn a_straight_line_needs_only_the_poses_asked_for() {
        let line = Track::through(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (100.0, 0.0)], 8.0);
        let ways: Vec<_> = poses(&line, &[30.0, 30.5]).iter().map(|pose| pose.way).collect();
        assert_eq!(ways, [0.0, 30.0, 30.5]);
    }

    #[test]
    fn front_and_rear_are_both_on_the_line_round_a_corner() {
        let corner = Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        for pose in poses(&corner, &[10.0]) {
            let on_line = |way: f64| if way < 10.0 { Point::new(way, 0.0) } else { Point::new(10.0, way - 10.0) };
            let chord = on_line(8.0 + pose.way) - on_line(3.0 + pose.way);
            assert!((pose.front - on_line(8.0 + pose.way)).norm() < 1e-9);
            assert!((pose.axis - chord.normalize()).norm() < 1e-9, "{pose:?}");
        }
    }

    #[test]
    fn it_goes_straight_as_long_as_front_and_rear_are_on_one_part_of_the_line() {
        let goes_straight = |front: f64, axis: Vector, way: f64| {
            let (track, lines) = Track::through(&[(0.0, 0.0), (30.0, 0.0), (30.0, 20.0)], front);
            track.goes_straight(&lines, &axis, 5.0, way)
        };
        assert!(goes_straight(8.0, Vector::x(), 22.0));
        assert!(!goes_straight(8.0, Vector::x(), 22.1), "the front comes round the corner");
        assert!(!goes_straight(33.0, Vector::y(), 1.0), "the rear does");
        assert!(!goes_straight(8.0, rotated(&Vector::x(), 1e-5), 1.0), "it changes lanes");
    }

    #[test]
    fn the_box_ahead_holds_every_front_and_no_more() {
        let corner = |front: f64| Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0), (0.0, 20.0)], front);
        for (front, way) in [(2.0, 3.0), (8.0, 10.0), (8.0, 30.0), (12.0, 5.0), (8.0, 100.0)] {
            let (line, mut fronts) = (corner(front), Bounds::EMPTY);
            poses(&line, &[way]).iter().for_each(|pose| fronts.include(pose.front));
            assert_eq!(line.0.bounds_ahead(&line.1, way), fronts, "{way} m from {front} m on");
        }
    }

    #[test]
    fn the_path_ends_where_the_line_ends() {
        let line = Track::through(&[(0.0, 0.0), (20.0, 0.0)], 8.0);
        assert_eq!(poses(&line, &[30.0, 30.5]).last().unwrap().way, 12.0);
    }

    #[test]
    fn another_heading_fades_out_over_the_length() {
        let (track, lines) = Track::through(&[(0.0, 0.0), (100.0, 0.0)], 20.0);
        let mut found = Vec::new();
        track.poses(&lines, rotated(&Vector::x(), 0.1), 5.0, &[30.0], false, &mut found);
        assert!((turn(&Vector::x(), &found[0].axis) - 0.1).abs() < 1e-12);
        assert!(found.iter().filter(|pose| pose.way >= 5.0).all(|pose| pose.axis.y.abs() < 1e-12));
    }

    #[test]
    fn where_the_line_turns_back_the_front_has_been() {
        let back = Track::through(&[(0.0, 0.0), (50.0, 0.0), (47.0, 0.0)], 40.0);
        assert!(poses(&back, &[13.0]).iter().any(|pose| pose.front == Point::new(50.0, 0.0)));
    }

    #[test]
    fn repeated_points_and_a_turn_back_are_no_trouble() {
        let back = Track::through(&[(0.0, 0.0), (0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (0.0, 0.0)], 8.0);
        let found = poses(&back, &[6.0, 8.0]);
        assert!(found.iter().all(|pose| (pose.axis.norm() - 1.0).abs() < 1e-9));
        assert!(found.windows(2).all(|pair| pair[0].way < pair[1].way));
    }
}
