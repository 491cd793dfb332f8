//! What happens to the two of an event between two steps: each moves evenly from where it was to where it is.
//!
//! A coarse step may end before and after a pair came closest, or even touched. The
//! signed distance of two rectangles that do not turn (below 0: how deep they overlap) is a convex function of time, so that a
//! golden-section search finds the smallest; a step in which they turn is cut into parts in which they hardly do. The time to collision needs no search:
//! of two in line it is a quotient of linear functions of time, which has its extremes at the ends of the step.

use std::f64::consts::PI;

use crate::detection::measures;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::{Point, angle_between, contact};
use crate::traffic::frame::State;
use crate::traffic::profile::Profile;
use crate::util::golden_section::golden_section;
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// How far the two may turn in a part of a step, together, in rad: a corner of a car leaves its straight line by millimetres.
const TURN: Radian = 0.1;
/// Steps of the golden section: a step of 1 s is searched to a microsecond.
const STEPS: u32 = 30;
/// Halvings until the first contact is known as well.
const HALVINGS: u32 = 20;
/// A smaller difference from the ends of the step is none, in m.
const CLOSER: Metre = 1e-6;
/// A road user that has moved this much further than its speeds allow was put elsewhere, in m.
const PUT_ELSEWHERE: Metre = 1.0;

/// The states of two road users at the begin or the end of a step.
pub(super) type Both = [State; 2];

/// The two of an event in one step.
pub(super) struct Between<'a> {
    /// When the step begins and ends.
    pub times: [Second; 2],
    /// Their states then.
    pub states: [Both; 2],
    pub profiles: [&'a Profile; 2],
}

/// How close they came, if that was closer than at both ends of the step, or if they collided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Closest {
    /// The smallest distance; 0 where they touched.
    pub clearance: Metre,
    /// The deepest overlap; 0 where they did not touch.
    pub overlap: Metre,
    /// The first contact deeper than a tolerance.
    pub contact: Option<FirstContact>,
}

/// The first contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FirstContact {
    pub time: Second,
    pub fronts: [Point; 2],
    pub speeds: [MetrePerSecond; 2],
    /// The larger ΔV of both.
    pub delta_v: MetrePerSecond,
}

impl Between<'_> {
    /// How close they came; none where the begin or the end of the step is closest. They collide where they overlap by more than `tolerance`; a collision that lasts until the end of
    /// the step is one only if it `is_seen` there, as the tolerance depends on the lanes that they are on.
    pub fn closest(&self, tolerance: Metre, is_seen: bool) -> Option<Closest> {
        if (0..2).any(|one| self.is_put_elsewhere(one)) {
            return None;
        }
        let [begin, end] = [0.0, 1.0].map(|part| self.room(part));
        // The signed distance changes at most as fast as the corners move: two in line are nearest at an end.
        if !is_seen && (begin + end - self.most_change()) / 2.0 >= begin.min(end) - CLOSER {
            return None;
        }
        let turn = [0, 1].map(|one| self.turn(one).abs()).iter().sum::<Radian>();
        let parts = (turn / TURN).ceil().max(1.0);
        let lows = (0..parts as u32).map(|part| {
            let [from, to] = [part, part + 1].map(|part| f64::from(part) / parts);
            let (low, high) = golden_section(|part| -self.room(part), from, to, STEPS);
            let middle = (low + high) / 2.0;
            (middle, self.room(middle))
        });
        let (lowest, least) = lows.fold((1.0, end), |best, low| if low.1 < best.1 { low } else { best });
        let tolerance = tolerance - begin.min(0.0);
        let collides = -least > tolerance && (is_seen || -end <= tolerance);
        (collides || least < begin.min(end) - CLOSER).then(|| Closest {
            clearance: least.max(0.0),
            overlap: f64::max(-least, 0.0),
            contact: collides.then(|| self.first_contact(lowest, tolerance)),
        })
    }

    /// The first contact deeper than a tolerance, which they have at a part of the step.
    fn first_contact(&self, until: f64, tolerance: Metre) -> FirstContact {
        let (mut before, mut after) = (0.0, until);
        for _ in 0..HALVINGS {
            let middle = (before + after) / 2.0;
            if -self.room(middle) > tolerance { after = middle } else { before = middle }
        }
        let part = after;
        let speeds = [0, 1].map(|one| between(self.states.map(|states| states[one].speed), part));
        let rectangles = [0, 1].map(|one| self.rectangle(one, part));
        let angle = angle_between(&rectangles[0].axis, &rectangles[1].axis);
        let [one, other] = [0, 1].map(|one| (speeds[one], self.profiles[one].mass));
        let [ego, foe] = measures::delta_v(one, other, angle);
        let fronts = rectangles.map(|rectangle| rectangle.centre + rectangle.axis * rectangle.half_length);
        FirstContact { time: between(self.times, part), fronts, speeds, delta_v: ego.max(foe) }
    }

    /// By how much their distance can change in the step.
    fn most_change(&self) -> Metre {
        let moves = [0, 1].map(|one| self.states[1][one].front() - self.states[0][one].front());
        let turns = [0, 1].map(|one| self.turn(one).abs() * self.profiles[one].length.hypot(self.profiles[one].width));
        (moves[0] - moves[1]).norm() + turns[0] + turns[1]
    }

    /// Their distance after a part of the step; below 0, how deep they overlap.
    fn room(&self, part: f64) -> Metre {
        let [a, b] = [0, 1].map(|one| self.rectangle(one, part));
        match contact::overlap(&a, &b) {
            0.0 => contact::distance(&a, &b),
            depth => -depth,
        }
    }

    fn rectangle(&self, one: usize, part: f64) -> Rectangle {
        let [from, to] = self.states.map(|states| states[one].front());
        let heading = self.states[0][one].heading + self.turn(one) * part;
        let Profile { length, width, .. } = *self.profiles[one];
        Rectangle::behind(from + (to - from) * part, direction(heading), length, width)
    }

    /// By how much it turns, −π to π.
    fn turn(&self, one: usize) -> Radian {
        let [from, to] = self.states.map(|states| states[one].heading);
        (to - from + PI).rem_euclid(2.0 * PI) - PI
    }

    fn is_put_elsewhere(&self, one: usize) -> bool {
        let [from, to] = self.states.map(|states| states[one]);
        let lasted = self.times[1] - self.times[0];
        (to.front() - from.front()).norm() > from.speed.max(to.speed) * lasted + PUT_ELSEWHERE
    }
}

