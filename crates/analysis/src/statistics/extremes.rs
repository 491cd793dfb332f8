//! The crash frequency that the conflicts imply, by extreme value theory: peaks over a threshold.
//!
//! If a measure is 0 at the moment of a crash, its values below a small threshold follow a generalised Pareto
//! distribution (Coles 2001, *An Introduction to Statistical Modeling of Extreme Values*, ch. 4; for conflicts
//! Songchitruksa and Tarko 2006; Zheng, Ismail and Meng 2014). Extrapolated to 0, it gives the frequency of crashes.
//! Crashes that happened are among the values, all with 0: how far beyond it they would have gone is not known, so they are
//! censored there. A sample of a few hundred conflicts allows no more than a guess, and the interval shows it.

use std::collections::BinaryHeap;

use serde::Serialize;

use super::gpd::{Excesses, Gpd};
use super::gpd_posterior::crash_frequency;
use super::together::together;
use crate::logged::LoggedConflict;

/// The least number of conflicts for an extrapolation.
pub const FEWEST: usize = 60;
/// The least number of values below the threshold: about what maximum likelihood needs for a shape (Hosking and Wallis
/// 1987).
const FEWEST_BELOW: usize = 30;
/// The greatest number of values below the threshold: more make the fit slower, and the far tail matters most.
const MOST_BELOW: usize = 1000;
/// Shares of the conflicts below the threshold, tried in this order; the first that fits is used.
const SHARES: [f64; 6] = [0.5, 0.3, 0.2, 0.15, 0.1, 0.05];
/// The least p-value of a distribution that fits (Bader, Yan and Zhang 2018).
const FITS: f64 = 0.1;
/// At or below this shape maximum likelihood is not regular (Smith 1985): many equal values at the end of the range.
const LEAST_SHAPE: f64 = -0.5;
/// The largest number of samples drawn for a p-value.
const FIT_DRAWS: usize = 199;
/// The seed of the draws: equal input gives equal output.
const SEED: u64 = 2008;

/// The quantities that are extrapolated, each 0 at the moment of a crash.
pub(crate) const QUANTITIES: [&str; 3] = ["ttc", "pet", "relative_gap"];

fn quantities(conflict: &LoggedConflict) -> [Option<f64>; QUANTITIES.len()] {
    // gap / μ = 1 + margin / μ: the margin relative to the room that both need to stop.
    [conflict.ttc, conflict.pet, (conflict.mu > 0.0).then(|| conflict.gap / conflict.mu)]
}

/// A value with a total order.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Value(f64);
impl Eq for Value {}
impl PartialOrd for Value {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Value {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// The most severe values of each quantity, and the number of all values.
#[derive(Debug, Default)]
pub struct Tails {
    tails: [(usize, BinaryHeap<Value>); QUANTITIES.len()],
}

/// Adds a value to the smallest ones.
fn keep(smallest: &mut BinaryHeap<Value>, value: Value) {
    if smallest.len() <= MOST_BELOW {
        smallest.push(value);
    } else if smallest.peek().is_some_and(|largest| value < *largest) {
        smallest.pop();
        smallest.push(value);
    }
}

impl Tails {
    /// Adds a conflict.
    pub fn take(&mut self, conflict: &LoggedConflict) {
        for ((count, smallest), value) in self.tails.iter_mut().zip(quantities(conflict)) {
            let Some(value) = value else { continue };
            *count += 1;
            keep(smallest, Value(value));
        }
    }

    /// Adds the conflicts of other runs.
    pub fn append(&mut self, others: Self) {
        for ((count, smallest), (more, others)) in self.tails.iter_mut().zip(others.tails) {
            *count += more;
            others.into_iter().for_each(|value| keep(smallest, value));
        }
    }

    /// The crash frequency by each quantity, from this many simulated hours; or why there is none.
    pub(crate) fn extrapolate(&self, hours: std::result::Result<f64, &str>) -> Vec<Extrapolation> {
        let quantities: [_; QUANTITIES.len()] = std::array::from_fn(|place| (QUANTITIES[place], &self.tails[place]));
        let tasks = quantities.map(|(quantity, (count, smallest))| {
            move || {
                let sorted = smallest.clone().into_sorted_vec().into_iter().map(|value| value.0).collect::<Vec<_>>();
                let found = hours.map_err(str::to_owned).and_then(|hours| crashes(&sorted, *count, hours));
                let (crashes, refused) = match found {
                    Ok(crashes) => (Some(crashes), None),
                    Err(reason) => (None, Some(reason)),
                };
                Extrapolation { quantity, conflicts: *count as u64, crashes, refused }
            }
        });
        together(tasks).into()
    }
}

/// The crash frequency by one quantity, or why it cannot be computed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extrapolation {
    /// `ttc`, `pet` or `relative_gap`: gap / μ.
    pub quantity: &'static str,
    /// The number of conflicts that have it.
    pub conflicts: u64,
    /// The frequency, if it can be computed.
    pub crashes: Option<Crashes>,
    /// Why it cannot be computed.
    pub refused: Option<String>,
}

/// A crash frequency, and the distribution that it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crashes {
    /// Crashes per simulated hour: the median of what the values allow.
    pub per_hour: f64,
    /// The 95 % interval's lower end.
    pub low: f64,
    /// The 95 % interval's upper end.
    pub high: f64,
    /// The threshold: the distribution is fitted to the values below it.
    pub threshold: f64,
    /// The number of values below the threshold.
    pub below: u64,
    /// The distribution's shape ξ.
    pub shape: f64,
    /// Its scale σ.
    pub scale: f64,
    /// Anderson and Darling's A².
    pub anderson_darling: f64,
    /// The probability of an A² at least as large, by parametric bootstrap.
    pub p_value: f64,
}

