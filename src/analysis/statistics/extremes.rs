//! How often conflicts would become crashes, by extreme value theory: peaks over a threshold.
//!
//! Of a measure that is 0 at the moment of a crash, the values below a small threshold follow a generalised Pareto
//! distribution (Coles 2001, *An Introduction to Statistical Modeling of Extreme Values*, ch. 4; for conflicts
//! Songchitruksa and Tarko 2006; Zheng, Ismail and Meng 2014). Extended to 0 it says how often that is reached.
//! Crashes that happened are among the values. Beyond a sample of some hundred the answer is a guess, and the interval
//! says so.

use std::collections::BinaryHeap;

use serde::Serialize;

use super::gpd::Gpd;
use crate::analysis::logged::LoggedConflict;

/// With fewer conflicts than this an extrapolation is refused.
pub const FEWEST: usize = 60;
/// Fewest values below the threshold (about what maximum likelihood needs for a shape; Hosking and Wallis 1987).
const FEWEST_BELOW: usize = 30;
/// Most values below the threshold: the tail is what matters, and time.
const MOST_BELOW: usize = 1000;
/// Shares of the conflicts below the threshold, tried in this order: the largest that fits is taken.
const SHARES: [f64; 6] = [0.5, 0.3, 0.2, 0.15, 0.1, 0.05];
/// A threshold's distribution fits where its p-value is at least this (Bader, Yan and Zhang 2018).
const FITS: f64 = 0.1;
/// At or below this shape maximum likelihood is not regular (Smith 1985): many equal values at the end of the range.
const LEAST_SHAPE: f64 = -0.5;
/// Samples drawn for a p-value.
const FIT_DRAWS: usize = 199;
/// Samples drawn for an interval.
const DRAWS: usize = 999;
/// The seed of the draws: equal input gives equal output.
const SEED: u64 = 2008;

/// What is extrapolated: the name, and what it is 0 of.
pub const QUANTITIES: [&str; 3] = ["ttc", "pet", "relative_gap"];

fn quantities(conflict: &LoggedConflict) -> [Option<f64>; QUANTITIES.len()] {
    // gap / μ = 1 + margin / μ: the margin in terms of what both need to stop.
    [conflict.ttc, conflict.pet, (conflict.mu > 0.0).then(|| conflict.gap / conflict.mu)]
}

/// A value that can be compared: the logs hold no NaN.
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

/// The most severe values of each quantity, and how many there were.
#[derive(Debug, Default)]
pub struct Tails {
    tails: [(usize, BinaryHeap<Value>); QUANTITIES.len()],
}

impl Tails {
    /// Takes a conflict.
    pub fn take(&mut self, conflict: &LoggedConflict) {
        for ((count, smallest), value) in self.tails.iter_mut().zip(quantities(conflict)) {
            let Some(value) = value else { continue };
            *count += 1;
            if smallest.len() <= MOST_BELOW {
                smallest.push(Value(value));
            } else if smallest.peek().is_some_and(|largest| value < largest.0) {
                smallest.pop();
                smallest.push(Value(value));
            }
        }
    }

    /// The crash frequencies by each quantity, from this many simulated hours.
    pub fn extrapolate(&self, hours: f64) -> Vec<Extrapolation> {
        let tails = QUANTITIES.iter().zip(&self.tails);
        tails
            .map(|(quantity, (count, smallest))| {
                let sorted = smallest.clone().into_sorted_vec().into_iter().map(|value| value.0).collect::<Vec<_>>();
                let (crashes, refused) = match crashes(&sorted, *count, hours) {
                    Ok(crashes) => (Some(crashes), None),
                    Err(reason) => (None, Some(reason)),
                };
                Extrapolation { quantity, conflicts: *count as u64, crashes, refused }
            })
            .collect()
    }
}

/// The crash frequency by one quantity, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Extrapolation {
    /// `ttc`, `pet` or `relative_gap`: gap / μ.
    pub quantity: &'static str,
    /// How many conflicts have it.
    pub conflicts: u64,
    /// The frequency.
    pub crashes: Option<Crashes>,
    /// Why there is none.
    pub refused: Option<String>,
}

/// A crash frequency, and the distribution that it comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Crashes {
    /// Crashes per simulated hour.
    pub per_hour: f64,
    /// The 95 % interval's lower end (bootstrap percentiles).
    pub low: f64,
    /// The 95 % interval's upper end.
    pub high: f64,
    /// The threshold: values below it were taken.
    pub threshold: f64,
    /// How many values were.
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

