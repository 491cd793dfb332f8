//! The speed of a road user in the last step, and how it changes.

use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Second};

/// The speed of a road user in a step, and how it changes. By default it is not known, and does not change.
#[derive(Clone, Copy)]
pub(super) struct LastSpeed {
    /// Not a number where it is not known.
    pub speed: MetrePerSecond,
    /// Since the last step; below 0 where it brakes.
    pub acceleration: MetrePerSecondSquared,
}

impl Default for LastSpeed {
    fn default() -> Self {
        Self { speed: f64::NAN, acceleration: 0.0 }
    }
}

impl LastSpeed {
    /// The speed of a step `after` s after the last.
    pub fn take(&mut self, speed: MetrePerSecond, after: Second) {
        let faster = speed - self.speed;
        self.acceleration = if faster != 0.0 && !faster.is_nan() && after > 0.0 { faster / after } else { 0.0 };
        self.speed = speed;
    }

    /// Whether it was in the last step.
    pub fn is_known(&self) -> bool {
        !self.speed.is_nan()
    }

    /// How it brakes, 0 or more.
    pub fn deceleration(&self) -> MetrePerSecondSquared {
        if self.acceleration < 0.0 { -self.acceleration } else { 0.0 }
    }
}
