//! `study.csv`: a row for each measure of each value of each axis.

use std::path::Path;

use serde::Serialize;

use super::comparison::Study;
use super::richardson::Convergence;
use crate::{Error, Result};
use closecall_run::util::output_file::OutputFile;

/// The value of the row with the limit at a step of 0.
const EXTRAPOLATED: &str = "extrapolated";

#[derive(Debug, Default, Serialize)]
struct Row<'a> {
    axis: &'a str,
    value: &'a str,
    /// Whether this is the user's own setting.
    own: bool,
    seeds: &'a str,
    measure: &'a str,
    mean: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    /// Against the finest step, whose own error is in the interval, or the user's own value on other axes.
    relative_error: Option<f64>,
    error_low: Option<f64>,
    error_high: Option<f64>,
    /// The observed order of convergence, in the row of the extrapolated value.
    order: Option<f64>,
    on_pareto_front: Option<bool>,
    /// Whether this is the coarsest step within the accuracy.
    recommended: Option<bool>,
    seconds: Option<f64>,
    cpu_seconds: Option<f64>,
}

pub(super) fn write(study: &Study, path: &Path) -> Result<()> {
    let failed = |error: csv::Error| Error::content(path, error.to_string());
    let mut table = OutputFile::create(path)?;
    let mut writer = csv::Writer::from_writer(&mut table);
    for axis in &study.plan.axes {
        for (place, measure) in study.measures.iter().enumerate() {
            let row = || Row { axis: &axis.name, seeds: &study.seeds, measure: &measure.name, ..Row::default() };
            let front = axis.has_steps().then(|| (study.front(axis, place), study.recommended(axis, place)));
            for ((at, choice), error) in axis.choices.iter().enumerate().zip(study.errors(axis, place)) {
                let estimate = study.estimate(choice.setting, place);
                let end = |end: usize| estimate.and_then(|estimate| estimate.interval).map(|ends| ends[end]);
                let error_end = |end: usize| error.and_then(|error| error.interval).map(|ends| ends[end]);
                let run_time = study.run_time(choice.setting);
                let row = Row {
                    value: &choice.value,
                    own: choice.setting == 0,
                    mean: estimate.map(|estimate| estimate.value),
                    low: end(0),
                    high: end(1),
                    relative_error: error.map(|error| error.value),
                    error_low: error_end(0),
                    error_high: error_end(1),
                    on_pareto_front: front.as_ref().map(|(front, _)| front[at]),
                    recommended: front.as_ref().map(|(_, recommended)| at == *recommended),
                    seconds: Some(run_time.wall),
                    cpu_seconds: Some(run_time.cpu),
                    ..row()
                };
                writer.serialize(row).map_err(failed)?;
            }
            if let (true, Convergence::Order { order, limit, half_width }) =
                (axis.has_steps(), study.convergence(axis, place))
            {
                let least = if measure.may_be_negative() { f64::NEG_INFINITY } else { 0.0 };
                let (low, high) = (Some((limit - half_width).max(least)), Some(limit + half_width));
                let row = Row { value: EXTRAPOLATED, mean: Some(limit), low, high, order: Some(order), ..row() };
                writer.serialize(row).map_err(failed)?;
            }
        }
    }
    writer.flush().map_err(|source| Error::file(path, source))?;
    drop(writer);
    Ok(table.finish()?)
}
