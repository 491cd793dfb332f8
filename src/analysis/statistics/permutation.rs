//! Permutation tests over runs: were the runs shuffled between the two sets, how often would they differ as much?
//!
//! Runs, not conflicts, are what is exchanged: conflicts of one run are not independent (Good 2005, *Permutation,
//! Parametric and Bootstrap Tests of Hypotheses*).

use serde::Serialize;

/// Up to this many ways to split the runs all are looked at.
const MOST_SPLITS: f64 = 20_000.0;
/// Random splits where there are more.
pub const DRAWS: usize = 9_999;
/// The seed of the draws: equal input gives equal output.
const SEED: u64 = 2008;
/// Differences that differ by less, relatively, are equal: sums in another order.
const EQUAL: f64 = 1e-9;

/// How a p-value was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Test {
    /// All ways to split the runs.
    ExactPermutation,
    /// Random splits.
    SampledPermutation,
}

/// The two-sided p-value of the difference between the first `first` runs and the others; `difference` computes it
/// from whether each run is in the first set. None where one of the sets is empty or there is no difference to test.
pub fn p_value(runs: usize, first: usize, difference: impl Fn(&[bool]) -> Option<f64>) -> Option<(f64, Test)> {
    if first == 0 || first >= runs {
        return None;
    }
    let mut split = (0..runs).map(|run| run < first).collect::<Vec<_>>();
    let found = difference(&split)?.abs() * (1.0 - EQUAL);
    let extreme = |split: &[bool]| difference(split).is_some_and(|difference| difference.abs() >= found);
    if ways(runs, first) <= MOST_SPLITS {
        let (mut all, mut extremes) = (0_usize, 0_usize);
        loop {
            all += 1;
            extremes += usize::from(extreme(&split));
            if !next(&mut split) {
                return Some((extremes as f64 / all as f64, Test::ExactPermutation));
            }
        }
    }
    let mut random = fastrand::Rng::with_seed(SEED);
    let mut extremes = 1;
    for _ in 0..DRAWS {
        random.shuffle(&mut split);
        extremes += usize::from(extreme(&split));
    }
    Some((extremes as f64 / (DRAWS + 1) as f64, Test::SampledPermutation))
}

/// The smallest p-value of a two-sided permutation test that looks at all splits, or draws so many.
pub fn smallest_p(first: usize, others: usize, draws: usize) -> f64 {
    // Where both sets have as many, a split and its mirror image differ by as much.
    let alike = if first == others { 2.0 } else { 1.0 };
    (alike / ways(first + others, first)).max(1.0 / (draws + 1) as f64)
}

/// In how many ways `first` of `runs` can be chosen.
fn ways(runs: usize, first: usize) -> f64 {
    (0..first).map(|i| (runs - i) as f64 / (i + 1) as f64).product()
}

/// The next split in descending order; false after the last.
fn next(split: &mut [bool]) -> bool {
    let Some(place) = (0..split.len() - 1).rev().find(|&place| split[place] && !split[place + 1]) else { return false };
    split.swap(place, place + 1);
    // Behind it the first order again.
    split[place + 2..].sort_unstable_by(|a, b| b.cmp(a));
    true
}

/// Holm's corrected p-values (Holm 1979): what remains of each when all are looked at.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
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
    use crate::analysis::statistics::permutation::*;

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
        assert_eq!(ways(5, 2), 10.0);
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
    fn sets_that_do_not_overlap_are_the_two_most_extreme_splits() {
        let values = [1.0, 2.0, 3.0, 4.0, 11.0, 12.0, 13.0, 14.0];
        assert_eq!(p_value(8, 4, means(&values)), Some((2.0 / 70.0, Test::ExactPermutation)));
        assert_eq!(p_value(2, 1, means(&[5.0, 5.0])), Some((1.0, Test::ExactPermutation)));
        assert_eq!(p_value(2, 2, means(&[5.0, 5.0])), None);
    }

    #[test]
    fn few_runs_on_one_side_suffice_where_the_other_has_many() {
        assert_eq!(smallest_p(4, 4, DRAWS), 2.0 / 70.0);
        assert_eq!(smallest_p(3, 20, DRAWS), 1.0 / 1771.0);
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
