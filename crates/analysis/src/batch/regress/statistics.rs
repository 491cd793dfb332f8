//! [`super::Level::Statistics`]: the runs of several seeds, compared by one permutation test.
//!
//! Each run becomes a row of measures: counts by kind and severity, collisions, rates per vehicle-kilometre, traffic,
//! and the 10th, 50th and 90th percentiles of TTC, PET and margin. The test is [`super::joint_permutation`].

use super::joint_permutation::adjusted_p;
use super::outcome::{Outcome, SeedConflict, SeedSummary};
use super::scenario::{RegressSettings, Tolerance};
use crate::statistics::quantile;
use closecall::detection::kind::{Kind, Severity};

/// The percentiles that are compared, with their names.
const PERCENTILES: [(f64, &str); 3] = [(0.1, "10 %"), (0.5, "median"), (0.9, "90 %")];

/// A measure of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RunMeasure {
    Kind(Kind),
    Severity(Severity),
    Collisions,
    /// Conflicts of a kind, or all, per vehicle-km.
    Rate(Option<Kind>),
    VehicleKilometres,
    Persons,
    /// A column, the share of its percentile, and the percentile's name.
    Percentile(&'static str, f64, &'static str),
}

/// One measure, expected and found.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureComparison {
    /// The name of the measure, with its unit.
    pub name: String,
    /// The expected mean over the seeds; none if no seed has a value.
    pub expected: Option<f64>,
    /// The mean over the seeds of these runs; none if no seed has a value.
    pub found: Option<f64>,
    /// The share of splits in which any measure differs at least this much.
    pub p: f64,
    /// Whether the difference counts: p is small enough, and the means differ by more than the tolerance.
    pub differs: bool,
}

impl std::fmt::Display for MeasureComparison {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let text = |mean: Option<f64>| mean.map_or("none".to_owned(), |mean| format!("{mean:.3}"));
        write!(f, "{}: {} → {} (p = {:.5})", self.name, text(self.expected), text(self.found), self.p)
    }
}

