//! Two sets of runs side by side: the traffic that their rates refer to, and which runs have the same seed.

use rustc_hash::FxHashMap;

use super::rate::{Ratio, paired_ratio, rate_ratio};
use crate::logged::LoggedRun;

/// The unit of traffic that the rates of sets of runs are compared by.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Its name.
    pub name: &'static str,
    /// The traffic of a run in it.
    pub traffic: fn(&LoggedRun) -> f64,
}

impl Unit {
    /// Vehicle-kilometres, or hours if a set has none.
    pub fn of(sets: &[&[&LoggedRun]]) -> Self {
        let kilometres = |run: &LoggedRun| run.summary.exposure.vehicle_kilometres;
        if sets.iter().all(|set| set.iter().map(|run| kilometres(run)).sum::<f64>() > 0.0) {
            Self { name: "vehicle_kilometre", traffic: kilometres }
        } else {
            Self { name: "hour", traffic: LoggedRun::hours }
        }
    }

    /// The traffic of each run.
    pub(crate) fn of_each(&self, runs: &[&LoggedRun]) -> Vec<f64> {
        runs.iter().map(|run| (self.traffic)(run)).collect()
    }
}

/// For each run of the first set the place of the one with the same seed in the other; none unless every run of both has
/// one, and only one.
pub fn pairs(first: &[&LoggedRun], other: &[&LoggedRun]) -> Option<Vec<usize>> {
    let places = (0..).zip(other).map(|(place, run)| Some((run.seed.as_deref()?, place)));
    let mut places = places.collect::<Option<FxHashMap<&str, usize>>>()?;
    let paired = first.iter().map(|run| places.remove(run.seed.as_deref()?)).collect::<Option<Vec<_>>>()?;
    (paired.len() == other.len()).then_some(paired)
}

/// The ratio of two rates, first / other, by pairs where there are.
pub fn ratio(first: (&[f64], &[f64]), other: (&[f64], &[f64]), pairs: Option<&[usize]>) -> Option<Ratio> {
    let Some(pairs) = pairs else { return rate_ratio(first, other) };
    let of_pairs = |values: &[f64]| pairs.iter().map(|place| values[*place]).collect::<Vec<_>>();
    paired_ratio(first, (&of_pairs(other.0), &of_pairs(other.1)))
}
