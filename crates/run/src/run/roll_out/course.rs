//! The speed of a driver that goes on as it was, and brakes after its response time.

use closecall::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// The speed is worked out at moments that are at most this far apart, in s.
const FINE: Second = 0.01;

/// The course of a driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Course {
    /// Its speed at the beginning of a step.
    pub speed: MetrePerSecond,
    /// Its deceleration until it responds, 0 or more.
    pub present: MetrePerSecondSquared,
    /// When it responds.
    pub responds_at: Second,
    /// The deceleration that its vehicle then reaches.
    pub deceleration: MetrePerSecondSquared,
    /// In which time.
    pub build_up: Second,
}

impl Course {
    /// Goes on by a step from `time` on; returns the distance.
    pub fn advance(&mut self, time: Second, step: Second) -> Metre {
        let parts = (step / FINE).ceil().max(1.0);
        let part = step / parts;
        let mut distance = 0.0;
        for number in 0..parts as u32 {
            let middle = time + (f64::from(number) + 0.5) * part;
            let next = (self.speed - self.deceleration_at(middle) * part).max(0.0);
            distance += f64::midpoint(self.speed, next) * part;
            self.speed = next;
        }
        distance
    }

    fn deceleration_at(&self, time: Second) -> MetrePerSecondSquared {
        let braked_for = time - self.responds_at;
        let more = (self.deceleration - self.present).max(0.0);
        match () {
            () if braked_for <= 0.0 => self.present,
            () if braked_for < self.build_up => self.present + more * braked_for / self.build_up,
            () => self.present + more,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_that_of_the_closed_form_on_any_step() {
        // 20 m/s for 0.73 s, then 8 m/s² after 0.2 s.
        let built_up = 20.0 * 0.2 - 8.0 * 0.2 * 0.2 / 6.0;
        let known = 20.0 * 0.73 + built_up + (20.0 - 8.0 * 0.1_f64).powi(2) / 16.0;
        for step in [0.05, 0.1, 0.5, 1.0] {
            let mut course =
                Course { speed: 20.0, present: 0.0, responds_at: 100.73, deceleration: 8.0, build_up: 0.2 };
            let found = (0..(10.0 / step) as u32).map(|number| course.advance(100.0 + f64::from(number) * step, step));
            assert!((found.sum::<f64>() - known).abs() < 0.01, "steps of {step} s");
            assert_eq!(course.speed, 0.0);
        }
    }

    #[test]
    fn a_driver_that_brakes_goes_on_to_brake() {
        let mut course = Course { speed: 10.0, present: 3.0, responds_at: 9.0, deceleration: 2.0, build_up: 0.1 };
        assert!((course.advance(0.0, 1.0) - 8.5).abs() < 1e-9);
        assert!((course.advance(9.5, 1.0) - 5.5).abs() < 1e-9, "it does not brake less once it responds");
    }
}
