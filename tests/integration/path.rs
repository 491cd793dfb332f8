//! Following a line gives the same distances, to the last bit, as searching all of it in every step.

use closecall::Point;
use closecall::detection::path::track::Track;
use closecall::geometry::Vector;
use closecall::geometry::polylines::Lines;
use closecall::traffic::profile::Carriage;
use proptest::prelude::*;

/// A front bumper nearer than this to the line is on it, in m.
const ON_THE_LINE: f64 = 1e-3;
/// A road user that moves back by more than this has left the line, in m.
const BACKWARDS: f64 = 0.02;

/// A polyline and a place on it, without optimisations: the reference.
struct Line {
    points: Vec<Point>,
    distances: Vec<f64>,
    segment: usize,
    front: f64,
}

impl Line {
    fn follow(&mut self, front: Point) -> bool {
        let direction = |from: usize| {
            (self.points[from + 1] - self.points[from]) / (self.distances[from + 1] - self.distances[from])
        };
        let last = self.points[self.segment] + direction(self.segment) * (self.front - self.distances[self.segment]);
        let furthest = self.front + 4.0 * (front - last).norm() + ON_THE_LINE;
        let found = (self.segment..self.points.len() - 1)
            .take_while(|&from| self.distances[from] <= furthest)
            .find_map(|from| {
                let along = (front - self.points[from]).dot(&direction(from));
                let aside = (front - (self.points[from] + direction(from) * along)).norm_squared();
                let is_on = along <= self.distances[from + 1] - self.distances[from]
                    && along >= -ON_THE_LINE
                    && aside <= ON_THE_LINE * ON_THE_LINE;
                is_on.then_some((from, along))
            });
        let before = self.front;
        if let Some((segment, along)) = found {
            (self.segment, self.front) = (segment, self.distances[segment] + along.max(0.0));
        }
        found.is_some() && self.front >= before - BACKWARDS
    }

    /// The point at a distance, `aside` to the left.
    fn at(&self, distance: f64, aside: f64) -> Point {
        let from = self.distances.partition_point(|&start| start <= distance).clamp(1, self.points.len() - 1) - 1;
        let direction = (self.points[from + 1] - self.points[from]) / (self.distances[from + 1] - self.distances[from]);
        self.points[from]
            + direction * (distance - self.distances[from])
            + Vector::new(-direction.y, direction.x) * aside
    }
}

proptest! {
    #[test]
    fn following_a_line_equals_searching_all_of_it(
        turns in prop::collection::vec((-2.5..2.5, 0.01..40.0), 2..20),
        begin in 0.0..1.0,
        moves in prop::collection::vec((0.0..25.0, prop_oneof![4 => Just(0.0), 1 => -2e-3..2e-3]), 1..30),
    ) {
        let (mut at, mut heading) = (Point::new(800.0, -300.0), 0.0_f64);
        let mut line = Line { points: vec![at], distances: vec![0.0], segment: 0, front: 0.0 };
        for (turn, length) in turns {
            heading += turn;
            at += Vector::new(heading.cos(), heading.sin()) * length;
            line.distances.push(line.distances.last().unwrap() + (at - line.points.last().unwrap()).norm());
            line.points.push(at);
        }
        let lines = Lines::through(line.points.iter().copied());
        line.front = begin * lines.length(0);
        line.segment = line.distances.partition_point(|&distance| distance <= line.front).clamp(1, line.points.len() - 1) - 1;
        let mut track = Track::default();
        track.begin(&lines, 0, line.front);
        let mut distance = line.front;
        for (step, aside) in moves {
            distance += step;
            let front = line.at(distance, aside);
            prop_assert_eq!(track.follow(&lines, front, f64::INFINITY), line.follow(front));
            prop_assert_eq!(track.front().to_bits(), line.front.to_bits());
        }
    }
}

