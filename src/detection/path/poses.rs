//! The poses of a road user whose front and rear bumpers are both on a polyline.

use super::cursor::Cursor;
use super::track::{SAME_DIRECTION, Track};
use super::{Pose, chord, largest_turn, rotated, turn};
use crate::geometry::polylines::{Lines, ON_THE_LINE};
use crate::geometry::{Vector, cross};
use crate::traffic::profile::Carriage;
use crate::util::units::{Metre, Radian};

/// A heading that differs from the chord by less than this counts as the chord, in rad.
const SAME_HEADING: Radian = 1e-6;
/// Relative difference between a movement and the distance along a stretched line: more than rounding, and less than where
/// a lane of 20 km is 2 cm longer than drawn.
const STRETCHED: f64 = 1e-6;

impl Track {
    /// Whether a road user of this length and heading drives straight on for a distance, within the segment that it is
    /// on now; `false` also where only the next segments could tell.
    pub(crate) fn goes_straight(&self, lines: &Lines, axis: &Vector, length: Metre, distance: Metre) -> bool {
        let under = lines.segment(self.vertex);
        self.front - length >= under.begins_at
            && self.front + distance <= under.ends_at
            && turns_less(&under.direction, axis, SAME_HEADING)
            && under.is_to_scale()
    }

    /// Bound on how far a straight path of this length deviates from the heading: by the distance from the line now and
    /// the difference in heading, doubled for rounding.
    pub(crate) fn beside_heading(distance: Metre) -> Metre {
        2.0 * (ON_THE_LINE + SAME_HEADING * distance)
    }

    /// Adds the poses at the given distances ahead of the front bumper (ascending, from 0 on), at the vertices that
    /// make the road user turn, and as many between as a turn needs. They end where the line ends,
    /// unless `beyond` is set: then they go straight on from there.
    ///
    /// `axis` is the current heading. Where it differs from the chord (a lane change, a rear on an unknown lane), the
    /// difference fades out over the road user's length. A carriage that begins further `behind` the front bumper has no
    /// heading of its own: it stands along the chord. Distances are the front bumper's.
    pub fn poses(
        &self,
        lines: &Lines,
        axis: Vector,
        Carriage { behind, length }: Carriage,
        distances: &[Metre],
        beyond: bool,
        poses: &mut Vec<Pose>,
    ) {
        let limit = if beyond { f64::INFINITY } else { self.ahead() };
        let mut front = self.behind(lines, behind);
        let mut rear = front.back(length);
        let chord_now = chord(front.point(), rear.point(), axis);
        let along = behind > 0.0 || turns_less(&chord_now, &axis, SAME_HEADING);
        let skew = if along { 0.0 } else { turn(&chord_now, &axis) };
        let skew = if skew.abs() < SAME_HEADING { 0.0 } else { skew };
        let widest = largest_turn(length);
        let start = poses.len();
        let first = if skew == 0.0 { chord_now } else { axis };
        poses.push(Pose { distance: 0.0, front: front.point(), axis: first });
        let mut distance = 0.0;
        let furthest = distances.last().map_or(0.0, |last| last.min(limit));
        if skew == 0.0 && rear.vertex == front.vertex && furthest <= front.room() {
            return add_straight_poses(front, distances, limit, first, poses);
        }
        let least = f64::EPSILON * self.length(lines).max(1.0);
        for &target in distances {
            let target = target.min(limit);
            while distance < target {
                let mut next = target.min(distance + front.room()).min(distance + rear.room());
                if skew != 0.0 && distance < length {
                    next = next.min(length);
                }
                // Rounding may leave a room too small to move by; the next vertex then counts as reached.
                let step = (next - distance).max(least);
                let before = [(front.under, front.distance), (rear.under, rear.distance)];
                let before_axis = axis_of_last(poses, axis);
                advance(&mut front, step, least);
                advance(&mut rear, step, least);
                let after = skewed(chord(front.point(), rear.point(), before_axis), skew, distance + step, length);
                let parts = if turns_less(&before_axis, &after, widest) {
                    1.0
                } else {
                    (turn(&before_axis, &after).abs() / widest).ceil().max(1.0)
                };
                for part in 1..parts as u32 {
                    let share = step * f64::from(part) / parts;
                    let [front, rear] = before.map(|(under, distance)| under.at(distance + share));
                    let axis = skewed(chord(front, rear, before_axis), skew, distance + share, length);
                    poses.push(Pose { distance: distance + share, front, axis });
                }
                distance += step;
                let pose = Pose { distance, front: front.point(), axis: after };
                push_merged(poses, start, pose, distances);
            }
            if distance >= limit {
                break;
            }
        }
    }
}

