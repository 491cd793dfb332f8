//! Where the road users were in the last seconds, so that an event's record begins before the event: when a conflict opens, the
//! first may already have left part of the conflict area.

use std::collections::VecDeque;

use typed_index_collections::TiVec;

use crate::geometry::Point;
use crate::traffic::frame::{Frame, Row};
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, Radian, Second};

/// The number of past steps, at least [`APART`] from one another, that causes are derived from: 5 s, in which a vehicle crosses
/// a junction. More are kept where a longer PET is looked for.
const STEPS: usize = 10;
/// The time between two of them, in s: half a second, in which a path bends by centimetres, less what sums of steps differ
/// from it by rounding.
const APART: Second = 0.5 - 1e-6;

/// A road user that has been in the scene for less than this, or for one step, has just appeared, in s: less than a driver's
/// response time.
const NEW: Second = 1.0;

/// The x, y and heading of a road user that is not there.
const ABSENT: [f64; 3] = [f64::NAN; 3];

/// The last steps, the oldest first.
#[derive(Debug, Default)]
pub(super) struct Past {
    /// How many are kept.
    most: usize,
    steps: VecDeque<PastStep>,
}

/// Where the road users were at a time.
#[derive(Debug, Default)]
struct PastStep {
    time: Second,
    /// By [`UserIndex`]: x and y of the front bumper, and the heading.
    places: TiVec<UserIndex, [f64; 3]>,
}

impl PastStep {
    fn of(&self, user: UserIndex) -> Option<(Second, Point, Radian)> {
        let &[x, y, heading]: &[Metre; 3] = self.places.get(user)?;
        (!x.is_nan()).then(|| (self.time, Point::new(x, y), heading))
    }
}

impl Past {
    /// That of so long: of the longest PET, as the first has left the conflict area by so much before.
    pub fn of_last(seconds: Second) -> Self {
        Self { most: STEPS.max((seconds / APART) as usize), steps: VecDeque::new() }
    }

    /// Adds a step, if the last one is long enough ago; `users` is more than every index in use.
    pub fn add(&mut self, frame: &Frame, users: usize) {
        if self.steps.back().is_some_and(|last| frame.time - last.time < APART) {
            return;
        }
        let mut step = if self.steps.len() < self.most { None } else { self.steps.pop_front() }.unwrap_or_default();
        step.time = frame.time;
        step.places.clear();
        step.places.reserve_exact(users);
        step.places.resize(users, ABSENT);
        for Row { user, state } in frame.rows() {
            step.places[user] = [state.x, state.y, state.heading];
        }
        self.steps.push_back(step);
    }

    /// Where a road user was in the last 5 s before this time, the oldest first, since it was last away.
    pub fn of(&self, user: UserIndex, before: Second) -> impl Iterator<Item = (Second, Point, Radian)> {
        self.since(self.steps.len().saturating_sub(STEPS), user, before)
    }

    /// The same as far back as is known.
    pub(crate) fn all_of(&self, user: UserIndex, before: Second) -> impl Iterator<Item = (Second, Point, Radian)> {
        self.since(0, user, before)
    }

    fn since(&self, first: usize, user: UserIndex, before: Second) -> impl Iterator<Item = (Second, Point, Radian)> {
        let away = self.steps.iter().rposition(|step| step.of(user).is_none());
        let since = self.steps.range(away.map_or(0, |away| away + 1).max(first)..);
        since.filter_map(move |step| step.of(user)).take_while(move |(time, ..)| *time < before)
    }

    /// Whether a road user has been in the scene for less than [`NEW`] or for one step, although the run has lasted longer.
    pub fn is_new(&self, user: UserIndex, time: Second) -> bool {
        let then = time - NEW;
        let [Some(first), Some(last)] = [self.steps.front(), self.steps.back()] else { return false };
        let is_late = |(since, ..): (Second, _, _)| since > then || since >= last.time;
        first.time <= then && self.of(user, time).next().is_none_or(is_late)
    }

    /// Forgets a road user that has left, as its index may be given to another.
    pub fn forget(&mut self, user: UserIndex) {
        for place in self.steps.iter_mut().filter_map(|step| step.places.get_mut(user)) {
            *place = ABSENT;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traffic::frame::State;

    const USER: UserIndex = UserIndex(1);

    fn frame(time: Second, is_there: bool) -> Frame {
        let mut frame = Frame::default();
        frame.begin(time);
        if is_there {
            frame.push(USER, State { x: time, y: 0.0, z: 0.0, heading: 0.0, speed: 1.0 });
        }
        frame
    }

    /// The times at which the road user was there, of steps of 0.1 s.
    fn times(past: &Past) -> Vec<Second> {
        past.of(USER, f64::INFINITY).map(|(time, ..)| time).collect()
    }

    #[test]
    fn the_last_five_seconds_are_kept_at_every_half_second() {
        let mut past = Past::of_last(5.0);
        (0..=80).for_each(|step| past.add(&frame(f64::from(step) * 0.1, true), 2));
        let expected = (0..10).map(|step| 3.5 + f64::from(step) * 0.5).collect::<Vec<_>>();
        assert!(times(&past).iter().zip(&expected).all(|(time, expected)| (time - expected).abs() < 1e-6));
        assert_eq!((times(&past).len(), past.of(USER, 5.1).count()), (10, 4));
    }

    #[test]
    fn a_longer_past_is_kept_for_the_pet_alone() {
        let mut past = Past::of_last(10.0);
        (0..=80).for_each(|step| past.add(&frame(f64::from(step) * 0.5, true), 2));
        assert_eq!((times(&past).len(), past.all_of(USER, f64::INFINITY).count()), (10, 20));
    }

    #[test]
    fn what_came_within_a_second_or_a_step_is_new() {
        for (step, expected) in
            [(0.1, [true, true, true, false]), (0.5, [true, true, false, false]), (2.0, [true, true, false, false])]
        {
            let mut past = Past::of_last(5.0);
            let mut is_new = |number: u32| {
                let time = f64::from(number) * step;
                let new = past.is_new(USER, time);
                past.add(&frame(time, number >= 20), 2);
                new
            };
            let found = (0..40).map(&mut is_new).collect::<Vec<_>>();
            assert_eq!([20, 21, 22, 31].map(|number| found[number]), expected, "{step}");
        }
    }

    #[test]
    fn what_was_before_it_was_away_is_not_its_path() {
        let mut past = Past::of_last(5.0);
        for (time, is_there) in [(0.0, true), (0.5, true), (1.0, false), (1.5, true), (2.0, true)] {
            past.add(&frame(time, is_there), 2);
        }
        assert_eq!(times(&past), [1.5, 2.0]);
        past.forget(USER);
        assert!(times(&past).is_empty());
    }
}
