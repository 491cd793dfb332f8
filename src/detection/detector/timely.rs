//! The measures that follow from the courses of a pair: TTC, DRAC, TTB and the crash probability.

use crate::braking::LateBraking;
use crate::detection::measures::accident::BRAKES;
use crate::detection::measures::crash_probability::crash_probability;
use crate::detection::measures::ttb::Evasion;
use crate::traffic::driver_distributions::Driver;
use crate::util::units::{MetrePerSecondSquared, Second};

/// The measures of a pair that follow from the courses of both.
#[derive(Clone, Copy)]
pub(super) struct Timely {
    pub ttc: Option<Second>,
    /// Infinite where no deceleration avoids contact.
    pub drac: Option<MetrePerSecondSquared>,
    pub ttb: Option<Second>,
    pub crash_probability: f64,
}

impl Timely {
    /// Of a pair that would never touch.
    pub const APART: Self = Self { ttc: None, drac: None, ttb: None, crash_probability: 0.0 };
    /// Of one that collides now.
    pub const COLLISION: Self = Self { ttc: Some(0.0), drac: None, ttb: Some(0.0), crash_probability: 1.0 };

    /// The worst of each value.
    pub fn worse(self, other: Self) -> Self {
        let one_of = |a: Option<f64>, b: Option<f64>, worst: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(worst(a, b)),
            (one, other) => one.or(other),
        };
        Self {
            ttc: one_of(self.ttc, other.ttc, f64::min),
            drac: one_of(self.drac, other.drac, f64::max),
            ttb: one_of(self.ttb, other.ttb, f64::min),
            crash_probability: self.crash_probability.max(other.crash_probability),
        }
    }

    /// With what follows from the evasion that is left, of the one of both that has to brake.
    pub fn with(self, evasion: &Evasion, braking: &LateBraking, driver: &Driver) -> Self {
        let wait = evasion.longest_wait(braking);
        let ttb = Some(wait.max(0.0)).filter(|wait| wait.is_finite());
        let crash_probability = ttb.map_or(0.0, |_| {
            let wait_with = |deceleration| evasion.longest_wait(&driver.braking_with(deceleration, braking));
            crash_probability(driver, braking.present >= BRAKES, wait_with)
        });
        Self { ttb, crash_probability, ..self }
    }
}
