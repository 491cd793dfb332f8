//! The measures of a run: counts and rates by kind and severity, the risk index, quantiles.

use std::iter::once;

use super::estimate::{Estimate, mean};
use crate::Result;
use crate::batch::sweep::Task;
use crate::logged::{ConflictReader, LoggedConflict, LoggedRun, Packed, RunTime};
use crate::statistics::{quantile, rate};
use closecall::detection::kind::{Kind, Severity};
use closecall_run::output::schema::{Column, Value};

/// The columns whose quantiles are measures.
const COLUMNS: [&str; 4] = ["ttc", "drac", "ttb", "margin"];
/// The quantiles.
const SHARES: [(&str, f64); 3] = [("q05", 0.05), ("q50", 0.5), ("q95", 0.95)];
/// The sum of crash probabilities, and the same per vehicle-kilometre.
const RISK_INDEX: &str = "risk_index";
/// The end of the names of rates.
const PER_VEHICLE_HOUR: &str = "_per_vehicle_hour";

/// A number that a run has.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// Its name in `study.csv`.
    pub name: String,
    form: Form,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// A count per run.
    Count,
    /// A count per vehicle-hour.
    Rate,
    Value,
}

/// What one run found, and what it took.
#[derive(Clone, Debug)]
pub struct RunFigures {
    /// The value of each of the [`measures`]; none where no conflict has it.
    pub values: Vec<Option<f64>>,
    vehicle_hours: f64,
    /// What the run took.
    pub run_time: RunTime,
}

/// The conflicts that a count is of.
struct Tally {
    name: String,
    counts: Box<dyn Fn(&LoggedConflict) -> bool>,
}

fn tallies() -> Vec<Tally> {
    fn tally(name: impl Into<String>, counts: impl Fn(&LoggedConflict) -> bool + 'static) -> Tally {
        Tally { name: name.into(), counts: Box::new(counts) }
    }
    let kinds = Kind::ALL.map(|kind| tally(kind.name(), move |conflict| conflict.kind == kind));
    let severities =
        Severity::ALL.map(|severity| tally(severity.name(), move |conflict| conflict.severity == severity));
    let both = Kind::ALL.into_iter().flat_map(|kind| {
        Severity::ALL.map(|severity| {
            let name = format!("{}_{}", kind.name(), severity.name());
            tally(name, move |conflict| conflict.kind == kind && conflict.severity == severity)
        })
    });
    once(tally("conflicts", |_| true))
        .chain([tally("serious_or_critical", |conflict| conflict.severity != Severity::Caution)])
        .chain([tally("collisions", |conflict| conflict.collision)])
        .chain(kinds)
        .chain(severities)
        .chain(both)
        .collect()
}

/// All measures, in the order of [`RunFigures::values`].
pub fn measures() -> Vec<Measure> {
    let measure = |name: String, form| Measure { name, form };
    let counts = tallies().into_iter().flat_map(|tally| {
        let per_hour = format!("{}{PER_VEHICLE_HOUR}", tally.name);
        [measure(tally.name, Form::Count), measure(per_hour, Form::Rate)]
    });
    let risk = ["", "_per_vehicle_kilometre"].map(|per| measure(format!("{RISK_INDEX}{per}"), Form::Value));
    let quantiles = COLUMNS.iter().flat_map(|column| SHARES.map(|(name, _)| format!("{column}_{name}")));
    counts.chain(risk).chain(quantiles.map(|name| measure(name, Form::Value))).collect()
}

impl RunFigures {
    /// Reads the log of a run that is done.
    pub fn of(task: &Task) -> Result<Self> {
        let folder = task.log();
        let run = LoggedRun::read(&folder)?;
        let vehicle_hours = run.summary.exposure.vehicle_hours;
        let per_hour = |value: f64| (vehicle_hours > 0.0).then(|| value / vehicle_hours);
        let tallies = tallies();
        let mut counts = vec![0.0; tallies.len()];
        let columns = COLUMNS.map(Column::named);
        let mut samples = [const { Vec::new() }; COLUMNS.len()];
        for conflict in ConflictReader::open(&folder)? {
            let conflict = conflict?;
            if run.sets_aside(&conflict) {
                continue;
            }
            for (count, tally) in counts.iter_mut().zip(&tallies) {
                *count += f64::from(u8::from((tally.counts)(&conflict)));
            }
            for (sample, column) in samples.iter_mut().zip(columns) {
                if let Some(Value::Number(value)) = column.map(|column| (column.get)(&conflict)) {
                    sample.push(value);
                }
            }
        }
        let mut values = Vec::new();
        for count in counts {
            values.extend([Some(count), per_hour(count)]);
        }
        let risk = run.summary.risk_index;
        let kilometres = run.summary.exposure.vehicle_kilometres;
        values.extend([Some(risk), (kilometres > 0.0).then(|| risk / kilometres)]);
        for mut sample in samples {
            sample.sort_unstable_by(f64::total_cmp);
            values.extend(SHARES.map(|(_, share)| quantile(&sample, share)));
        }
        let run_time = Packed::of(&task.file())?.run_time.unwrap_or_default();
        Ok(Self { values, vehicle_hours, run_time })
    }
}

impl Measure {
    /// Whether its values may be below 0: of counts, rates, times and decelerations none is.
    pub(crate) fn may_be_negative(&self) -> bool {
        self.name.starts_with("margin")
    }

    /// Whether the same per traffic is a measure too.
    pub(crate) fn has_rate(&self) -> bool {
        self.form == Form::Count || self.name == RISK_INDEX
    }

    /// The measure over the runs of a setting, one per seed, with its interval: that of a rate for counts, or else
    /// Student's t. `place` is that of the measure.
    pub fn estimate(&self, place: usize, runs: &[RunFigures]) -> Option<Estimate> {
        let values = runs.iter().filter_map(|run| run.values[place]).collect::<Vec<_>>();
        let of_counts = |counts: Vec<f64>, traffic: Vec<f64>| {
            rate(&counts, &traffic).map(|rate| Estimate { value: rate.value, interval: Some([rate.low, rate.high]) })
        };
        let hours = || runs.iter().map(|run| run.vehicle_hours);
        match self.form {
            Form::Count => of_counts(values.clone(), vec![1.0; values.len()]),
            Form::Rate => {
                let counts = runs.iter().zip(hours()).map(|(run, hours)| run.values[place].unwrap_or_default() * hours);
                of_counts(counts.collect(), hours().collect())
            }
            Form::Value => mean(&values),
        }
    }
}
