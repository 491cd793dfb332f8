//! What happens to the pair of an event between two steps: each moves evenly from where it was to where it is, on an arc where
//! it turns.
//!
//! A coarse step may end before and after a pair came closest, or even touched. Where road users are moved back to the moment
//! of their speeds, SUMO reports a different place on their path. The signed distance of two rectangles that do not turn (below
//! 0: how deep they overlap) is a convex function of time, so that a golden-section search finds the smallest; a way on which
//! they turn is cut into parts in which they hardly do. The time to collision needs no search: of two in line it is a quotient
//! of linear functions of time, which has its extremes at the ends of the step.

use crate::geometry::bow::Bow;
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::{Point, Vector, contact};
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

/// The states of two road users at a moment.
pub(super) type Both = [State; 2];

/// A moment, in s, and the states then.
pub(super) type Moment = (Second, Both);

/// The two of an event in one step.
pub(super) struct Between<'a> {
    /// When the step begins and ends, and what is known of a moment between.
    pub moments: &'a [Moment],
    pub profiles: [&'a Profile; 2],
}

/// The two between two moments.
#[derive(Clone, Copy)]
struct Leg<'a> {
    from: &'a Moment,
    to: &'a Moment,
    bows: [Bow; 2],
    profiles: [&'a Profile; 2],
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
    /// Where their fronts point.
    pub axes: [Vector; 2],
    pub speeds: [MetrePerSecond; 2],
}

impl Between<'_> {
    /// How close they came; none where the begin or the end of the step is closest. They collide where they overlap by more
    /// than `tolerance`, and between the ends also by the deviation of arcs from the straight line: the accuracy of the path. A
    /// collision that lasts until the end of the step is one only if it `is_seen` there, as the tolerance depends on the lanes
    /// that they are on.
    pub(crate) fn closest(&self, tolerance: Metre, is_seen: bool) -> Option<Closest> {
        let [Some(first), Some(last)] = [self.legs().next(), self.legs().last()] else { return None };
        if (0..2).any(|one| self.is_put_elsewhere(one)) {
            return None;
        }
        let [begin, end] = [first.room(0.0), last.room(1.0)];
        // The signed distance changes at most as fast as the corners move: two in line are nearest at an end.
        let most_change = self.legs().map(|leg| leg.most_change()).sum::<Metre>();
        if !is_seen && (begin + end - most_change) / 2.0 >= begin.min(end) - CLOSER {
            return None;
        }
        let lows = self.legs().flat_map(Leg::lows);
        let lowest = lows.fold((last, 1.0, end), |best, low| if low.2 < best.2 { low } else { best });
        let (leg, part, least) = lowest;
        // Two that graze at the begin collide, where that is not seen, only if they come as much deeper into each other.
        let deep = if is_seen { tolerance } else { tolerance - begin.min(0.0) + leg.depth() };
        let collides = -least > deep && (is_seen || -end <= tolerance - begin.min(0.0));
        (collides || least < begin.min(end) - CLOSER).then(|| Closest {
            clearance: least.max(0.0),
            overlap: f64::max(-least, 0.0),
            contact: collides.then(|| {
                let mut before = self.legs().take_while(|other| other.from.0 < leg.from.0);
                let overlaps_before = before.find(|leg| -leg.room(1.0) > tolerance).map(|leg| (leg, 1.0));
                let (leg, until) = overlaps_before.unwrap_or((leg, part));
                leg.first_contact(until, tolerance)
            }),
        })
    }

    fn legs(&self) -> impl Iterator<Item = Leg<'_>> {
        self.moments.windows(2).map(|ends| {
            let bows = [0, 1].map(|one| {
                let states = [&ends[0].1[one], &ends[1].1[one]];
                Bow::new(states.map(State::front), states.map(|state| state.heading))
            });
            Leg { from: &ends[0], to: &ends[1], bows, profiles: self.profiles }
        })
    }

    fn is_put_elsewhere(&self, one: usize) -> bool {
        let [(begin, from), .., (end, to)] = self.moments else { return false };
        let [from, to] = [from[one], to[one]];
        (to.front() - from.front()).norm() > from.speed.max(to.speed) * (end - begin) + PUT_ELSEWHERE
    }
}

