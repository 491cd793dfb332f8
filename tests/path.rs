//! A line is followed as by somebody who looks at all of it in every step: the same ways, to the last bit.

#![allow(clippy::unwrap_used, reason = "a test may")]

use closecall::geometry::{Point, Vector};
use closecall::path::track::Track;
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
        let (mut track, mut at, mut heading) = (Track::default(), Point::new(800.0, -300.0), 0.0_f64);
        let mut line = Line { points: vec![at], ways: vec![0.0], segment: 0, front: 0.0 };
        track.push(at);
        for (turn, length) in turns {
            heading += turn;
            at += Vector::new(heading.cos(), heading.sin()) * length;
            track.push(at);
            line.ways.push(line.ways.last().unwrap() + (at - line.points.last().unwrap()).norm());
            line.points.push(at);
        }
        line.front = begin * track.end();
        line.segment = line.ways.partition_point(|&way| way <= line.front).clamp(1, line.points.len() - 1) - 1;
        track.set_front(line.front);
        let mut way = line.front;
        for (step, aside) in moves {
            way += step;
            let front = line.at(way, aside);
            prop_assert_eq!(track.follow(front), line.follow(front));
            prop_assert_eq!(track.front().to_bits(), line.front.to_bits());
        }
    }
}
