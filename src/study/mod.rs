//! Error against run time, for every choice that closecall makes: `closecall study`.
//!
//! Each axis is one choice. Its methods are run on the same items, in turns, in one process; what each gets wrong is
//! found by a reference that knows none of them ([`crate::reference`], or where the vehicles really drove).

mod braking;
mod candidates;
mod chart;
mod clock;
mod decisions;
mod driven;
mod numbers;
mod page;
mod path;
mod time;
mod volume;

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::units::Second;
use crate::{Error, Result};
use clock::machine;

/// A choice that closecall makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// How to decide whether two rectangles touch.
    Volume,
    /// How to find the pairs that are near each other.
    Candidates,
    /// Positions checked now and then, or swept.
    Time,
    /// Model of μ, or the braking equations integrated.
    Braking,
    /// f32 or f64, and from which origin.
    Numbers,
    /// Where a road user will go.
    Path,
}

impl Axis {
    /// All of them, in the order of the flow from a pair to its path.
    pub const ALL: [Self; 6] = [Self::Volume, Self::Candidates, Self::Time, Self::Braking, Self::Numbers, Self::Path];

    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Volume => "volume",
            Self::Candidates => "candidates",
            Self::Time => "time",
            Self::Braking => "braking",
            Self::Numbers => "numbers",
            Self::Path => "path",
        }
    }
}

/// One method on one set of items: a row of `study.csv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// The choice.
    pub axis: Axis,
    /// The method.
    pub method: &'static str,
    /// The set of items, and the method's own parameter if it has one.
    pub parameter: String,
    /// What the error is.
    pub error_name: &'static str,
    /// The error, 0 for none.
    pub error: f64,
    /// Share of what should be found that is not.
    pub false_negative_rate: f64,
    /// Share of what is found that should not be, or of what should not be found that is.
    pub false_positive_rate: f64,
    /// Median run time.
    pub ns_per_item: f64,
    /// How many items each run had.
    pub items: usize,
    /// Whether no other method on the same items has less error in less time.
    pub on_pareto_front: bool,
    /// The set of items: what may be compared with each other.
    #[serde(skip)]
    pub scene: String,
    /// Whether closecall does it so.
    #[serde(skip)]
    pub default: bool,
}

/// What to measure, and with what.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Fewer items and repetitions: all axes within two minutes.
    pub quick: bool,
    /// The folder of the scenarios that the path axis runs.
    pub nets: PathBuf,
}

/// Runs a SUMO configuration up to a time and writes its fcd-output, every 0.1 s.
pub type Record<'a> = dyn FnMut(&Path, &Path, Second) -> Result<()> + 'a;

/// Measures one axis.
///
/// # Errors
/// Of the path axis: where SUMO cannot be run, or a recording not be read.
pub fn measure(axis: Axis, plan: &Plan, record: Option<&mut Record>) -> Result<Vec<Measurement>> {
    let mut rows = match axis {
        Axis::Volume => volume::measure(plan),
        Axis::Candidates => candidates::measure(plan),
        Axis::Time => time::measure(plan),
        Axis::Braking => braking::measure(plan),
        Axis::Numbers => numbers::measure(plan),
        Axis::Path => {
            let record = record.ok_or_else(|| Error::Value("the path axis needs SUMO".to_owned()))?;
            path::measure(plan, record)?
        }
    };
    mark_fronts(&mut rows);
    Ok(rows)
}

/// Writes `study.csv`, the charts and `study.md` into a folder.
///
/// # Errors
/// An error that names the file that cannot be written.
pub fn write(folder: &Path, rows: &[Measurement]) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
    let path = folder.join("study.csv");
    let failed = |error: csv::Error| Error::content(&path, error.to_string());
    let mut writer = csv::Writer::from_path(&path).map_err(failed)?;
    rows.iter().try_for_each(|row| writer.serialize(row)).map_err(failed)?;
    writer.flush().map_err(|source| Error::file(&path, source))?;
    for axis in Axis::ALL {
        let of_axis = rows.iter().filter(|row| row.axis == axis).cloned().collect::<Vec<_>>();
        if !of_axis.is_empty() {
            chart::draw(folder, axis, &of_axis)?;
        }
    }
    let path = folder.join("study.md");
    std::fs::write(&path, page::of(rows)).map_err(|source| Error::file(&path, source))
}

/// Marks the rows that no other row of the same scene beats in error, time or both.
fn mark_fronts(rows: &mut [Measurement]) {
    /// Run times that differ by less are the same: medians repeat to about this.
    const SAME_TIME: f64 = 1.05;
    let beats = |other: &Measurement, row: &Measurement| {
        let faster = other.ns_per_item * SAME_TIME < row.ns_per_item;
        let slower = row.ns_per_item * SAME_TIME < other.ns_per_item;
        other.scene == row.scene && other.error <= row.error && !slower && (faster || other.error < row.error)
    };
    for index in 0..rows.len() {
        rows[index].on_pareto_front = !rows.iter().any(|other| beats(other, &rows[index]));
    }
}

/// The scenes of these rows, in their order.
fn scenes(rows: &[Measurement]) -> Vec<&str> {
    let mut scenes = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene.as_str()) {
            scenes.push(row.scene.as_str());
        }
    }
    scenes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &'static str, error: f64, ns_per_item: f64) -> Measurement {
        Measurement {
            axis: Axis::Volume,
            method,
            parameter: String::new(),
            error_name: "",
            error,
            false_negative_rate: 0.0,
            false_positive_rate: 0.0,
            ns_per_item,
            items: 1,
            on_pareto_front: false,
            scene: String::new(),
            default: false,
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let mut rows = vec![row("fast", 0.1, 1.0), row("exact", 0.0, 5.0), row("neither", 0.1, 6.0)];
        mark_fronts(&mut rows);
        assert_eq!(rows.iter().map(|row| row.on_pareto_front).collect::<Vec<_>>(), [true, true, false]);
    }
}
