//! How far beyond where both stand a condition looks for pairs.

use crate::braking::rss;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// The longest PET that a condition may ask for, in s: all places are kept that long.
pub(super) const LONGEST_PET: Second = 60.0;
/// The longest PET that is looked for where no condition asks for a longer one, in s.
pub(super) const USUAL_PET: Second = 5.0;
/// How a road user may speed up within the PET that is looked for, in m/s²: SUMO's `accel` of cars, rounded up. Without it, a
/// road user still waiting when the other leaves would be missed.
const SPEEDS_UP: MetrePerSecondSquared = 3.0;
/// The speed at which two distances ahead are compared, in m/s; any is valid.
const COMPARED_AT: MetrePerSecond = 14.0;

/// The distance ahead within which the two of a pair have to meet, besides that until they stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAhead {
    /// This much further than until they stand.
    pub metres: Metre,
    /// At their present speeds for so long; infinite: as long as a TTC is looked for.
    pub seconds: Second,
    /// At their present speeds for so long before they brake.
    pub response: Second,
    /// For so long, speeding up.
    pub pet: Second,
    /// Until both stand as RSS has them brake.
    pub rss: bool,
}

impl LookAhead {
    /// No further than until both stand.
    pub const NONE: Self = Self { metres: 0.0, seconds: 0.0, response: 0.0, pet: 0.0, rss: false };

    /// Whether it looks no further than until both stand.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// How far ahead a road user with this speed is predicted, which would stand after `stop` m. If it stands: where it is, or
    /// may be within the PET.
    pub fn distance(&self, speed: MetrePerSecond, stop: Metre, horizon: Second) -> Metre {
        let Self { metres, seconds, response, pet, rss } = *self;
        let stop = if rss { stop.max(rss::stopping_distance(speed)) } else { stop };
        let speeding_up = (speed + SPEEDS_UP * pet / 2.0) * pet;
        let until_it_stands = stop + metres + speed * response;
        let steady = if speed > 0.0 { until_it_stands.max(speed * seconds.min(horizon)) } else { 0.0 };
        speeding_up.max(steady)
    }

    /// As far as either looks.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            metres: self.metres.max(other.metres),
            seconds: self.seconds.max(other.seconds),
            response: self.response.max(other.response),
            pet: self.pet.max(other.pet),
            rss: self.rss || other.rss,
        }
    }

    /// The shorter look-ahead.
    pub(super) fn nearer(self, other: Self) -> Self {
        let far = |look: &Self| look.distance(COMPARED_AT, 0.0, Second::INFINITY);
        if far(&other) < far(&self) { other } else { self }
    }
}