impl<'a> Leg<'a> {
    /// Where they are closest in each part in which they hardly turn, and their distance there.
    fn lows(self) -> impl Iterator<Item = (Self, f64, Metre)> + use<'a> {
        let turn = self.bows.iter().map(|bow| bow.turn.abs()).sum::<Radian>();
        let parts = (turn / TURN).ceil().max(1.0);
        (0..parts as u32).map(move |part| {
            let [from, to] = [part, part + 1].map(|part| f64::from(part) / parts);
            let (low, high) = golden_section(|part| -self.room(part), from, to, STEPS);
            let middle = (low + high) / 2.0;
            (self, middle, self.room(middle))
        })
    }

    /// The first contact deeper than a tolerance, which they have at a part of the way.
    fn first_contact(&self, until: f64, tolerance: Metre) -> FirstContact {
        let (mut before, mut after) = (0.0, until);
        for _ in 0..HALVINGS {
            let middle = (before + after) / 2.0;
            if -self.room(middle) > tolerance { after = middle } else { before = middle }
        }
        let part = after;
        let speeds = [0, 1].map(|one| interpolated([self.from.1[one].speed, self.to.1[one].speed], part));
        let rectangles = [0, 1].map(|one| self.rectangle(one, part));
        let fronts = rectangles.map(|rectangle| rectangle.centre + rectangle.axis * rectangle.half_length);
        FirstContact {
            time: interpolated([self.from.0, self.to.0], part),
            fronts,
            axes: rectangles.map(|rectangle| rectangle.axis),
            speeds,
        }
    }

    /// By how much their distance can change.
    fn most_change(&self) -> Metre {
        let moves = [0, 1].map(|one| self.to.1[one].front() - self.from.1[one].front());
        let turns = [0, 1].map(|one| {
            let (bow, Profile { length, width, .. }) = (self.bows[one], self.profiles[one]);
            bow.turn.abs() * length.hypot(*width) + 2.0 * bow.depth()
        });
        (moves[0] - moves[1]).norm() + turns[0] + turns[1]
    }

    /// How far their ways leave the straight line.
    fn depth(&self) -> Metre {
        self.bows.iter().map(Bow::depth).sum()
    }

    /// Their distance after a part of the way; below 0, how deep they overlap.
    fn room(&self, part: f64) -> Metre {
        let [a, b] = [0, 1].map(|one| self.rectangle(one, part));
        match contact::overlap(&a, &b) {
            0.0 => contact::distance(&a, &b),
            depth => -depth,
        }
    }

    fn rectangle(&self, one: usize, part: f64) -> Rectangle {
        let bow = &self.bows[one];
        let heading = self.from.1[one].heading + bow.turn * part;
        let Profile { length, width, .. } = *self.profiles[one];
        Rectangle::behind(bow.at(part), direction(heading), length, width)
    }
}

/// A value after a part of the way.
fn interpolated([from, to]: [f64; 2], part: f64) -> f64 {
    from + (to - from) * part
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

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
        let moments = [(10.0, states[0]), (10.0 + lasted, states[1])];
        Between { moments: &moments, profiles: [&car, &car] }.closest(tolerance, is_seen)
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
        let FirstContact { time, speeds, fronts, axes } = found.contact.unwrap();
        // The second's front reaches y = −1 at 0.55 s; 10 cm of overlap take another 5 ms.
        assert!((time - 10.555).abs() < 1e-4, "{time}");
        assert!((fronts[0].x - 1.1).abs() < 1e-3 && speeds == [20.0, 20.0]);
        assert!((axes[0] - Vector::x()).norm() < 1e-9 && (axes[1] - Vector::y()).norm() < 1e-9);
        assert!(found.clearance == 0.0 && found.overlap > 1.0);
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
    fn one_in_a_bend_passes_what_stands_inside() {
        // 0.8 rad to the left around the origin, past a car that points away from there. Its front is outside the
        // straight line between both ends of the step, which is 1.6 m from the arc.
        let on = |angle: f64, radius: f64, heading: f64, speed: f64| {
            state(radius * angle.cos(), radius * angle.sin(), heading, speed)
        };
        let bend = |angle: f64| on(angle, 20.0, angle + PI / 2.0, 15.0);
        let found = |radius| {
            let stands = on(0.35, radius, 0.35, 0.0);
            closest([[bend(0.0), stands], [bend(0.8), stands]], 1.1, 0.1, false)
        };
        let near = found(18.5).unwrap();
        assert!(near.contact.is_none() && near.clearance > 0.2, "{near:?}");
        assert!(found(20.9).unwrap().contact.is_some());
        // That deep the way is not known.
        let graze = found(20.0).unwrap();
        assert!(graze.contact.is_none() && graze.overlap > 0.4, "{graze:?}");
    }

    #[test]
    fn the_place_between_two_steps_is_on_the_way() {
        // Around a car that stands on the straight line.
        let [from, middle, to] = [(-12.0, 0.0), (1.0, 6.0), (14.0, 0.0)].map(|(x, y)| state(x, y, 0.0, 26.0));
        let stands = state(0.0, 0.0, 0.0, 0.0);
        let car = car();
        let closest = |moments: &[Moment]| Between { moments, profiles: [&car, &car] }.closest(0.1, false).unwrap();
        let (begin, end) = ((0.0, [from, stands]), (1.0, [to, stands]));
        assert!(closest(&[begin, end]).contact.is_some());
        let around = closest(&[begin, (0.5, [middle, stands]), end]);
        assert!(around.contact.is_none() && around.clearance > 0.5, "{around:?}");
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
                let moved = direction(heading + turns[one] / 2.0) * speed;
                state(x + moved.x, y + moved.y, heading + turns[one], speed)
            });
            let car = car();
            let moments = [(0.0, from), (1.0, to)];
            let step = Between { moments: &moments, profiles: [&car, &car] };
            let found = step.closest(f64::INFINITY, false);
            let leg = step.legs().next().unwrap();
            let least = (0..=500).map(|part| leg.room(f64::from(part) / 500.0)).fold(f64::INFINITY, f64::min);
            let ends = leg.room(0.0).min(leg.room(1.0));
            let least_found = found.map_or(ends, |found| if found.overlap > 0.0 { -found.overlap } else { found.clearance });
            prop_assert!(least_found <= least + 5e-3 && least_found <= ends, "{least_found} {least}");
        }
    }
}
