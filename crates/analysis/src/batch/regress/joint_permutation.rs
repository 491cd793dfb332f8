//! One permutation test over many measures at once.
//!
//! Runs with different seeds are exchangeable: if nothing has changed, every split of all runs into "expected" and
//! "found" was equally likely. The statistic of a measure is the difference of its two means, standardised by its
//! deviation over all runs; the statistic of the test is the largest of these. A measure's adjusted p is the share of
//! splits whose *largest* statistic reaches that measure's own (single-step max-T: Westfall and Young 1993, section
//! 2.6). If nothing has changed, the chance that any measure is at or below α is therefore at most α: exactly, for any
//! distribution, any dependence between measures, and any number of runs.

use crate::statistics::permutation::Splits;

/// Up to this many splits, all are examined.
const MOST_SPLITS: f64 = 200_000.0;
/// The number of random splits where there are more.
const DRAWS: usize = 99_999;
/// The seed of the draws: equal input gives equal output.
const SEED: u64 = 0;
/// Two statistics that differ by less than this are equal: the order of a sum changes its last digits.
const EQUAL: f64 = 1e-9;

/// The adjusted p of each measure; a row of `expected` and `found` is a run, a column a measure.
pub(crate) fn adjusted_p(expected: &[Vec<f64>], found: &[Vec<f64>]) -> Vec<f64> {
    let measures = expected.iter().chain(found).map(Vec::len).min().unwrap_or_default();
    let runs = standardised(expected, found, measures);
    let real = (0..runs.len()).map(|run| run >= expected.len()).collect::<Vec<_>>();
    let mut sums = vec![0.0; measures];
    add_up(&runs, &real, &mut sums);
    let thresholds = sums.iter().map(|sum| sum.abs() - EQUAL).collect::<Vec<_>>();
    let largest = |split: &[bool]| {
        add_up(&runs, split, &mut sums);
        sums.iter().fold(0.0_f64, |largest, sum| largest.max(sum.abs()))
    };
    let mut random = fastrand::Rng::with_seed(SEED);
    let mut order = (0..runs.len()).collect::<Vec<_>>();
    let draw = |split: &mut [bool]| {
        split.fill(false);
        for place in 0..found.len() {
            order.swap(place, random.usize(place..runs.len()));
            split[order[place]] = true;
        }
    };
    splits(expected.len(), found.len()).shares(real, &thresholds, largest, draw).0
}

fn splits(expected: usize, found: usize) -> Splits {
    Splits { runs: expected + found, first: found, most: MOST_SPLITS, draws: DRAWS }
}

/// The smallest adjusted p that these numbers of runs can lead to.
pub(crate) fn smallest_p(expected: usize, found: usize) -> f64 {
    splits(expected, found).smallest_p()
}

/// The fewest seeds, the same number on both sides, with which a difference can be found at the level `alpha`.
pub(crate) fn fewest_seeds(alpha: f64) -> usize {
    (1..).find(|seeds| smallest_p(*seeds, *seeds) <= alpha || *seeds > 100).unwrap_or_default()
}

/// All runs, each measure with mean 0 and deviation 1; 0 if it has the same value in all runs.
///
/// Since the values of a measure add up to 0, its sum over `found` is the difference of the means but for a factor.
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

/// The sums of the measures over the chosen runs.
fn add_up(runs: &[Vec<f64>], chosen: &[bool], sums: &mut [f64]) {
    sums.fill(0.0);
    for (run, _) in runs.iter().zip(chosen).filter(|(_, chosen)| **chosen) {
        for (sum, value) in sums.iter_mut().zip(run) {
            *sum += value;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::joint_permutation::*;

    fn column(values: &[f64]) -> Vec<Vec<f64>> {
        values.iter().map(|value| vec![*value]).collect()
    }

    #[test]
    fn p_is_the_share_of_splits_that_differ_as_much() {
        // Only this one of the C(6, 3) = 20 splits and its mirror image separate low from high.
        assert_eq!(adjusted_p(&column(&[1.0, 2.0, 3.0]), &column(&[4.0, 5.0, 6.0])), [0.1]);
        assert_eq!(smallest_p(3, 3), 0.1);
        // |difference| is at least 1/3 for any split of 1 … 6.
        assert_eq!(adjusted_p(&column(&[1.0, 4.0, 5.0]), &column(&[2.0, 3.0, 6.0])), [1.0]);
    }

    #[test]
    fn equal_runs_differ_in_nothing() {
        assert_eq!(adjusted_p(&column(&[7.1; 8]), &column(&[7.1; 8])), [1.0]);
    }

    #[test]
    fn many_runs_are_drawn_and_still_separated() {
        let low = (0..20).map(f64::from).collect::<Vec<_>>();
        let high = (30..50).map(f64::from).collect::<Vec<_>>();
        assert_eq!(adjusted_p(&column(&low), &column(&high)), [1.0 / 100_000.0]);
    }

    #[test]
    fn six_seeds_are_the_fewest_for_half_a_percent() {
        assert_eq!((fewest_seeds(0.01), fewest_seeds(0.005)), (5, 6));
        assert!(smallest_p(8, 8) < 0.001);
    }

    /// Sparse, heavy-tailed counts; 20 measures that depend on each other. 1 % of 2,000 is 20; 33 is 3 standard
    /// deviations above it.
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
            let expected = (0..5).map(|_| run()).collect::<Vec<_>>();
            let found = (0..5).map(|_| run()).collect::<Vec<_>>();
            alarms += usize::from(adjusted_p(&expected, &found).iter().any(|p| *p <= 0.01));
        }
        assert!((1..=33).contains(&alarms), "{alarms}");
    }
}
