//! The speed of a road user in the last step, and how it changes.

use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, SAME_MOMENT, Second};

/// An acceleration that decides is the mean over 0.3 to 0.5 s, or over a longer step: that of a step of 0.1 s jumps with each
/// error of a recorded speed (docs/validation.md), and less than 0.3 s is shorter than any driver's response.
const SUSTAINED: [Second; 2] = [0.3, 0.5];
/// The number of past speeds kept, and the least time between two of them, in s: together they reach back that far.
const KEPT: usize = 5;
const APART: Second = 0.1;
/// No brakes take more than this from a speed, in m/s²: the largest deceleration of Cunto and Saccomanno (2008).
const MOST_BRAKING: MetrePerSecondSquared = 12.68;

/// The speed of a road user in a step, and how it changes. By default it is not known, and does not change.
#[derive(Clone, Copy)]
pub(super) struct LastSpeed {
    /// Not a number where it is not known.
    pub speed: MetrePerSecond,
    /// Since the last step; below 0 where it brakes.
    pub acceleration: MetrePerSecondSquared,
    /// How long ago it had which speed, the latest first; infinitely long where that is not known.
    past: [(Second, MetrePerSecond); KEPT],
    /// How long ago its speed fell by more than brakes can do within a step; infinite where it never did.
    since_impossible_stop: Second,
}

impl Default for LastSpeed {
    fn default() -> Self {
        let past = [(f64::INFINITY, f64::NAN); KEPT];
        Self { speed: f64::NAN, acceleration: 0.0, past, since_impossible_stop: f64::INFINITY }
    }
}

impl LastSpeed {
    /// The speed of a step `after` s after the last.
    pub fn take(&mut self, speed: MetrePerSecond, after: Second) {
        if self.is_known() && after > 0.0 {
            if self.past[0].0 >= APART - SAME_MOMENT {
                self.past.rotate_right(1);
                self.past[0] = (0.0, self.speed);
            } else if !self.past[0].0.is_finite() {
                self.past[0] = (0.0, self.speed);
            }
            self.past.iter_mut().for_each(|(ago, _)| *ago += after);
        }
        let faster = speed - self.speed;
        self.acceleration = if faster != 0.0 && !faster.is_nan() && after > 0.0 { faster / after } else { 0.0 };
        self.since_impossible_stop =
            if self.acceleration < -MOST_BRAKING { 0.0 } else { self.since_impossible_stop + after };
        self.speed = speed;
    }

    /// Whether it was in the last step.
    pub fn is_known(&self) -> bool {
        !self.speed.is_nan()
    }

    /// How it brakes, 0 or more: the mean over [`SUSTAINED`], or over the step where that is longer.
    pub fn deceleration(&self) -> MetrePerSecondSquared {
        let Some((ago, then)) = self.reference() else { return 0.0 };
        let slower = then - self.speed;
        if slower > 0.0 { slower / ago } else { 0.0 }
    }

    /// How long ago it had which speed, that the present one is compared with: the longest within [`SUSTAINED`], or else the
    /// shortest beyond; just after entering, the longest known.
    fn reference(&self) -> Option<(Second, MetrePerSecond)> {
        let [least, most] = SUSTAINED;
        let known = self.past.iter().copied().filter(|(ago, _)| ago.is_finite());
        let is_long = |(ago, _): &(Second, _)| *ago >= least - SAME_MOMENT;
        let within = known.clone().rev().find(|past| is_long(past) && past.0 <= most + SAME_MOMENT);
        within.or_else(|| known.clone().find(is_long)).or_else(|| known.clone().next_back())
    }

    /// How long ago its speed fell by more than brakes can do within a step; infinite where it never did.
    pub(crate) fn since_impossible_stop(&self) -> Second {
        self.since_impossible_stop
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn speeds(step: Second, speeds: impl IntoIterator<Item = MetrePerSecond>) -> LastSpeed {
        let mut last = LastSpeed::default();
        speeds.into_iter().for_each(|speed| last.take(speed, step));
        last
    }

    #[test]
    fn one_step_of_braking_is_not_yet_sustained() {
        let jitters = speeds(0.1, [20.0, 20.0, 20.0, 20.0, 20.0, 20.0, 19.0]);
        assert!((jitters.acceleration + 10.0).abs() < 1e-9 && (jitters.deceleration() - 2.0).abs() < 1e-9);
        let brakes = speeds(0.1, [20.0, 19.0, 18.0, 17.0, 16.0, 15.0]);
        assert!((brakes.deceleration() - 10.0).abs() < 1e-9);
    }

    #[test]
    fn the_mean_is_over_half_a_second_or_a_step() {
        for step in [0.01, 0.04, 0.05, 0.1, 0.2, 0.25, 0.3, 0.5, 1.0, 2.0] {
            let mut last = LastSpeed::default();
            for number in 0..200 {
                last.take(100.0 - 0.5 * f64::from(number) * step, step);
                assert!(number == 0 || (last.deceleration() - 0.5).abs() < 1e-9, "{step}");
            }
            let ago = last.reference().unwrap().0;
            assert!(ago >= 0.3 - 1e-9 && ago <= f64::max(0.5, step) + 1e-9, "{step}: {ago}");
        }
    }

    #[test]
    fn a_long_step_is_one_step() {
        let [braked, steady] = [[20.0, 20.0, 16.0], [20.0, 16.0, 16.0]].map(|last| speeds(1.0, last).deceleration());
        assert_eq!((braked, steady), (4.0, 0.0));
    }

    #[test]
    fn more_than_brakes_can_do_is_remembered() {
        assert_eq!(speeds(0.1, [20.0, 0.0, 0.0, 0.0]).since_impossible_stop(), 0.2);
        assert_eq!(speeds(0.1, [20.0, 18.8, 17.6]).since_impossible_stop(), f64::INFINITY);
    }
}
