//! How many runs the comparison of two sets needs, and what it can find: from the variance between runs seen so far.
//!
//! With relative variances v₁ and v₂ of one run in each set, the logarithm of the ratio of rates has the variance v₁/n₁ + v₂/n₂
//! (the delta method), and a test at level α finds a ratio ρ with the power
//!
//! ```text
//! P( T > t(1 − α/2) − |ln ρ| / √(v₁/n₁ + v₂/n₂) ),   T of Student's distribution with n₁ + n₂ − 2 degrees of freedom
//! ```
//!
//! (Chow, Shao, Wang and Lokhnygina 2018, *Sample Size Calculations in Clinical Research*, ch. 3). The permutation test of the
//! comparison has nearly this power, where α is the largest level up to 5 % that its number of splits allows;
//! `closecall study --only coverage` measures it.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

use super::collect::{Collection, groups};
use super::pairs::Unit;
use super::permutation::{LEVEL, splits};
use super::rate::{EQUAL, TAIL, relative_deviations};

/// The power that is planned for.
pub(crate) const POWER: f64 = 0.8;
/// More runs than this are not worth planning.
const MOST_RUNS: usize = 100_000;
/// With fewer runs in each set no permutation test can be significant at 5 %.
const FEWEST_RUNS: usize = 4;

/// How many runs each of two sets needs.
#[derive(Clone, Debug, Serialize)]
pub struct RunPlan {
    /// The ratio of rates that is to be found.
    pub ratio: f64,
    /// The power with which it is to be found, in a test of this level.
    pub power: f64,
    /// The level of that test, which is one alone.
    pub level: f64,
    /// The groups that have conflicts, all conflicts first.
    pub groups: Vec<PlannedGroup>,
}

/// The runs that a group of conflicts needs.
#[derive(Clone, Debug, Serialize)]
pub struct PlannedGroup {
    /// `all`, a kind or a severity.
    pub group: &'static str,
    /// The standard deviation of a run's rate, divided by the rate; of two sets the root mean square.
    pub spread: f64,
    /// Whether it is that of independent conflicts, because the runs are one or equal.
    pub is_poisson: bool,
    /// The runs that each set needs; none beyond 100,000.
    pub runs: Option<usize>,
    /// The fewest that agree with the runs seen so far.
    pub low: Option<usize>,
    /// The most that agree with them; none where the spread is not known from them.
    pub high: Option<usize>,
    /// The power that two sets with the present runs have; none for a single set.
    pub power: Option<f64>,
}

/// The relative variance of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    variance: f64,
    runs: usize,
    is_poisson: bool,
}

impl Spread {
    /// The relative variance of one run's rate; that of independent conflicts for a single run, or for equal ones. None
    /// without conflicts.
    pub fn of(counts: &[f64], traffic: &[f64]) -> Option<Self> {
        let (count, runs) = (counts.iter().sum::<f64>(), counts.len());
        if count <= 0.0 {
            return None;
        }
        let squares = relative_deviations(counts, traffic).map(|all| all.iter().map(|one| one.powi(2)).sum::<f64>());
        let variance = squares.map(|squares| squares / (runs as f64 - 1.0)).filter(|variance| variance.sqrt() > EQUAL);
        let poisson = runs as f64 / count;
        Some(Self { variance: variance.unwrap_or(poisson), runs, is_poisson: variance.is_none() })
    }
}

/// The smallest ratio above 1 that a comparison of sets with these spreads finds with [`POWER`]; none with fewer than two
/// runs in either.
pub(super) fn detectable(first: Spread, other: Spread) -> Option<f64> {
    let freedom = freedom(first.runs, other.runs)?;
    Some(((critical(&freedom, first.runs, other.runs) + freedom.inverse_cdf(POWER)) * error(first, other)).exp())
}

/// The power of a comparison of sets with these spreads to find a ratio.
pub fn power(ratio: f64, first: Spread, other: Spread) -> Option<f64> {
    let freedom = freedom(first.runs, other.runs)?;
    let critical = critical(&freedom, first.runs, other.runs);
    Some(1.0 - freedom.cdf(critical - ratio.ln().abs() / error(first, other)))
}

/// What the permutation test needs at least: Student's quantile of the largest level up to [`LEVEL`] that it can have.
fn critical(freedom: &StudentsT, first: usize, other: usize) -> f64 {
    let least = splits(first + other, first).smallest_p();
    let level = if least > LEVEL { least } else { (LEVEL / least * (1.0 + EQUAL)).floor() * least };
    freedom.inverse_cdf(1.0 - level / 2.0)
}

/// The standard error of the logarithm of the ratio.
fn error(first: Spread, other: Spread) -> f64 {
    (first.variance / first.runs as f64 + other.variance / other.runs as f64).sqrt()
}

fn freedom(first: usize, other: usize) -> Option<StudentsT> {
    (first > 1 && other > 1).then(|| StudentsT::new(0.0, 1.0, (first + other - 2) as f64).ok()).flatten()
}