/// The crash frequency from the smallest values, in ascending order, of `count`.
pub fn crashes(smallest: &[f64], count: usize, hours: f64) -> std::result::Result<Crashes, String> {
    if count < FEWEST {
        return Err(format!("too few conflicts have this measure: {count}, and at least {FEWEST} are needed"));
    }
    if hours <= 0.0 {
        return Err("the runs last no time".to_owned());
    }
    let mut random = fastrand::Rng::with_seed(SEED);
    let (mut best, mut before) = (0.0, 0);
    for share in SHARES {
        let below = ((count as f64 * share) as usize).clamp(FEWEST_BELOW, MOST_BELOW);
        let Some(&threshold) = smallest.get(below) else { continue };
        if below == before || threshold <= 0.0 {
            continue;
        }
        before = below;
        // Ascending excesses: the value just below the threshold first.
        let excesses = smallest[..below].iter().rev().map(|value| threshold - value).collect::<Vec<_>>();
        let Some(gpd) = Gpd::fit(&excesses).filter(|gpd| gpd.shape > LEAST_SHAPE) else { continue };
        let p_value = gpd.fits(&excesses, FIT_DRAWS, &mut random);
        best = f64::max(best, p_value);
        if p_value < FITS {
            continue;
        }
        let per_hour = below as f64 / hours * gpd.survival(threshold);
        let (low, high) = interval(&excesses, threshold, hours, &mut random);
        return Ok(Crashes {
            per_hour,
            low: low.min(per_hour),
            high: high.max(per_hour),
            threshold,
            below: below as u64,
            shape: gpd.shape,
            scale: gpd.scale,
            anderson_darling: gpd.anderson_darling(&excesses),
            p_value,
        });
    }
    Err(format!(
        "no generalised Pareto distribution with a shape above {LEAST_SHAPE} fits, at no threshold (best p {best:.3}; {FITS} is needed)"
    ))
}

/// The 95 % interval of the frequency: excesses drawn with replacement, their number from Poisson's distribution.
fn interval(excesses: &[f64], threshold: f64, hours: f64, random: &mut fastrand::Rng) -> (f64, f64) {
    let mut found = Vec::with_capacity(DRAWS);
    for _ in 0..DRAWS {
        let sample = excesses.iter().map(|_| excesses[random.usize(..excesses.len())]).collect::<Vec<_>>();
        let Some(gpd) = Gpd::fit(&sample) else { continue };
        // Normal to Poisson: there are 30 at least.
        let normal = (-2.0 * (1.0 - random.f64()).ln()).sqrt() * (std::f64::consts::TAU * random.f64()).cos();
        let below = (excesses.len() as f64 + normal * (excesses.len() as f64).sqrt()).max(0.0);
        found.push(below / hours * gpd.survival(threshold));
    }
    found.sort_unstable_by(f64::total_cmp);
    let at = |share| super::quantiles::quantile(&found, share).unwrap_or_default();
    (at(0.025), at(0.975))
}

#[cfg(test)]
mod tests {
    use crate::analysis::statistics::extremes::*;

    /// Values whose distance below 1 is of this distribution: a crash where it exceeds 1.
    fn values(gpd: Gpd, count: usize, seed: u64) -> Vec<f64> {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut values = (0..count).map(|_| 1.0 - gpd.exceeded(1.0 - random.f64())).collect::<Vec<_>>();
        values.sort_unstable_by(f64::total_cmp);
        values
    }

    #[test]
    fn the_interval_covers_the_true_frequency_in_most_samples() {
        let gpd = Gpd { shape: -0.1, scale: 0.3 };
        let truth = 300.0 * gpd.survival(1.0);
        let covered = (0..20).filter(|seed| {
            let found = crashes(&values(gpd, 300, *seed), 300, 1.0);
            found.is_ok_and(|found| found.low <= truth && truth <= found.high)
        });
        let covered = covered.count();
        assert!(covered >= 16, "{covered} of 20");
    }

    #[test]
    fn too_few_conflicts_are_refused_with_the_bound() {
        let refused = crashes(&values(Gpd { shape: 0.0, scale: 0.3 }, 59, 1), 59, 1.0).unwrap_err();
        assert_eq!(refused, "too few conflicts have this measure: 59, and at least 60 are needed");
    }

    #[test]
    fn what_no_distribution_fits_is_refused() {
        let lumps = (0..600).map(|i| if i < 300 { 0.1 } else { 0.9 + f64::from(i) * 1e-4 }).collect::<Vec<_>>();
        assert!(crashes(&lumps, 600, 1.0).unwrap_err().contains("fits, at no threshold"));
    }
}
