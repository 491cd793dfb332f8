//! Comparison of two sets of runs: before and after, plan A and plan B.

use serde::Serialize;

use super::collect::{Collection, groups};
use super::counts::MEASURES;
use super::pairs::{Unit, pairs, ratio};
use super::permutation::{LEVEL, Test, holm, p_value, splits};
use super::planning::{Spread, detectable};
use super::quantiles::{cliffs_delta, quantile};
use super::rate::{IntervalMethod, Ratio};

/// How two sets of runs differ.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The number of runs in the first set.
    pub runs: usize,
    /// The number of runs in the other set.
    pub against_runs: usize,
    /// The unit of traffic: `vehicle_kilometre`, or `hour` if the runs have no kilometres.
    pub rates_per: &'static str,
    /// Rates overall, by kind and by severity, and the risk index.
    pub rates: Vec<RateDifference>,
    /// Medians of the measures.
    pub measures: Vec<MeasureDifference>,
    /// A warning if there are too few runs for any difference to be significant.
    pub note: Option<String>,
}

/// How a rate differs.
#[derive(Clone, Debug, Serialize)]
pub struct RateDifference {
    /// `all`, a kind, a severity or `risk_index`.
    pub group: &'static str,
    /// The first set's rate.
    pub rate: f64,
    /// The other set's rate.
    pub against: f64,
    /// First minus other.
    pub difference: f64,
    /// First / other: the effect size.
    pub ratio: Option<Ratio>,
    /// The significance of the difference.
    pub significance: Option<Significance>,
    /// The smallest ratio above 1 that these runs would find in 80 % of such comparisons, by one test at 5 %; none where a set
    /// has a single run or no conflict.
    pub detectable: Option<f64>,
}

/// How a measure differs.
#[derive(Clone, Debug, Serialize)]
pub struct MeasureDifference {
    /// `ttc`, `pet`, `margin` or `delta_v`.
    pub measure: &'static str,
    /// The first set's median over all conflicts.
    pub median: Option<f64>,
    /// The other set's median over all conflicts.
    pub against: Option<f64>,
    /// First minus other.
    pub difference: Option<f64>,
    /// Cliff's delta: the effect size; above 0 if the first set's values are larger.
    pub cliffs_delta: Option<f64>,
    /// The significance of the difference between the runs' medians.
    pub significance: Option<Significance>,
}

/// The significance of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Significance {
    /// The p-value.
    pub p: f64,
    /// The p-value with Holm's correction for all rows of the comparison.
    pub p_holm: f64,
    /// The test that it comes from.
    pub test: Test,
}

/// Compares two sets of runs.
pub fn compare(first: &Collection, other: &Collection) -> Comparison {
    let all = [first, other].map(|set| set.runs.iter().collect::<Vec<_>>());
    let unit = Unit::of(&[&all[0], &all[1]]);
    let traffics = all.each_ref().map(|runs| unit.of_each(runs));
    let pairs = pairs(&all[0], &all[1]);
    let mut rates = groups()
        .map(|(group, kind, severity)| {
            rate_difference(group, [first, other].map(|set| set.counts(kind, severity)), &traffics, pairs.as_deref())
        })
        .collect::<Vec<_>>();
    rates.push(risk_difference([first, other], &traffics, pairs.as_deref()));
    let mut measures = (0..MEASURES.len()).map(|measure| measure_difference(measure, first, other)).collect::<Vec<_>>();
    let found = rates.iter_mut().map(|row| &mut row.significance);
    let tested = found.chain(measures.iter_mut().map(|row| &mut row.significance)).flatten().collect::<Vec<_>>();
    let runs = first.runs.len();
    let against_runs = other.runs.len();
    let least = splits(runs + against_runs, runs).smallest_p() * tested.len() as f64;
    let note = (least > LEVEL).then(|| {
        format!(
            "{runs} and {against_runs} runs are too few for any difference in {} tests to be significant at {LEVEL}; run \
             at least 6 seeds each",
            tested.len()
        )
    });
    correct(tested);
    Comparison { runs, against_runs, rates_per: unit.name, rates, measures, note }
}

