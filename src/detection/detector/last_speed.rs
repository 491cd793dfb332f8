//! The speed of a road user in the last step, and how it brakes.

use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Second};

/// The speed of a road user in a step, and how it brakes. By default it is not known, and the road user does not brake.
#[derive(Clone, Copy)]
pub(super) struct LastSpeed {
    /// Not a number where it is not known.
    pub speed: MetrePerSecond,
    /// 0 or more.
    pub deceleration: MetrePerSecondSquared,
}

impl Default for LastSpeed {
    fn default() -> Self {
        Self { speed: f64::NAN, deceleration: 0.0 }
    }
}

impl LastSpeed {
    /// The speed of this step, `after` s after the last.
    pub fn take(&mut self, speed: MetrePerSecond, after: Second) {
        let slower = self.speed - speed;
        self.deceleration = if slower > 0.0 && after > 0.0 { slower / after } else { 0.0 };
        self.speed = speed;
    }
}
