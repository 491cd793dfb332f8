//! When and where an extreme of a conflict was found.

use crate::util::units::{Metre, MetrePerSecond, Second};

/// When and where an extreme was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time, in s; for the PET, when the second enters the conflict area.
    pub time: Second,
    /// The ego's front-bumper centre at the conflict point of that step, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// Speed of the ego in that step, in m/s; for the PET, in the step with the smallest margin.
    pub speed: MetrePerSecond,
}
