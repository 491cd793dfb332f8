//! Two sets of runs beside each other: before and after, plan A and plan B.

use serde::Serialize;

use super::collect::{Collection, MEASURES};
use super::permutation::{DRAWS, Test, holm, p_value, smallest_p};
use super::quantiles::{cliffs_delta, quantile};
use super::rate::{Ratio, rate_ratio};
use crate::analysis::logged::LoggedRun;
use crate::detection::kind::{Kind, Severity};

/// How two sets of runs differ.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Runs of the first set.
    pub runs: usize,
    /// Runs of the set that it is held against.
    pub against_runs: usize,
    /// Of what the rates are per: vehicle-kilometres, or hours where there are none.
    pub rates_per: &'static str,
    /// Rates by kind and by severity.
    pub rates: Vec<RateDifference>,
    /// Measures.
    pub measures: Vec<MeasureDifference>,
    /// What the significance rests on, where it rests on little.
    pub note: Option<String>,
}

/// How a rate differs.
#[derive(Clone, Debug, Serialize)]
pub struct RateDifference {
    /// `all`, a kind or a severity.
    pub group: &'static str,
    /// The first set's rate.
    pub rate: f64,
    /// The other set's rate.
    pub against: f64,
    /// First less other.
    pub difference: f64,
    /// First / other: the effect size.
    pub ratio: Option<Ratio>,
    /// How sure it is that they differ.
    pub significance: Option<Significance>,
}

/// How a measure differs.
#[derive(Clone, Debug, Serialize)]
pub struct MeasureDifference {
    /// `ttc`, `pet`, `margin` or `delta_v`.
    pub measure: &'static str,
    /// The first set's median over all conflicts.
    pub median: Option<f64>,
    /// The other set's.
    pub against: Option<f64>,
    /// First less other.
    pub difference: Option<f64>,
    /// Cliff's delta: the effect size; above 0 where the first set's values are larger.
    pub cliffs_delta: Option<f64>,
    /// How sure it is that the runs' medians differ.
    pub significance: Option<Significance>,
}

/// Above this corrected p-value a difference may be chance.
const LEVEL: f64 = 0.05;

/// How sure it is that two sets differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Significance {
    /// The p-value.
    pub p: f64,
    /// Holm's correction of it for all rows of the comparison.
    pub p_holm: f64,
    /// How it was found.
    pub test: Test,
}

/// Holds a set of runs against another.
pub fn compare(first: &Collection, other: &Collection) -> Comparison {
    let kilometres = |run: &LoggedRun| run.summary.exposure.vehicle_kilometres;
    let has_kilometres = [first, other].iter().all(|set| set.runs.iter().map(kilometres).sum::<f64>() > 0.0);
    let traffic = |set: &Collection| -> Vec<f64> {
        set.runs.iter().map(|run| if has_kilometres { kilometres(run) } else { run.hours() }).collect()
    };
    let traffics = [traffic(first), traffic(other)];
    let mut rates = groups()
        .map(|(group, kind, severity)| {
            rate_difference(group, [first, other].map(|set| set.counts(kind, severity)), &traffics)
        })
        .collect::<Vec<_>>();
    let mut measures = (0..MEASURES.len()).map(|measure| measure_difference(measure, first, other)).collect::<Vec<_>>();
    let found = rates.iter_mut().map(|row| &mut row.significance);
    let tested = found.chain(measures.iter_mut().map(|row| &mut row.significance)).flatten().collect::<Vec<_>>();
    let (runs, against_runs) = (first.runs.len(), other.runs.len());
    let least = smallest_p(runs, against_runs, DRAWS) * tested.len() as f64;
    let note = (least > LEVEL).then(|| {
        format!(
            "{runs} and {against_runs} runs: of so few no difference in {} tests can be significant at {LEVEL}; of 6 \
             seeds each or more one can",
            tested.len()
        )
    });
    correct(tested);
    Comparison {
        runs,
        against_runs,
        rates_per: if has_kilometres { "vehicle_kilometre" } else { "hour" },
        rates,
        measures,
        note,
    }
}

/// What has a rate of its own: all, each kind, each severity.
fn groups() -> impl Iterator<Item = (&'static str, Option<Kind>, Option<Severity>)> {
    let kinds = Kind::ALL.into_iter().map(|kind| (kind.name(), Some(kind), None));
    let severities = Severity::ALL.into_iter().map(|severity| (severity.name(), None, Some(severity)));
    std::iter::once(("all", None, None)).chain(kinds).chain(severities)
}

fn rate_difference(group: &'static str, counts: [Vec<f64>; 2], traffic: &[Vec<f64>; 2]) -> RateDifference {
    let value = |set: usize| {
        let total = traffic[set].iter().sum::<f64>();
        if total > 0.0 { counts[set].iter().sum::<f64>() / total } else { 0.0 }
    };
    let (rate, against) = (value(0), value(1));
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
    // Where nobody has any there is nothing to test.
    let tested = if rate + against > 0.0 { p_value(all.len(), counts[0].len(), difference) } else { None };
    RateDifference {
        group,
        rate,
        against,
        difference: rate - against,
        ratio: rate_ratio((&counts[0], &traffic[0]), (&counts[1], &traffic[1])),
        significance: tested.map(|(p, test)| Significance { p, p_holm: p, test }),
    }
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
    let (median, against) = (quantile(&values, 0.5), quantile(&other_values, 0.5));
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