/// A value after a part of the step.
fn between([from, to]: [f64; 2], part: f64) -> f64 {
    from + (to - from) * part
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::options::Options;
    use crate::traffic::sumo_type::SumoType;

    fn state(x: f64, y: f64, heading: f64, speed: f64) -> State {
        State { x, y, z: 0.0, heading, speed }
    }

    fn car() -> Profile {
        Profile::vehicle(&SumoType { length: 5.0, width: 2.0, ..SumoType::car("car") }, &Options::default())
    }

    fn closest(states: [Both; 2], lasted: f64, tolerance: f64, is_seen: bool) -> Option<Closest> {
        let car = car();
        Between { times: [10.0, 10.0 + lasted], states, profiles: [&car, &car] }.closest(tolerance, is_seen)
    }

    /// Two that cross at right angles with 20 m/s within a second, the second `late` s after the first.
    fn crossing(late: f64) -> [Both; 2] {
        let at = |time: f64| {
            [state(20.0 * time - 10.0, 0.0, 0.0, 20.0), state(0.0, 20.0 * (time - late) - 10.0, PI / 2.0, 20.0)]
        };
        [at(0.0), at(1.0)]
    }

    #[test]
    fn a_crash_within_a_step_is_seen() {
        let found = closest(crossing(0.1), 1.0, 0.1, false).unwrap();
        let FirstContact { time, speeds, fronts, delta_v } = found.contact.unwrap();
        // The second's front reaches y = −1 at 0.55 s; 10 cm of overlap take another 5 ms.
        assert!((time - 10.555).abs() < 1e-4, "{time}");
        assert!((fronts[0].x - 1.1).abs() < 1e-3 && speeds == [20.0, 20.0]);
        assert!((delta_v - 20.0 / 2.0_f64.sqrt()).abs() < 1e-6 && found.clearance == 0.0 && found.overlap > 1.0);
    }

    #[test]
    fn a_near_miss_within_a_step_is_as_near_as_it_was() {
        let found = closest(crossing(0.45), 1.0, 0.1, false).unwrap();
        // The first's rear corner and the second's front corner: the closest of two that move at 45° to one another.
        assert!(found.contact.is_none() && found.overlap == 0.0);
        assert!((found.clearance - 2.0 / 2.0_f64.sqrt()).abs() < 1e-3, "{}", found.clearance);
    }

    #[test]
    fn an_overlap_that_lasts_is_a_collision_only_if_seen() {
        let from = [state(0.0, 0.0, 0.0, 10.0), state(10.0, 0.0, 0.0, 0.0)];
        let to = [state(6.0, 0.0, 0.0, 10.0), state(10.0, 0.0, 0.0, 0.0)];
        let [seen, not_seen] = [true, false].map(|is_seen| closest([from, to], 0.8, 0.25, is_seen));
        assert!(not_seen.is_none() && (seen.unwrap().contact.unwrap().time - 10.7).abs() < 1e-6, "{seen:?}");
    }

    #[test]
    fn what_was_put_elsewhere_did_not_drive_there() {
        let [from, mut to] = crossing(0.1);
        to[0].x += 2.0;
        assert_eq!(closest([from, to], 1.0, 0.1, false), None);
    }

    proptest! {
        #[test]
        fn no_moment_of_the_step_is_closer(
            x in -15.0..15.0, y in -15.0..15.0, heading in -4.0..4.0, turns in prop::array::uniform2(-1.5..1.5),
            speeds in prop::array::uniform2(0.0..15.0),
        ) {
            let from = [state(0.0, 0.0, 0.0, speeds[0]), state(x, y, heading, speeds[1])];
            let to = [0, 1].map(|one| {
                let State { x, y, heading, speed, .. } = from[one];
                let way = direction(heading + turns[one] / 2.0) * speed;
                state(x + way.x, y + way.y, heading + turns[one], speed)
            });
            let car = car();
            let step = Between { times: [0.0, 1.0], states: [from, to], profiles: [&car, &car] };
            let found = step.closest(f64::INFINITY, false);
            let least = (0..=500).map(|part| step.room(f64::from(part) / 500.0)).fold(f64::INFINITY, f64::min);
            let ends = step.room(0.0).min(step.room(1.0));
            let least_found = found.map_or(ends, |found| if found.overlap > 0.0 { -found.overlap } else { found.clearance });
            prop_assert!(least_found <= least + 5e-3 && least_found <= ends, "{least_found} {least}");
        }
    }
}
