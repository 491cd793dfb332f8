//! One road user of a pair at the worst step, as a drawing needs it: position, size and planned path.

use std::sync::Arc;

use crate::geometry::Point;
use crate::traffic::frame::State;
use crate::traffic::profile::Profile;
use crate::util::units::{Metre, Radian};

/// A point of a path nearer than this to the line between its neighbours is left out, in m: a drawing does not show it.
const DRAWN: Metre = 0.05;

/// One road user of a conflict at the step with the smallest margin.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Front-bumper centre; a corner of an obstacle.
    pub front: Point,
    /// Direction from the rear to the front bumper, in rad counter-clockwise from +x.
    pub heading: Radian,
    /// Length in m; 0 for an obstacle.
    pub length: Metre,
    /// Width in m; 0 for an obstacle.
    pub width: Metre,
    /// The path of its front bumper from here until it has braked to a stand, and ε further; empty where it stands.
    pub path: Arc<[Point]>,
}

impl Snapshot {
    /// A road user of this type in this state, its front bumper about to go along these points.
    pub(super) fn of(state: &State, profile: &Profile, points: &[Point]) -> Self {
        let front = state.front();
        let path = drawn(&front, points).into();
        Self { front, heading: state.heading, length: profile.length, width: profile.width, path }
    }
}

/// The points after the first that a drawing needs; none where the road user stands.
fn drawn(front: &Point, points: &[Point]) -> Vec<Point> {
    let mut kept = Vec::new();
    if points.iter().any(|point| (point - front).norm() > DRAWN) {
        simplify(points, &mut kept);
    }
    kept
}

/// Ramer, Douglas and Peucker: adds the points that keep a line within [`DRAWN`], without the first.
fn simplify(points: &[Point], kept: &mut Vec<Point>) {
    let [first, between @ .., last] = points else { return };
    let furthest = (1..).zip(between).map(|(index, point)| (index, distance(point, first, last)));
    match furthest.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((index, distance)) if distance > DRAWN => {
            simplify(&points[..=index], kept);
            simplify(&points[index..], kept);
        }
        _ => kept.push(*last),
    }
}

/// The distance of a point from the line between two others.
fn distance(point: &Point, from: &Point, to: &Point) -> Metre {
    let (line, aside) = (to - from, point - from);
    let length = line.norm_squared();
    let part = if length > 0.0 { (aside.dot(&line) / length).clamp(0.0, 1.0) } else { 0.0 };
    (aside - line * part).norm()
}

#[cfg(test)]
mod tests {
    use crate::events::snapshot::*;

    fn path(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let points = points.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>();
        drawn(&points[0], &points).iter().map(|point| (point.x, point.y)).collect()
    }

    #[test]
    fn a_straight_path_is_its_end() {
        assert_eq!(path(&[(0.0, 0.0), (10.0, 0.01), (20.0, 0.0)]), [(20.0, 0.0)]);
    }

    #[test]
    fn a_corner_stays() {
        assert_eq!(path(&[(0.0, 0.0), (5.0, 0.0), (10.0, 0.0), (10.0, 9.0)]), [(10.0, 0.0), (10.0, 9.0)]);
    }

    #[test]
    fn a_standing_road_user_has_no_path() {
        assert_eq!(path(&[(0.0, 0.0), (0.0, 0.0)]), []);
        assert_eq!(path(&[(0.0, 0.0)]), []);
    }
}
