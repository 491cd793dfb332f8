//! What a step adds to the crash potential index (CPI, Cunto and Saccomanno 2008): the probability that the maximum available
//! deceleration rate MADR of the ego, a truncated normal distribution, is below the DRAC.
//!
//! ```text
//! CPI = Σ P(MADR < DRAC) Δt / Σ Δt
//! ```

use crate::traffic::driver_distributions::Driver;
use crate::util::units::{MetrePerSecondSquared, Probability};

/// The probability that a driver's vehicle cannot brake as hard as the DRAC; 0 without one.
pub(crate) fn exceeds_brakes(driver: &Driver, drac: Option<MetrePerSecondSquared>) -> Probability {
    drac.map_or(0.0, |drac| driver.brakes_too_weakly(|deceleration| deceleration < drac))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{DriverModel, DriverOptions};
    use fastrand::Rng;

    #[test]
    fn it_is_the_share_of_drawn_decelerations_below_the_drac() {
        const DRAWS: u32 = 200_000;
        let driver = Driver::new(DriverModel::Attentive, &DriverOptions::default(), &DriverOptions::default(), 1.0);
        let mut chance = Rng::with_seed(8);
        let drawn = (0..DRAWS).map(|_| {
            loop {
                let normal = (-2.0 * (1.0 - chance.f64()).ln()).sqrt() * (std::f64::consts::TAU * chance.f64()).cos();
                let drawn = 8.45 + 1.42 * normal;
                if (4.23..=12.68).contains(&drawn) {
                    break drawn;
                }
            }
        });
        let drawn = drawn.collect::<Vec<_>>();
        for drac in [4.0, 6.0, 8.0, 9.5, 12.68] {
            let below = drawn.iter().filter(|drawn| **drawn < drac).count() as f64 / f64::from(DRAWS);
            let found = exceeds_brakes(&driver, Some(drac));
            assert!((found - below).abs() < 4e-3, "{drac}: {found}, not {below}");
        }
        assert_eq!(exceeds_brakes(&driver, None), 0.0);
    }
}