fn rate_difference(
    group: &'static str,
    counts: [Vec<f64>; 2],
    traffic: &[Vec<f64>; 2],
    pairs: Option<&[usize]>,
) -> RateDifference {
    let value = |set: usize| {
        let total = traffic[set].iter().sum::<f64>();
        if total > 0.0 { counts[set].iter().sum::<f64>() / total } else { 0.0 }
    };
    let rate = value(0);
    let against = value(1);
    let all = counts.concat();
    let all_traffic = traffic.concat();
    let difference = |split: &[bool]| {
        let mut sums = [[0.0; 2]; 2];
        for ((count, traffic), is_first) in all.iter().zip(&all_traffic).zip(split) {
            let [sum, total] = &mut sums[usize::from(!is_first)];
            *sum += count;
            *total += traffic;
        }
        let [[sum, total], [other, other_total]] = sums;
        (total > 0.0 && other_total > 0.0).then(|| sum / total - other / other_total)
    };
    // Without any conflict there is nothing to test.
    let tested = if rate + against > 0.0 { p_value(all.len(), counts[0].len(), difference) } else { None };
    RateDifference {
        group,
        rate,
        against,
        difference: rate - against,
        ratio: ratio((&counts[0], &traffic[0]), (&counts[1], &traffic[1]), pairs),
        significance: tested.map(|(p, test)| Significance { p, p_holm: p, test }),
        detectable: Spread::of(&counts[0], &traffic[0])
            .zip(Spread::of(&counts[1], &traffic[1]))
            .and_then(|(first, other)| detectable(first, other)),
    }
}

/// How the risk index differs. Without a spread over runs it has no interval, because it is not a count.
fn risk_difference(sets: [&Collection; 2], traffic: &[Vec<f64>; 2], pairs: Option<&[usize]>) -> RateDifference {
    let sums = sets.map(|set| set.risk.per_run(set.runs.len()));
    let row = rate_difference("risk_index", sums, traffic, pairs);
    let is_counted = row.ratio.is_some_and(|ratio| ratio.method == IntervalMethod::PoissonExact);
    if is_counted { RateDifference { ratio: None, detectable: None, ..row } } else { row }
}

fn measure_difference(measure: usize, first: &Collection, other: &Collection) -> MeasureDifference {
    let [values, other_values] = [first, other].map(|set| set.sorted(measure));
    let of = |set: &Collection| set.medians.iter().filter_map(|medians| medians[measure]).collect::<Vec<_>>();
    let runs = [of(first), of(other)];
    let medians = runs.concat();
    let difference = |split: &[bool]| {
        let mean = |wanted: bool| {
            let chosen = medians.iter().zip(split).filter(|(_, is_first)| **is_first == wanted);
            let (sum, count) = chosen.fold((0.0, 0.0), |(sum, count), (median, _)| (sum + median, count + 1.0));
            (count > 0.0).then(|| sum / count)
        };
        Some(mean(true)? - mean(false)?)
    };
    let tested = p_value(medians.len(), runs[0].len(), difference);
    let median = quantile(&values, 0.5);
    let against = quantile(&other_values, 0.5);
    MeasureDifference {
        measure: MEASURES[measure],
        median,
        against,
        difference: median.zip(against).map(|(median, against)| median - against),
        cliffs_delta: cliffs_delta(&values, &other_values),
        significance: tested.map(|(p, test)| Significance { p, p_holm: p, test }),
    }
}

fn correct(found: Vec<&mut Significance>) {
    let corrected = holm(&found.iter().map(|significance| significance.p).collect::<Vec<_>>());
    found.into_iter().zip(corrected).for_each(|(significance, p)| significance.p_holm = p);
}
