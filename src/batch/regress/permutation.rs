//! One permutation test over many measures at once.
//!
//! Runs with different seeds are exchangeable: where nothing has changed, any split of all runs into "expected" and
//! "found" was equally likely. The statistic of a measure j is the difference of its two means, standardised by its
//! deviation over all runs; that of the test is the largest over the measures. A measure's adjusted p is the share of
//! splits whose *largest* statistic reaches that measure's own (single-step max-T: Westfall and Young 1993, section
//! 2.6). So the chance that any measure is at or below α where nothing has changed is at most α: exactly, for any
//! distribution, any dependence between measures, and any number of runs.

use crate::analysis::statistics::permutation;

/// Up to this many splits are all gone through; of more, [`DRAWN`] are drawn.
const ENUMERATED: u64 = 200_000;
/// How many splits are drawn, the real one besides.
const DRAWN: usize = 99_999;
/// Two statistics that differ by less are equal: sums of floating-point numbers in another order.
const EQUAL: f64 = 1e-9;

/// The adjusted p of each measure; a row of `expected` and `found` is a run, a column a measure.
pub fn adjusted_p(expected: &[Vec<f64>], found: &[Vec<f64>]) -> Vec<f64> {
    let measures = expected.iter().chain(found).map(Vec::len).min().unwrap_or_default();
    let runs = standardised(expected, found, measures);
    let of_found = |run: usize| run >= expected.len();
    let real = sums(&runs, measures, of_found);
    // In how many splits the largest statistic reaches a measure's own.
    let mut reached = vec![0_u64; measures];
    let mut splits = 0_u64;
    let mut count = |split: &[f64]| {
        splits += 1;
        let largest = split.iter().fold(0.0_f64, |largest, sum| largest.max(sum.abs()));
        for (reached, real) in reached.iter_mut().zip(&real) {
            *reached += u64::from(largest >= real.abs() - EQUAL);
        }
    };
    if possible_splits(expected.len(), found.len()) <= ENUMERATED {
        enumerate(&runs, found.len(), &mut vec![0.0; measures], &mut count);
    } else {
        count(&real);
        let mut random = fastrand::Rng::with_seed(0);
        let mut order = (0..runs.len()).collect::<Vec<_>>();
        for _ in 0..DRAWN {
            let mut split = vec![0.0; measures];
            for place in 0..found.len() {
                order.swap(place, random.usize(place..runs.len()));
                add(&mut split, &runs[order[place]]);
            }
            count(&split);
        }
    }
    reached.into_iter().map(|reached| reached as f64 / splits as f64).collect()
}

/// The smallest adjusted p that so many runs can lead to.
pub fn smallest_p(expected: usize, found: usize) -> f64 {
    permutation::smallest_p(found, expected, DRAWN)
}

/// The fewest seeds, as many on both sides, with which a difference can be found at the level `alpha`.
pub fn fewest_seeds(alpha: f64) -> usize {
    (1..).find(|seeds| smallest_p(*seeds, *seeds) <= alpha || *seeds > 100).unwrap_or_default()
}

/// All runs, each measure less its mean and by its deviation; where it is the same in all runs, 0.
///
/// With as many of these in a sum, the sum over `found` says as much as the difference of the means.
fn standardised(expected: &[Vec<f64>], found: &[Vec<f64>], measures: usize) -> Vec<Vec<f64>> {
    let all = expected.iter().chain(found).collect::<Vec<_>>();
    let mut runs = vec![Vec::with_capacity(measures); all.len()];
    for measure in 0..measures {
        let values = all.iter().map(|run| run[measure]).collect::<Vec<_>>();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        let is_constant = deviation <= EQUAL * mean.abs();
        for (run, value) in runs.iter_mut().zip(values) {
            run.push(if is_constant { 0.0 } else { (value - mean) / deviation });
        }
    }
    runs
}

fn sums(runs: &[Vec<f64>], measures: usize, is_in: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut sums = vec![0.0; measures];
    for run in runs.iter().enumerate().filter(|(run, _)| is_in(*run)).map(|(_, run)| run) {
        add(&mut sums, run);
    }
    sums
}

fn add(sums: &mut [f64], run: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(run) {
        *sum += value;
    }
}

/// Goes through every choice of `wanted` of the runs; `sums` is over those chosen so far.
fn enumerate(runs: &[Vec<f64>], wanted: usize, sums: &mut Vec<f64>, count: &mut impl FnMut(&[f64])) {
    if wanted == 0 {
        return count(sums);
    }
    for (place, run) in runs.iter().enumerate().take((runs.len() + 1).saturating_sub(wanted)) {
        let before = sums.clone();
        add(sums, run);
        enumerate(&runs[place + 1..], wanted - 1, sums, count);
        *sums = before;
    }
}

fn possible_splits(expected: usize, found: usize) -> u64 {
    (1..=found as u64).fold(1, |splits: u64, k| splits.saturating_mul(expected as u64 + k) / k)
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::permutation::*;

    fn column(values: &[f64]) -> Vec<Vec<f64>> {
        values.iter().map(|value| vec![*value]).collect()
    }

    #[test]
    fn p_is_the_share_of_splits_that_differ_as_much() {
        // Of the C(6, 3) = 20 splits only this one and its mirror image separate low from high.
        assert_eq!(adjusted_p(&column(&[1.0, 2.0, 3.0]), &column(&[4.0, 5.0, 6.0])), [0.1]);
        assert_eq!(smallest_p(3, 3), 0.1);
        // |difference| is 1/3 at least for any split of 1 … 6.
        assert_eq!(adjusted_p(&column(&[1.0, 4.0, 5.0]), &column(&[2.0, 3.0, 6.0])), [1.0]);
    }

    #[test]
    fn equal_runs_differ_in_nothing() {
        assert_eq!(adjusted_p(&column(&[7.1; 8]), &column(&[7.1; 8])), [1.0]);
    }

    #[test]
    fn many_runs_are_drawn_and_still_separated() {
        let (low, high) = ((0..20).map(f64::from).collect::<Vec<_>>(), (30..50).map(f64::from).collect::<Vec<_>>());
        assert_eq!(adjusted_p(&column(&low), &column(&high)), [1.0 / 100_000.0]);
    }

    #[test]
    fn six_seeds_are_the_fewest_for_half_a_percent() {
        assert_eq!((fewest_seeds(0.01), fewest_seeds(0.005)), (5, 6));
        assert!(smallest_p(8, 8) < 0.001);
    }

    /// Sparse and heavy-tailed counts, 20 measures that depend on each other: 1 % of 2,000 is 20, and 3 standard
    /// deviations above that are 33.
    #[test]
    fn at_most_one_false_alarm_in_a_hundred() {
        let mut random = fastrand::Rng::with_seed(1);
        let mut uniform = || random.f64();
        let mut run = || {
            let common = -uniform().ln();
            (0..20).map(|measure| (common * uniform() * f64::from(measure)).powi(2).floor()).collect::<Vec<_>>()
        };
        let mut alarms = 0;
        for _ in 0..2000 {
            let (expected, found) =
                ((0..5).map(|_| run()).collect::<Vec<_>>(), (0..5).map(|_| run()).collect::<Vec<_>>());
            alarms += usize::from(adjusted_p(&expected, &found).iter().any(|p| *p <= 0.01));
        }
        assert!((1..=33).contains(&alarms), "{alarms}");
    }
}