/// The axis of the last pose.
fn axis_of_last(poses: &[Pose], otherwise: Vector) -> Vector {
    poses.last().map_or(otherwise, |pose| pose.axis)
}

/// Adds a pose. It replaces the last one if that lies on the straight line between its neighbours and is not at an
/// asked distance. Where a metre of the line is not one of the plane, that may change at any vertex, so all poses stay.
fn push_merged(poses: &mut Vec<Pose>, start: usize, pose: Pose, asked: &[Metre]) {
    if let [.., before, last] = &poses[start..]
        && last.axis == before.axis
        && (pose.axis - last.axis).norm() < SAME_DIRECTION
        && !asked.contains(&last.distance)
        && let moved = (pose.front - before.front).norm()
        && moved > (pose.distance - before.distance) * (1.0 - SAME_DIRECTION)
        && moved < (pose.distance - before.distance) * (1.0 + STRETCHED)
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

fn skewed(chord: Vector, skew: Radian, distance: Metre, length: Metre) -> Vector {
    if skew == 0.0 || distance >= length { chord } else { rotated(&chord, skew * (1.0 - distance / length)) }
}

/// Whether the angle between two directions is certainly smaller than `angle`, without trigonometry: an angle is
/// smaller than its tangent.
fn turns_less(from: &Vector, to: &Vector, angle: Radian) -> bool {
    /// A margin far above rounding errors.
    const SURELY: f64 = 1.0 - 1e-9;
    cross(from, to).abs() < from.dot(to) * (angle * SURELY)
}

/// Adds the poses at these distances, all on one segment, as [`Track::poses`] does.
fn add_straight_poses(mut front: Cursor, distances: &[Metre], limit: Metre, axis: Vector, poses: &mut Vec<Pose>) {
    let mut distance = 0.0;
    for target in distances.iter().map(|target| target.min(limit)) {
        if distance < target {
            let step = target - distance;
            front.distance += step;
            distance += step;
            poses.push(Pose { distance, front: front.point(), axis });
        }
    }
}

/// Moves on by a distance, and past the next vertex if at most `least` is left to it.
fn advance(place: &mut Cursor, distance: Metre, least: Metre) {
    place.distance += distance;
    while place.room() <= least {
        place.enter_next();
    }
}

#[cfg(test)]
mod tests {
    use crate::detection::path::poses::*;
    use crate::geometry::{Bounds, Point};

    const CAR: Carriage = Carriage { behind: 0.0, length: 5.0 };

    fn poses((track, lines): &(Track, Lines), distances: &[f64]) -> Vec<Pose> {
        let mut found = Vec::new();
        let front = track.cursor(lines);
        track.poses(
            lines,
            chord(front.point(), front.back(5.0).point(), Vector::x()),
            CAR,
            distances,
            false,
            &mut found,
        );
        found
    }

    #[test]
    fn a_straight_line_needs_only_the_poses_asked_for() {
        let line = Track::through(&[(0.0, 0.0), (10.0, 0.0), (20.0, 0.0), (30.0, 0.0), (100.0, 0.0)], 8.0);
        let distances: Vec<_> = poses(&line, &[30.0, 30.5]).iter().map(|pose| pose.distance).collect();
        assert_eq!(distances, [0.0, 30.0, 30.5]);
    }

    #[test]
    fn round_a_corner_front_and_rear_are_on_the_line() {
        let corner = Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0)], 8.0);
        for pose in poses(&corner, &[10.0]) {
            let on_line = |distance: f64| {
                if distance < 10.0 { Point::new(distance, 0.0) } else { Point::new(10.0, distance - 10.0) }
            };
            let chord = on_line(8.0 + pose.distance) - on_line(3.0 + pose.distance);
            assert!((pose.front - on_line(8.0 + pose.distance)).norm() < 1e-9);
            assert!((pose.axis - chord.normalize()).norm() < 1e-9, "{pose:?}");
        }
    }

    #[test]
    fn it_goes_straight_while_front_and_rear_share_a_segment() {
        let goes_straight = |front: f64, axis: Vector, distance: f64| {
            let (track, lines) = Track::through(&[(0.0, 0.0), (30.0, 0.0), (30.0, 20.0)], front);
            track.goes_straight(&lines, &axis, 5.0, distance)
        };
        assert!(goes_straight(8.0, Vector::x(), 22.0));
        assert!(!goes_straight(8.0, Vector::x(), 22.1), "the front comes round the corner");
        assert!(!goes_straight(33.0, Vector::y(), 1.0), "the rear does");
        assert!(!goes_straight(8.0, rotated(&Vector::x(), 1e-5), 1.0), "it changes lanes");
    }

    #[test]
    fn the_box_ahead_holds_every_front_and_no_more() {
        let corner = |front: f64| Track::through(&[(0.0, 0.0), (10.0, 0.0), (10.0, 20.0), (0.0, 20.0)], front);
        for (front, distance) in [(2.0, 3.0), (8.0, 10.0), (8.0, 30.0), (12.0, 5.0), (8.0, 100.0)] {
            let (line, mut fronts) = (corner(front), Bounds::EMPTY);
            poses(&line, &[distance]).iter().for_each(|pose| fronts.include(pose.front));
            assert_eq!(line.0.bounds(&line.1, 0.0, distance), fronts, "{distance} m from {front} m on");
        }
    }

    #[test]
    fn the_path_ends_where_the_line_ends() {
        let line = Track::through(&[(0.0, 0.0), (20.0, 0.0)], 8.0);
        assert_eq!(poses(&line, &[30.0, 30.5]).last().unwrap().distance, 12.0);
    }

    #[test]
    fn another_heading_fades_out_over_the_length() {
        let (track, lines) = Track::through(&[(0.0, 0.0), (100.0, 0.0)], 20.0);
        let mut found = Vec::new();
        track.poses(&lines, rotated(&Vector::x(), 0.1), CAR, &[30.0], false, &mut found);
        assert!((turn(&Vector::x(), &found[0].axis) - 0.1).abs() < 1e-12);
        assert!(found.iter().filter(|pose| pose.distance >= 5.0).all(|pose| pose.axis.y.abs() < 1e-12));
    }

    #[test]
    fn a_carriage_goes_where_the_first_one_went() {
        let corner = |front: f64| Track::through(&[(0.0, 0.0), (30.0, 0.0), (30.0, 20.0), (10.0, 40.0)], front);
        let poses = |(track, lines): (Track, Lines), behind: f64| {
            let (mut found, carriage) = (Vec::new(), Carriage { behind, length: 5.0 });
            let front = track.cursor(&lines).back(behind);
            let axis = chord(front.point(), front.back(5.0).point(), Vector::x());
            track.poses(&lines, if behind > 0.0 { Vector::y() } else { axis }, carriage, &[20.0], false, &mut found);
            found
        };
        let [first, later] = [poses(corner(22.0), 0.0), poses(corner(40.0), 18.0)];
        assert_eq!(first.len(), later.len());
        for (first, later) in first.iter().zip(&later) {
            assert!((first.distance - later.distance).abs() < 1e-9);
            assert!(
                (first.front - later.front).norm() + (first.axis - later.axis).norm() < 1e-9,
                "{first:?} {later:?}"
            );
        }
    }

    #[test]
    fn where_the_line_turns_back_the_front_has_been() {
        let back = Track::through(&[(0.0, 0.0), (50.0, 0.0), (47.0, 0.0)], 40.0);
        assert!(poses(&back, &[13.0]).iter().any(|pose| pose.front == Point::new(50.0, 0.0)));
    }

    #[test]
    fn repeated_points_and_a_turn_back_do_no_harm() {
        let back = Track::through(&[(0.0, 0.0), (0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (0.0, 0.0)], 8.0);
        let found = poses(&back, &[6.0, 8.0]);
        assert!(found.iter().all(|pose| (pose.axis.norm() - 1.0).abs() < 1e-9));
        assert!(found.windows(2).all(|pair| pair[0].distance < pair[1].distance));
    }
}