/// The same points as several lines that join, where `cuts` says so.
fn in_pieces(points: &[Point], cuts: &[bool]) -> Lines {
    let mut lines = Lines::default();
    lines.begin();
    for (number, point) in points.iter().enumerate() {
        lines.push(*point);
        if number > 0 && number + 1 < points.len() && cuts[number % cuts.len()] {
            lines.begin();
            lines.push(*point);
        }
    }
    lines
}

/// A track over all of these lines, with the front bumper at a distance.
fn over_all(lines: &Lines, count: u32, mut distance: f64) -> Track {
    let (mut track, mut on) = (Track::default(), 0);
    while on + 1 < count && distance >= lines.length(on) {
        distance -= lines.length(on);
        on += 1;
    }
    track.begin(lines, on, distance);
    (0..on).rev().for_each(|line| track.prepend(line));
    (on + 1..count).for_each(|line| track.append(lines, line));
    track
}

proptest! {
    #[test]
    fn joined_lines_are_followed_as_one(
        turns in prop::collection::vec((-2.5..2.5, 0.5..40.0), 3..20),
        cuts in prop::collection::vec(any::<bool>(), 1..20),
        begin in 0.0..1.0,
        moves in prop::collection::vec(0.0..25.0_f64, 1..20),
        (length, skew) in (0.5..15.0_f64, prop_oneof![Just(0.0_f64), -0.3..0.3]),
    ) {
        let (mut at, mut heading, mut points) = (Point::new(80.0, -30.0), 0.0_f64, vec![Point::new(80.0, -30.0)]);
        for (turn, length) in turns {
            heading += turn;
            at += Vector::new(heading.cos(), heading.sin()) * length;
            points.push(at);
        }
        let (whole, pieces) = (Lines::through(points.iter().copied()), in_pieces(&points, &cuts));
        let count = pieces.count();
        let mut distance: f64 = begin * (whole.length(0) - 1e-6);
        let mut tracks = [(over_all(&whole, 1, distance), &whole), (over_all(&pieces, count, distance), &pieces)];
        for step in moves {
            distance = (distance + step).min(whole.length(0) - 1e-6);
            let place = points.windows(2).scan(0.0, |from, ends| {
                let (start, length) = (*from, (ends[1] - ends[0]).norm());
                *from += length;
                Some((distance <= start + length).then(|| ends[0] + (ends[1] - ends[0]) * ((distance - start) / length)))
            });
            let Some(front) = place.flatten().next() else { break };
            let followed = tracks.each_mut().map(|(track, lines)| track.follow(lines, front, f64::INFINITY));
            prop_assert_eq!(followed[0], followed[1]);
            if !followed[0] {
                break;
            }
            let ahead = tracks.each_ref().map(|(track, _)| track.ahead());
            prop_assert!((ahead[0] - ahead[1]).abs() < 1e-9, "{ahead:?}");
            let axis = Vector::new(skew.cos(), skew.sin());
            let [one, several] = tracks.each_ref().map(|(track, lines)| {
                let mut poses = Vec::new();
                let asked = [(length / 2.0).min(ahead[0] / 2.0), ahead[0]];
                track.poses(lines, axis, Carriage { behind: 0.0, length }, &asked, false, &mut poses);
                let found = asked.map(|distance| *poses.iter().find(|pose| (pose.distance - distance).abs() < 1e-9).unwrap());
                (found, track.bounds(lines, 0.0, ahead[0] / 3.0))
            });
            for (one, several) in one.0.iter().zip(&several.0) {
                prop_assert!((one.front - several.front).norm() < 1e-9, "{one:?} {several:?}");
                prop_assert!((one.axis - several.axis).norm() < 1e-6, "{one:?} {several:?}");
            }
            prop_assert!((one.1.low - several.1.low).norm() + (one.1.high - several.1.high).norm() < 1e-9);
            let behind = length + 5.0;
            tracks.iter_mut().for_each(|(track, lines)| track.remove_behind(lines, behind));
        }
    }
}
