//! The probability that a driver does not brake in time: response time and available deceleration are distributions.
//!
//! ```text
//! P = ∫ P(T > w(a)) f(a) da
//! ```
//!
//! with the response time T, the longest wait w(a) of a driver that brakes with a, and the density f of a. It belongs to the
//! family of the crash propensity index (Cunto and Saccomanno 2008), the aggregate crash propensity metric (Wang and
//! Stamatiadis 2013) and the aggregated crash index (Kuang, Qu and Wang 2015).

use crate::traffic::driver::Driver;
use crate::util::units::{MetrePerSecondSquared, Probability, Second};

/// The probability that a driver responds later than its longest wait, which depends on the deceleration that its vehicle
/// turns out to reach. A driver that has `responded` already needs no more time for it.
pub fn crash_probability(
    driver: &Driver,
    has_responded: bool,
    longest_wait: impl Fn(MetrePerSecondSquared) -> Second,
) -> Probability {
    if has_responded {
        return driver.brakes_too_weakly(|deceleration| longest_wait(deceleration) < 0.0);
    }
    let is_late = |deceleration| driver.responds_later_than(longest_wait(deceleration));
    let sum = driver.decelerations().map(|(value, weight)| weight * is_late(value)).sum::<f64>();
    sum.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::braking::{LateBraking, Leader};
    use crate::options::{DriverModel, DriverOptions};
    use fastrand::Rng;

    #[test]
    fn the_quadrature_equals_a_million_draws() {
        const DRAWS: u32 = 1_000_000;
        let driver = Driver::new(DriverModel::Attentive, &DriverOptions::default(), &DriverOptions::default(), 1.0);
        let mut chance = Rng::with_seed(1);
        let normal =
            |chance: &mut Rng| (-2.0 * (1.0 - chance.f64()).ln()).sqrt() * (std::f64::consts::TAU * chance.f64()).cos();
        for (speed, room) in [(10.0, 15.0), (14.0, 25.0), (20.0, 40.0), (20.0, 26.0), (30.0, 90.0), (5.0, 4.0)] {
            let wait = |deceleration| {
                LateBraking { speed, present: 0.0, build_up: 0.1, deceleration }.longest_wait_behind(&Leader {
                    room,
                    speed: 0.0,
                    deceleration: 0.0,
                })
            };
            let [found, braking] = [false, true].map(|has_responded| crash_probability(&driver, has_responded, wait));
            let spread = (1.0 + (0.28_f64 / 0.92).powi(2)).ln();
            let mut crashes = [0; 2];
            for _ in 0..DRAWS {
                let response = (0.92_f64.ln() - spread / 2.0 + spread.sqrt() * normal(&mut chance)).exp();
                let deceleration = loop {
                    let drawn = 8.45 + 1.42 * normal(&mut chance);
                    if (4.23..=12.68).contains(&drawn) {
                        break drawn;
                    }
                };
                let longest = wait(deceleration);
                crashes[0] += u32::from(response > longest);
                crashes[1] += u32::from(longest < 0.0);
            }
            for (found, crashes) in [found, braking].into_iter().zip(crashes) {
                let drawn = f64::from(crashes) / f64::from(DRAWS);
                let error = (drawn * (1.0 - drawn) / f64::from(DRAWS)).sqrt();
                assert!((found - drawn).abs() < 4.0 * error + 1e-5, "{found} by quadrature, {drawn} drawn");
            }
        }
    }
}