/// The least number of runs in each of two sets that finds a ratio with [`POWER`], where one run of both together has this
/// relative variance.
fn runs_needed(ratio: f64, variance: f64) -> Option<usize> {
    let finds = |runs: usize| {
        let half = Spread { variance: variance / 2.0, runs, is_poisson: false };
        power(ratio, half, half).is_some_and(|power| power >= POWER)
    };
    if !finds(MOST_RUNS) {
        return None;
    }
    let (mut low, mut high) = (FEWEST_RUNS - 1, MOST_RUNS);
    while high - low > 1 {
        let middle = low.midpoint(high);
        if finds(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// Plans the comparison of a set with another, or with a similar one.
pub(super) fn plan(ratio: f64, first: &Collection, other: Option<&Collection>) -> RunPlan {
    let sets = [Some(first), other].into_iter().flatten().collect::<Vec<_>>();
    let runs = sets.iter().map(|set| set.runs.iter().collect::<Vec<_>>()).collect::<Vec<_>>();
    let unit = Unit::of(&runs.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let of_group = |(group, kind, severity)| {
        let spreads =
            sets.iter().zip(&runs).map(|(set, runs)| Spread::of(&set.counts(kind, severity), &unit.of_each(runs)));
        let spreads = spreads.collect::<Option<Vec<_>>>()?;
        Some(planned(group, ratio, &spreads))
    };
    RunPlan { ratio, power: POWER, level: LEVEL, groups: groups().filter_map(of_group).collect() }
}

fn planned(group: &'static str, ratio: f64, spreads: &[Spread]) -> PlannedGroup {
    let mean = spreads.iter().map(|spread| spread.variance).sum::<f64>() / spreads.len() as f64;
    let is_poisson = spreads.iter().any(|spread| spread.is_poisson);
    // A variance of n runs is χ² with n − 1 degrees of freedom.
    let freedom = spreads.iter().map(|spread| spread.runs - 1).sum::<usize>() as f64;
    let chi_squared = ChiSquared::new(freedom).ok().filter(|_| !is_poisson);
    let end = |share: f64| {
        let variance = mean * freedom / chi_squared.as_ref()?.inverse_cdf(share);
        runs_needed(ratio, 2.0 * variance)
    };
    PlannedGroup {
        group,
        spread: mean.sqrt(),
        is_poisson,
        runs: runs_needed(ratio, 2.0 * mean),
        low: end(1.0 - TAIL),
        high: end(TAIL),
        power: if let [first, other] = spreads { power(ratio, *first, *other) } else { None },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_runs_needed_are_those_of_the_textbook() {
        // With many runs Student's t is normal: 2 · 0.3² (1.959964 + 0.841621)² / ln(1.1)² = 155.5.
        let found = runs_needed(1.1, 2.0 * 0.09).unwrap();
        assert!((156..=158).contains(&found), "{found}");
        assert_eq!(runs_needed(1.0 / 1.1, 2.0 * 0.09), Some(found));
        assert_eq!(runs_needed(3.0, 1e-6), Some(FEWEST_RUNS));
        assert_eq!(runs_needed(1.000_001, 1.0), None);
    }

    #[test]
    fn the_runs_that_are_planned_have_the_power_and_one_less_has_not() {
        let with = |runs| Spread { variance: 0.04, runs, is_poisson: false };
        let runs = runs_needed(1.3, 0.08).unwrap();
        assert!(power(1.3, with(runs), with(runs)).unwrap() >= POWER);
        assert!(power(1.3, with(runs - 1), with(runs - 1)).unwrap() < POWER);
        let found = detectable(with(runs), with(runs)).unwrap();
        assert!(found <= 1.3 && found > 1.25, "{found}");
        assert_eq!(detectable(with(1), with(8)), None);
    }

    #[test]
    fn a_single_run_has_the_spread_of_independent_conflicts() {
        let found = Spread::of(&[25.0], &[1.0]).unwrap();
        assert!((found.variance - 0.04).abs() < 1e-12 && found.is_poisson && found.runs == 1, "{found:?}");
        let plan = planned("all", 1.3, &[found]);
        assert!(plan.runs.is_some() && plan.high.is_none() && plan.power.is_none(), "{plan:?}");
        assert_eq!(Spread::of(&[0.0, 0.0], &[1.0, 1.0]), None);
        // Variance 4 of the counts at a mean of 10.
        let found = Spread::of(&[8.0, 10.0, 12.0], &[1.0; 3]).unwrap();
        assert!((found.variance - 0.04).abs() < 1e-12 && !found.is_poisson, "{found:?}");
    }

    #[test]
    fn few_runs_leave_the_plan_open() {
        let plan = planned("all", 1.3, &[Spread { variance: 0.04, runs: 8, is_poisson: false }]);
        let (low, runs, high) = (plan.low.unwrap(), plan.runs.unwrap(), plan.high.unwrap());
        assert!(low < runs && runs < high && high > 3 * runs, "{plan:?}");
    }
}
