//! A line is followed as by somebody who looks at all of it in every step: the same ways, to the last bit.

#![allow(clippy::unwrap_used, reason = "a test may")]

use closecall::detection::path::track::Track;
use closecall::geometry::polylines::Lines;
use closecall::geometry::{Point, Vector};
use proptest::prelude::*;

/// How far from the line a front bumper may be found and still be on it, in m.
const ON_THE_LINE: f64 = 1e-3;
/// Who gets further back than this does not drive along the line, in m.
const BACKWARDS: f64 = 0.02;

/// A polyline and a place on it, without anything that makes following it quick.
struct Line {
    points: Vec<Point>,
    ways: Vec<f64>,
    segment: usize,
    front: f64,
}

impl Line {
    fn follow(&mut self, front: Point) -> bool {
        let direction =
            |from: usize| (self.points[from + 1] - self.points[from]) / (self.ways[from + 1] - self.ways[from]);
        let last = self.points[self.segment] + direction(self.segment) * (self.front - self.ways[self.segment]);
        let furthest = self.front + 4.0 * (front - last).norm() + ON_THE_LINE;
        let found =
            (self.segment..self.points.len() - 1).take_while(|&from| self.ways[from] <= furthest).find_map(|from| {
                let along = (front - self.points[from]).dot(&direction(from));
                let aside = (front - (self.points[from] + direction(from) * along)).norm_squared();
                let is_on = along <= self.ways[from + 1] - self.ways[from]
                    && along >= -ON_THE_LINE
                    && aside <= ON_THE_LINE * ON_THE_LINE;
                is_on.then_some((from, along))
            });
        let before = self.front;
        if let Some((segment, along)) = found {
            (self.segment, self.front) = (segment, self.ways[segment] + along.max(0.0));
        }
        found.is_some() && self.front >= before - BACKWARDS
    }

    /// The place at a way, `aside` to the left.
    fn at(&self, way: f64, aside: f64) -> Point {
        let from = self.ways.partition_point(|&start| start <= way).clamp(1, self.points.len() - 1) - 1;
        let direction = (self.points[from + 1] - self.points[from]) / (self.ways[from + 1] - self.ways[from]);
        self.points[from] + direction * (way - self.ways[from]) + Vector::new(-direction.y, direction.x) * aside
    }
}

proptest! {
    #[test]
    fn following_a_line_is_the_same_as_looking_for_the_front_on_all_of_it(
        turns in prop::collection::vec((-2.5..2.5, 0.01..40.0), 2..20),
        begin in 0.0..1.0,
        moves in prop::collection::vec((0.0..25.0, prop_oneof![4 => Just(0.0), 1 => -2e-3..2e-3]), 1..30),
    ) {
        let (mut at, mut heading) = (Point::new(800.0, -300.0), 0.0_f64);
        let mut line = Line { points: vec![at], ways: vec![0.0], segment: 0, front: 0.0 };
        for (turn, length) in turns {
            heading += turn;
            at += Vector::new(heading.cos(), heading.sin()) * length;
            line.ways.push(line.ways.last().unwrap() + (at - line.points.last().unwrap()).norm());
            line.points.push(at);
        }
        let lines = Lines::through(line.points.iter().copied());
        line.front = begin * lines.length(0);
        line.segment = line.ways.partition_point(|&way| way <= line.front).clamp(1, line.points.len() - 1) - 1;
        let mut track = Track::default();
        track.begin(&lines, 0, line.front);
        let mut way = line.front;
        for (step, aside) in moves {
            way += step;
            let front = line.at(way, aside);
            prop_assert_eq!(track.follow(&lines, front), line.follow(front));
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

/// A track over all of these lines, the front bumper at this way.
fn over_all(lines: &Lines, count: u32, mut way: f64) -> Track {
    let (mut track, mut on) = (Track::default(), 0);
    while on + 1 < count && way >= lines.length(on) {
        way -= lines.length(on);
        on += 1;
    }
    track.begin(lines, on, way);
    (0..on).rev().for_each(|line| track.come_from(line));
    (on + 1..count).for_each(|line| track.go_on(lines, line));
    track
}

proptest! {
    #[test]
    fn lines_that_join_are_driven_on_as_one(
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
        let mut way: f64 = begin * (whole.length(0) - 1e-6);
        let mut tracks = [(over_all(&whole, 1, way), &whole), (over_all(&pieces, count, way), &pieces)];
        for step in moves {
            way = (way + step).min(whole.length(0) - 1e-6);
            let place = points.windows(2).scan(0.0, |from, ends| {
                let (start, length) = (*from, (ends[1] - ends[0]).norm());
                *from += length;
                Some((way <= start + length).then(|| ends[0] + (ends[1] - ends[0]) * ((way - start) / length)))
            });
            let Some(front) = place.flatten().next() else { break };
            let followed = tracks.each_mut().map(|(track, lines)| track.follow(lines, front));
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
                track.poses(lines, axis, length, &asked, false, &mut poses);
                let found = asked.map(|way| *poses.iter().find(|pose| (pose.way - way).abs() < 1e-9).unwrap());
                (found, track.bounds_ahead(lines, ahead[0] / 3.0))
            });
            for (one, several) in one.0.iter().zip(&several.0) {
                prop_assert!((one.front - several.front).norm() < 1e-9, "{one:?} {several:?}");
                prop_assert!((one.axis - several.axis).norm() < 1e-6, "{one:?} {several:?}");
            }
            prop_assert!((one.1.low - several.1.low).norm() + (one.1.high - several.1.high).norm() < 1e-9);
            let behind = length + 5.0;
            tracks.iter_mut().for_each(|(track, lines)| track.forget_behind(lines, behind));
        }
    }
}
