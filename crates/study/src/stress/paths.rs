//! Degenerate lines, which no net should have but some do, and the poses along them.

use std::path::Path;
use std::sync::Arc;

use super::cars::CarRun;
use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::chance::Chance;
use crate::reference::contact::distance_to_line;
use crate::reference::nearest;
use closecall::detection::path::Pose;
use closecall::detection::path::track::Track;
use closecall::geometry::polylines::Lines;
use closecall::geometry::{Point, Vector};
use closecall::traffic::frame::State;
use closecall::traffic::placement::Placement;
use closecall::traffic::profile::Carriage;
use closecall::util::units::{Metre, MetrePerSecond};

const UNIT: Property = Property::within("axis a unit vector", 1e-12, Unit::Metre);
const ASCENDING: Property = Property::always("distances ascend to the line's end");
const ON_LINE: Property = Property::within("front bumper on the line, in ulps of the position", 64.0, Unit::Ulps);
const EVEN: Property =
    Property::within("distance equal to the line's length, in ulps of the position", 64.0, Unit::Ulps);
const FINITE: Property = Property::always("paths end, every value a finite number");
const BOUNDED: Property = Property::always("no more poses than the line has points and turns");

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Paths, "lanes of length 0, repeated points", |chance, tally| {
        let mut points = winding(chance, 1.0, 100.0);
        for _ in 0..10 {
            let at = chance.below(points.len());
            // Some are closer than the tolerance at which a front bumper counts as on the line.
            let near = Vector::new(chance.pick(&[0.0, 1e-9, 5e-4]), 0.0);
            points.insert(at, points[at] + near);
        }
        check(chance, &points, tally);
    })
    .costing(10),
    Case::new(Group::Paths, "joints that turn by 180 degrees", |chance, tally| {
        let mut points = winding(chance, 1.0, 50.0);
        let at = chance.below(points.len() - 2) + 1;
        let back = points[at - 1];
        points.insert(at + 1, back);
        check(chance, &points, tally);
    })
    .costing(10),
    Case::new(Group::Paths, "a net of a million metres", |chance, tally| {
        let mut points = winding(chance, 1e3, 1e5);
        let by = Vector::new(chance.between(-1e6, 1e6), chance.between(-1e6, 1e6));
        points.iter_mut().for_each(|point| *point += by);
        check(chance, &points, tally);
    })
    .costing(10),
    Case::new(Group::Paths, "points millimetres apart", |chance, tally| {
        let points = winding(chance, 1e-3, 1e-1);
        check(chance, &points, tally);
    })
    .costing(10),
    Case::new(Group::Paths, "a net of lanes without length", |chance, tally| {
        let degenerate = [chance.below(4), chance.below(4)];
        let position = chance.between(0.0, 60.0);
        let speed = chance.between(0.0, 60.0);
        let found = along_a_ring(degenerate, position, speed);
        tally.holds(FINITE, found, &(degenerate, position, speed));
    })
    .costing(20),
];

/// Two cars, one behind the other, on a ring of four lanes of which some have no length.
fn along_a_ring(degenerate: [usize; 2], position: Metre, speed: MetrePerSecond) -> bool {
    let corners = [(0.0, 0.0), (60.0, 0.0), (60.0, 60.0), (0.0, 60.0)];
    let mut text = String::from("<net>");
    for (index, (x, y)) in corners.iter().enumerate() {
        let (to_x, to_y) = if degenerate.contains(&index) { (*x, *y) } else { corners[(index + 1) % 4] };
        let length = if degenerate.contains(&index) { 0.0 } else { 60.0 };
        text += &format!(
            "<edge id='e{index}' from='j{index}' to='j'><lane id='e{index}_0' index='0' length='{length}' shape='{x},{y} {to_x},{to_y}'/></edge>"
        );
    }
    for index in 0..4 {
        let to = (index + 1) % 4;
        text += &format!("<connection from='e{index}' to='e{to}' fromLane='0' toLane='0'/>");
    }
    let Ok(net) = closecall_run::net::parse(Path::new("ring.net.xml"), text + "</net>") else { return false };
    let Some(lane) = net.lane("e0_0") else { return false };
    let placement = Placement { lane, position, route: None, route_position: 0, lateral_speed: 0.0 };
    let Ok(mut scene) = CarRun::new(Some(Arc::new(net))) else { return false };
    let users = [scene.enter("leader"), scene.enter("follower")];
    for step in 0..3 {
        let x = position + f64::from(step) * speed;
        let at = |x: Metre| State { x, y: 0.0, z: 0.0, heading: 0.0, speed };
        scene.step_placed(f64::from(step), &[(users[0], at(x)), (users[1], at(x - 10.0))], &placement);
    }
    scene.finite
}

