//! The probability that a driver does not brake in time: response time and available deceleration are distributions.
//!
//! ```text
//! P = ∫ P(T > w(a)) f(a) da
//! ```
//!
//! with the response time T, the longest wait w(a) of a driver that brakes with a, and the density f of a. It belongs to the
//! family of the crash propensity index (Cunto and Saccomanno 2008), the aggregate crash propensity metric (Wang and
//! Stamatiadis 2013) and the aggregated crash index (Kuang, Qu and Wang 2015).
//!
//! Stronger brakes leave a longer wait, so P(T > w(a)) falls with a. The quadrature asks for no wait on either side of this fall.
//! If it sees the fall in too few nodes, it places new ones there. If the response time is fixed, the fall is a step at the
//! deceleration with which wait = response, which is found by halving.

use crate::traffic::driver_distributions::{Driver, Weighted};
use crate::util::units::{MetrePerSecondSquared, Probability, Second};

/// From one node to the next, P(T > w(a)) may fall by so much: the error is then below 1e-3 for an attentive driver and 1e-2 for
/// any (docs/study.md).
const STEEP: Probability = 0.4;
/// A part of the range of decelerations that is not divided further.
const LEAST_PART: f64 = 1e-4;

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
    if driver.is_punctual() {
        return driver.brakes_too_weakly(|deceleration| driver.responds_later_than(longest_wait(deceleration)) > 0.5);
    }
    let [least, most] = bounds(driver, false, &longest_wait);
    if least == most {
        return most;
    }
    late(driver, driver.reach(), driver.decelerations(), &longest_wait).clamp(least, most)
}

/// A lower and an upper bound of it: with the strongest and with the weakest brakes.
pub fn bounds(
    driver: &Driver,
    has_responded: bool,
    longest_wait: impl Fn(MetrePerSecondSquared) -> Second,
) -> [Probability; 2] {
    let [_, latest] = driver.responses();
    let at = |deceleration| {
        let wait = longest_wait(deceleration);
        match () {
            () if has_responded => f64::from(wait < 0.0),
            () if wait > latest => 0.0,
            () => driver.responds_later_than(wait),
        }
    };
    let [weakest, strongest] = driver.reach();
    let most = at(weakest);
    [if most > 0.0 { at(strongest).min(most) } else { 0.0 }, most]
}

/// The probability of a deceleration in a range with which the driver responds too late. `nodes` stand for this range.
fn late(
    driver: &Driver,
    range: [MetrePerSecondSquared; 2],
    nodes: &[Weighted],
    longest_wait: &impl Fn(MetrePerSecondSquared) -> Second,
) -> Probability {
    let [soonest, latest] = driver.responses();
    let is_certain = |(deceleration, _): &Weighted| longest_wait(*deceleration) < soonest;
    let first = if nodes.first().is_some_and(is_certain) { nodes.partition_point(is_certain) } else { 0 };
    let mut sum = nodes[..first].iter().map(|(_, weight)| weight).sum::<f64>();
    let mut end = first;
    let mut before = if first > 0 { 1.0 } else { 0.0 };
    let (mut steepest, mut steepest_at) = (0.0, range[0]);
    for (index, (deceleration, weight)) in nodes.iter().enumerate().skip(first) {
        let wait = longest_wait(*deceleration);
        let is_late = if wait > latest { 0.0 } else { driver.responds_later_than(wait) };
        let fall = before - is_late;
        if fall > steepest {
            let last = index.checked_sub(1).map_or(range[0], |last| nodes[last].0);
            (steepest, steepest_at) = (fall, f64::midpoint(last, *deceleration));
        }
        if wait > latest {
            break;
        }
        sum += weight * is_late;
        before = is_late;
        end = index + 1;
    }
    let [low, high] = range;
    let [least, most] = driver.reach();
    if steepest < STEEP || high - low < LEAST_PART * (most - least) {
        return sum;
    }
    // With all decelerations below the one it is too late, with all above the other in time.
    let falls = [
        first.checked_sub(1).map_or(low, |last| nodes[last].0),
        nodes.get(end).map_or(high, |(deceleration, _)| *deceleration),
    ];
    let within = |part| late(driver, part, &driver.decelerations_between(part), longest_wait);
    let fall = if falls[1] - falls[0] <= (high - low) / 2.0 {
        within(falls)
    } else {
        within([falls[0], steepest_at]) + within([steepest_at, falls[1]])
    };
    driver.reaches([low, falls[0]]) + fall
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

    /// An attentive driver with these mean and standard deviation of the response time.
    fn of_response(mean: f64, deviation: f64) -> Driver {
        let own = DriverOptions { response_mean: Some(mean), response_sd: Some(deviation), ..DriverOptions::default() };
        Driver::new(DriverModel::Attentive, &own, &DriverOptions::default(), 1.0)
    }

    #[test]
    fn a_nearly_fixed_response_time_equals_a_fixed_one() {
        let wait = |deceleration| {
            let braking = LateBraking { speed: 30.0, present: 0.0, build_up: 0.1, deceleration };
            braking.longest_wait_behind(&Leader { room: 80.0, speed: 0.0, deceleration: 0.0 })
        };
        // Waits longer than 0.9 s need more than this.
        let needed = 900.0 / (2.0 * (80.0 - 0.9 * 30.0 - 1.5));
        let fixed = of_response(0.9, 0.0);
        let known = fixed.reaches([4.23, needed]);
        let found = crash_probability(&fixed, false, wait);
        assert!((found - known).abs() < 1e-3, "{found}, not {known}");
        for deviation in [1e-6, 1e-3, 1e-2] {
            let nearly = crash_probability(&of_response(0.9, deviation), false, wait);
            assert!((nearly - found).abs() < 3e-3, "{nearly} with {deviation} s, {found} with none");
        }
    }
}