/// The crash frequency from the smallest of `count` values, in ascending order.
pub fn crashes(smallest: &[f64], count: usize, hours: f64) -> std::result::Result<Crashes, String> {
    if count < FEWEST {
        return Err(format!("too few conflicts have this measure: {count}, and at least {FEWEST} are needed"));
    }
    if hours <= 0.0 {
        return Err("the runs have no duration".to_owned());
    }
    let mut random = fastrand::Rng::with_seed(SEED);
    let mut best = 0.0;
    let mut before = 0;
    for share in SHARES {
        let below = ((count as f64 * share) as usize).clamp(FEWEST_BELOW, MOST_BELOW);
        let Some(&threshold) = smallest.get(below) else { continue };
        if below == before || threshold <= 0.0 {
            continue;
        }
        before = below;
        // Ascending excesses: the value just below the threshold first. None is larger than the threshold, as a crash is 0.
        let excesses = smallest[..below].iter().rev().map(|value| threshold - value.max(0.0)).collect::<Vec<_>>();
        let censored = Excesses::of(&excesses, threshold);
        let Some(gpd) = Gpd::fit(censored).filter(|gpd| gpd.shape > LEAST_SHAPE) else { continue };
        let p_value = gpd.fits(&excesses, threshold, FIT_DRAWS, &mut random);
        best = f64::max(best, p_value);
        if p_value < FITS {
            continue;
        }
        let Some([low, per_hour, high]) = crash_frequency(censored, threshold, hours) else { continue };
        return Ok(Crashes {
            per_hour,
            low,
            high,
            threshold,
            below: below as u64,
            shape: gpd.shape,
            scale: gpd.scale,
            anderson_darling: gpd.anderson_darling(&excesses),
            p_value,
        });
    }
    Err(format!(
        "no generalised Pareto distribution with a shape above {LEAST_SHAPE} fits at any threshold (best p {best:.3}; {FITS} is needed)"
    ))
}

#[cfg(test)]
mod tests {
    use crate::statistics::extremes::*;

    /// Values whose distance below 1 has this distribution: a crash if it exceeds 1.
    fn values(gpd: Gpd, count: usize, seed: u64) -> Vec<f64> {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut values = (0..count).map(|_| 1.0 - gpd.exceeded(1.0 - random.f64())).collect::<Vec<_>>();
        values.sort_unstable_by(f64::total_cmp);
        values
    }

    #[test]
    fn the_interval_covers_the_true_frequency_and_misses_on_both_sides() {
        // 0.005 to 11 crashes per hour, in logs where a crash is 0.
        for (shape, scale) in [(-0.1, 0.3), (-0.1, 0.15), (0.0, 0.15), (0.2, 0.1)] {
            let gpd = Gpd { shape, scale };
            let truth = 300.0 * gpd.survival(1.0);
            let mut found = (0..60)
                .map(|seed| {
                    let values = values(gpd, 300, seed).into_iter().map(|value| value.max(0.0)).collect::<Vec<_>>();
                    crashes(&values, 300, 1.0)
                })
                .filter_map(Result::ok)
                .collect::<Vec<_>>();
            let missed = found.iter().filter(|found| truth < found.low || found.high < truth).count();
            // 95 % of 60: 8 or more would miss once in 100 times.
            assert!(found.len() > 50 && missed < 8, "{missed} of {} missed {truth}, {gpd:?}", found.len());
            found.sort_unstable_by(|a, b| a.per_hour.total_cmp(&b.per_hour));
            let median = found[found.len() / 2].per_hour;
            assert!(median > 0.25 * truth && median < 2.0 * truth, "{median}, not {truth}, {gpd:?}");
        }
    }

    #[test]
    fn crashes_that_happened_are_counted() {
        // Twenty crashes among 300 in one hour: the tail cannot deny them.
        let mut values = values(Gpd { shape: -0.2, scale: 0.2 }, 280, 1);
        values.splice(..0, [0.0; 20]);
        let found = crashes(&values, 300, 1.0).unwrap();
        assert!(found.low > 5.0 && found.low < 20.0 && found.high > 20.0 && found.high < 40.0, "{found:?}");
    }

    #[test]
    fn too_few_conflicts_are_refused_with_the_bound() {
        let refused = crashes(&values(Gpd { shape: 0.0, scale: 0.3 }, 59, 1), 59, 1.0).unwrap_err();
        assert_eq!(refused, "too few conflicts have this measure: 59, and at least 60 are needed");
    }

    #[test]
    fn values_that_no_distribution_fits_are_refused() {
        let lumps = (0..600).map(|i| if i < 300 { 0.1 } else { 0.9 + f64::from(i) * 1e-4 }).collect::<Vec<_>>();
        assert!(crashes(&lumps, 600, 1.0).unwrap_err().contains("fits at any threshold"));
    }
}