/// The number of poses that are compared with their line.
const SAMPLES: usize = 4;

/// A line of up to thirty points, `least` to `most` apart, that turns by up to 1 rad at each.
fn winding(chance: &mut Chance, least: Metre, most: Metre) -> Vec<Point> {
    let mut at = Point::new(chance.between(-1e3, 1e3), chance.between(-1e3, 1e3));
    let mut heading = chance.angle();
    let mut points = vec![at];
    for _ in 0..chance.below(28) + 3 {
        heading += chance.between(-1.0, 1.0);
        at += Vector::new(heading.cos(), heading.sin()) * chance.magnitude(least, most);
        points.push(at);
    }
    points
}

fn check(chance: &mut Chance, points: &[Point], tally: &mut Tally) {
    let lines = Lines::through(points.iter().copied());
    if lines.line(0).len() < 2 {
        return;
    }
    let mut track = Track::default();
    let whole = lines.length(0);
    track.begin(&lines, 0, whole * chance.between(0.0, 1.0));
    let room = track.ahead();
    let length = chance.between(0.5, 20.0);
    let distances = [room * chance.between(0.0, 1.0), room];
    let mut poses = Vec::new();
    track.poses(&lines, Vector::x(), Carriage { behind: 0.0, length }, &distances, false, &mut poses);
    let inputs = (points, track.front(), length, distances);
    let unit = poses.iter().map(|pose| (pose.axis.norm() - 1.0).abs()).fold(0.0, worse);
    tally.error(UNIT, unit, &inputs);
    let ascending = poses.windows(2).all(|pair| pair[0].distance < pair[1].distance);
    let last = poses.last().map_or(f64::NAN, |pose| pose.distance);
    tally.holds(ASCENDING, ascending && (last - room).abs() <= 1e-9 * whole.max(1.0), &inputs);
    // A track omits points within a millimetre of the last one, so its line may deviate by a millimetre.
    let kept = track_points(points);
    // High precision is slow: only some poses of every line.
    let some = (0..SAMPLES).filter_map(|_| poses.get(chance.below(poses.len())).copied()).collect::<Vec<_>>();
    let off = some.iter().map(|pose| ulps_off(pose, &kept)).fold(0.0, worse);
    tally.error(ON_LINE, off, &inputs);
    let uneven = |pair: &[Pose]| (pair[1].front - pair[0].front).norm() - (pair[1].distance - pair[0].distance);
    let uneven = poses.windows(2).map(|pair| uneven(pair).abs() / ulp(&kept)).fold(0.0, worse);
    tally.error(EVEN, uneven, &inputs);
    // Both bumpers turn at every point, by at most half a turn, in steps of a few hundredths of a rad.
    tally.holds(BOUNDED, poses.len() < 4 * 100 * points.len(), &inputs);
}

/// The points that a track keeps.
fn track_points(points: &[Point]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for point in points {
        if kept.last().is_none_or(|last| (point - last).norm() >= 1e-3) {
            kept.push(*point);
        }
    }
    kept
}

fn ulps_off(pose: &Pose, line: &[Point]) -> f64 {
    nearest(&distance_to_line(pose.front, line)) / ulp(line)
}

/// A unit in the last place of the largest coordinate or distance along the line.
fn ulp(line: &[Point]) -> f64 {
    let length = line.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>();
    line.iter().map(|point| point.coords.amax()).fold(length.max(1.0), f64::max) * f64::EPSILON
}

/// The larger of two errors; a NaN is the largest.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}
