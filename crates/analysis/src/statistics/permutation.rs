//! Permutation tests over runs: if the runs were shuffled between the two sets, how often would they differ as much?
//!
//! Runs are exchanged, not conflicts, because the conflicts of one run are not independent (Good 2005, *Permutation,
//! Parametric and Bootstrap Tests of Hypotheses*). `Splits` is the test that `closecall stats` and `closecall regress`
//! share; [`p_value`] is the two-sided test of one difference, `holm` the correction for several.

use serde::Serialize;

/// A difference with a corrected p-value above this may be chance.
pub(super) const LEVEL: f64 = 0.05;

/// Up to this many ways to split the runs, `closecall stats` examines all of them.
const MOST_SPLITS: f64 = 20_000.0;
/// The number of random splits where there are more.
pub const DRAWS: usize = 9_999;
/// The seed of the draws: equal input gives equal output.
const SEED: u64 = 2008;
/// Differences that differ by less than this, relatively, are equal: the order of a sum changes its last digits.
const EQUAL: f64 = 1e-9;

/// How a p-value was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Test {
    /// From all ways to split the runs.
    ExactPermutation,
    /// From random splits.
    SampledPermutation,
}

/// The ways to split runs into a first set and the others, and how many of them a test examines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splits {
    /// The number of runs.
    pub runs: usize,
    /// The size of the first set.
    pub first: usize,
    /// Up to this many splits, all are examined.
    pub most: f64,
    /// The number of random splits where there are more, not counting the real one.
    pub draws: usize,
}

impl Splits {
    /// For each threshold, the share of splits whose statistic reaches it, the real split included.
    ///
    /// `real` tells which runs are in the first set. `draw` replaces a split by a random one; it owns the random numbers.
    pub(crate) fn shares(
        &self,
        real: Vec<bool>,
        thresholds: &[f64],
        mut statistic: impl FnMut(&[bool]) -> f64,
        mut draw: impl FnMut(&mut [bool]),
    ) -> (Vec<f64>, Test) {
        let mut reached = vec![0_usize; thresholds.len()];
        let mut examined = 0_usize;
        let mut examine = |split: &[bool]| {
            examined += 1;
            let value = statistic(split);
            for (reached, threshold) in reached.iter_mut().zip(thresholds) {
                *reached += usize::from(value >= *threshold);
            }
        };
        let mut split = real;
        let test = if divisions(self.runs, self.first) <= self.most {
            split.sort_unstable_by(|a, b| b.cmp(a));
            examine(&split);
            while next(&mut split) {
                examine(&split);
            }
            Test::ExactPermutation
        } else {
            examine(&split);
            for _ in 0..self.draws {
                draw(&mut split);
                examine(&split);
            }
            Test::SampledPermutation
        };
        (reached.into_iter().map(|reached| reached as f64 / examined as f64).collect(), test)
    }

    /// The smallest p-value that a two-sided test of these splits can have.
    pub(crate) fn smallest_p(&self) -> f64 {
        // If both sets have the same size, a split and its mirror image differ by the same amount.
        let alike = if 2 * self.first == self.runs { 2.0 } else { 1.0 };
        (alike / divisions(self.runs, self.first)).max(1.0 / (self.draws + 1) as f64)
    }
}

/// The splits that `closecall stats` examines.
pub(crate) fn splits(runs: usize, first: usize) -> Splits {
    Splits { runs, first, most: MOST_SPLITS, draws: DRAWS }
}

/// The two-sided p-value of the difference between the first `first` runs and the others.
///
/// `difference` computes it from whether each run is in the first set. None if either set is empty or `difference` is
/// none for the real split.
pub fn p_value(runs: usize, first: usize, difference: impl Fn(&[bool]) -> Option<f64>) -> Option<(f64, Test)> {
    if first == 0 || first >= runs {
        return None;
    }
    let real = (0..runs).map(|run| run < first).collect::<Vec<_>>();
    let found = difference(&real)?.abs() * (1.0 - EQUAL);
    let size = |split: &[bool]| difference(split).map_or(f64::NEG_INFINITY, f64::abs);
    let mut random = fastrand::Rng::with_seed(SEED);
    let (shares, test) = splits(runs, first).shares(real, &[found], size, |split| random.shuffle(split));
    Some((shares[0], test))
}

/// The number of ways to choose `first` of `runs`.
fn divisions(runs: usize, first: usize) -> f64 {
    (0..first).map(|i| (runs - i) as f64 / (i + 1) as f64).product()
}

/// The next split in descending order; false after the last.
fn next(split: &mut [bool]) -> bool {
    let places = 0..split.len().saturating_sub(1);
    let Some(place) = places.rev().find(|&place| split[place] && !split[place + 1]) else { return false };
    split.swap(place, place + 1);
    split[place + 2..].sort_unstable_by(|a, b| b.cmp(a));
    true
}

/// Holm's corrected p-values (Holm 1979), which allow for the number of tests.
pub(crate) fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order = (0..p_values.len()).collect::<Vec<_>>();
    order.sort_by(|a, b| p_values[*a].total_cmp(&p_values[*b]));
    let mut corrected = vec![0.0; p_values.len()];
    let mut largest = 0.0;
    for (rank, index) in order.into_iter().enumerate() {
        largest = f64::max(largest, p_values[index] * (p_values.len() - rank) as f64).min(1.0);
        corrected[index] = largest;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use crate::statistics::permutation::*;

    #[test]
    fn every_split_comes_once() {
        let mut split = vec![true, true, false, false, false];
        let mut all = vec![split.clone()];
        while next(&mut split) {
            assert_eq!(split.iter().filter(|taken| **taken).count(), 2);
            all.push(split.clone());
        }
        all.sort();
        all.dedup();
        assert_eq!(all.len(), 10);
        assert_eq!(divisions(5, 2), 10.0);
    }

    fn means(values: &[f64]) -> impl Fn(&[bool]) -> Option<f64> {
        move |split| {
            let mean = |wanted: bool| {
                let (sum, count) = values
                    .iter()
                    .zip(split)
                    .filter(|(_, first)| **first == wanted)
                    .fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value, count + 1.0));
                sum / count
            };
            Some(mean(true) - mean(false))
        }
    }

    #[test]
    fn sets_that_do_not_overlap_are_the_extreme_splits() {
        let values = [1.0, 2.0, 3.0, 4.0, 11.0, 12.0, 13.0, 14.0];
        assert_eq!(p_value(8, 4, means(&values)), Some((2.0 / 70.0, Test::ExactPermutation)));
        assert_eq!(p_value(2, 1, means(&[5.0, 5.0])), Some((1.0, Test::ExactPermutation)));
        assert_eq!(p_value(2, 2, means(&[5.0, 5.0])), None);
    }

    #[test]
    fn few_runs_suffice_against_many() {
        assert_eq!(splits(8, 4).smallest_p(), 2.0 / 70.0);
        assert_eq!(splits(23, 3).smallest_p(), 1.0 / 1771.0);
    }

    #[test]
    fn many_runs_are_sampled() {
        let values = (0..40).map(f64::from).collect::<Vec<_>>();
        assert_eq!(p_value(40, 20, means(&values)), Some((1e-4, Test::SampledPermutation)));
    }

    #[test]
    fn holm_corrects_the_smallest_most_and_keeps_the_order() {
        assert_eq!(holm(&[0.01, 0.04, 0.03]), [0.03, 0.06, 0.06]);
        assert_eq!(holm(&[0.9, 0.6]), [1.0, 1.0]);
    }
}