/// Compares every measure. If nothing changed, the chance that any is found to differ is at most `settings.false_alarm`.
pub fn comparisons(expected: &Outcome, found: &Outcome, settings: &RegressSettings) -> Vec<MeasureComparison> {
    let measures = measures();
    let table = |outcome: &Outcome| {
        let counts_artefacts = outcome.summary.counts_artefacts();
        let of_seed = |seed: &SeedSummary| {
            let rows = outcome.conflicts.iter().filter(|row| row.seed == seed.seed);
            let rows = rows.filter(|row| counts_artefacts || row.text("artefact").is_empty()).collect::<Vec<_>>();
            measures.iter().map(|measure| measure.of(seed, &rows)).collect::<Vec<_>>()
        };
        outcome.summary.seeds.iter().map(of_seed).collect::<Vec<_>>()
    };
    let before = table(expected);
    let now = table(found);
    let filled = filled(&before, &now, measures.len());
    let (filled_before, filled_now) = filled.split_at(before.len());
    let p = adjusted_p(filled_before, filled_now);
    let mean = |runs: &[Vec<Option<f64>>], measure: usize| {
        let values = runs.iter().filter_map(|run| run[measure]).collect::<Vec<_>>();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let compare = |(place, measure): (usize, &RunMeasure)| {
        let expected = mean(&before, place);
        let found = mean(&now, place);
        let apart = match (expected, found) {
            (Some(old), Some(new)) => (new - old).abs() > measure.tolerated(old, &settings.tolerance),
            _ => false,
        };
        MeasureComparison {
            name: measure.name(),
            expected,
            found,
            p: p[place],
            differs: apart && p[place] <= settings.false_alarm,
        }
    };
    measures.iter().enumerate().map(compare).collect()
}

/// The values of all runs; a missing value is replaced by the mean of the others, which favours neither side.
fn filled(before: &[Vec<Option<f64>>], now: &[Vec<Option<f64>>], measures: usize) -> Vec<Vec<f64>> {
    let all = before.iter().chain(now).collect::<Vec<_>>();
    let means = (0..measures)
        .map(|measure| {
            let values = all.iter().filter_map(|run| run[measure]).collect::<Vec<_>>();
            values.iter().sum::<f64>() / (values.len() as f64).max(1.0)
        })
        .collect::<Vec<_>>();
    all.iter().map(|run| run.iter().zip(&means).map(|(value, mean)| value.unwrap_or(*mean)).collect()).collect()
}

fn measures() -> Vec<RunMeasure> {
    let counts = Kind::ALL.map(RunMeasure::Kind).into_iter().chain(Severity::ALL.map(RunMeasure::Severity));
    let rates = Kind::ALL.map(Some).into_iter().chain([None]).map(RunMeasure::Rate);
    let percentiles = ["ttc", "pet", "margin"]
        .into_iter()
        .flat_map(|column| PERCENTILES.map(|(share, name)| RunMeasure::Percentile(column, share, name)));
    counts
        .chain([RunMeasure::Collisions])
        .chain(rates)
        .chain([RunMeasure::VehicleKilometres, RunMeasure::Persons])
        .chain(percentiles)
        .collect()
}

impl RunMeasure {
    fn name(self) -> String {
        match self {
            Self::Kind(kind) => format!("{} conflicts per run", kind.name()),
            Self::Severity(severity) => format!("{} conflicts per run", severity.name()),
            Self::Collisions => "collisions per run".to_owned(),
            Self::Rate(kind) => format!("{} conflicts per vehicle-km", kind.map_or("all", Kind::name)),
            Self::VehicleKilometres => "vehicle-km per run".to_owned(),
            Self::Persons => "persons per run".to_owned(),
            Self::Percentile(column, _, name) => {
                let unit = if column == "margin" { "m" } else { "s" };
                format!("{column}, {name}, in {unit}")
            }
        }
    }

    fn of(self, seed: &SeedSummary, rows: &[&SeedConflict]) -> Option<f64> {
        let count = |kind: Option<Kind>, severity: Option<Severity>| {
            let wanted = seed.conflicts.iter().filter(|count| {
                count.artefact.is_none()
                    && kind.is_none_or(|kind| kind == count.kind)
                    && severity.is_none_or(|severity| severity == count.severity)
            });
            wanted.map(|count| count.count).sum::<u64>() as f64
        };
        match self {
            Self::Kind(kind) => Some(count(Some(kind), None)),
            Self::Severity(severity) => Some(count(None, Some(severity))),
            Self::Collisions => Some(seed.collisions as f64),
            Self::Rate(kind) => {
                let kilometres = seed.exposure.vehicle_kilometres;
                (kilometres > 0.0).then(|| count(kind, None) / kilometres)
            }
            Self::VehicleKilometres => Some(seed.exposure.vehicle_kilometres),
            Self::Persons => Some(seed.exposure.persons as f64),
            Self::Percentile(column, share, _) => percentile(rows.iter().filter_map(|row| row.number(column)), share),
        }
    }

    /// The largest difference from `expected` that is ignored.
    fn tolerated(self, expected: f64, tolerance: &Tolerance) -> f64 {
        match self {
            Self::Percentile("ttc", ..) => tolerance.ttc,
            Self::Percentile("pet", ..) => tolerance.pet,
            Self::Percentile(..) => tolerance.margin,
            _ => tolerance.count * expected.abs(),
        }
    }
}

/// A percentile, linear between the two nearest values.
fn percentile(values: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut sorted = values.collect::<Vec<_>>();
    sorted.sort_by(f64::total_cmp);
    quantile(&sorted, share)
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::statistics::*;

    #[test]
    fn percentiles_lie_between_the_nearest_values() {
        let values = || [4.0, 1.0, 3.0, 2.0].into_iter();
        assert_eq!([0.0, 0.5, 1.0].map(|share| percentile(values(), share)), [Some(1.0), Some(2.5), Some(4.0)]);
        assert_eq!(percentile(std::iter::empty(), 0.5), None);
    }
}
