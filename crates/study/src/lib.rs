//! Error against run time, for every choice in closecall's design: `closecall study`.
//!
//! Each axis is one choice. Its methods run on the same items, in turns, in one process. Their errors are relative to a
//! reference that is independent of all of them: [`reference`](mod@reference), or the paths that the vehicles really drove.

mod candidates;
mod chosen_measures;
mod clock;
mod coverage;
mod curvature;
mod decisions;
mod driven;
mod first_contact;
mod in_short;
mod longest_wait;
mod measurement;
mod mu_models;
mod numbers;
mod page;
mod panels;
mod path;
mod quadratures;
mod recorded;
mod recording;
pub mod reference;
mod roll_outs;
pub mod stress;
mod tolerance;
mod turns;
mod volume;

use std::path::Path;

use closecall_analysis::rows_csv;
use closecall_analysis::study::error_over_time;
use closecall_analysis::study::pareto::is_on_front;
use closecall_run::util::output_file;
use closecall_run::{Error, Result};

pub use measurement::{Axis, Measurement, Plan, Recorder, RolledOut, Roller, Simulator};

/// Measures one axis.
///
/// # Errors
/// For the axes that need SUMO: if it cannot be run, or what it wrote cannot be read.
pub fn measure(axis: Axis, plan: &Plan, simulator: Option<Simulator>) -> Result<Vec<Measurement>> {
    let mut rows = match axis {
        Axis::Volume => volume::measure(plan),
        Axis::Candidates => candidates::measure(plan),
        Axis::Time => first_contact::measure(plan),
        Axis::Braking => mu_models::measure(plan),
        Axis::Late => longest_wait::measure(plan),
        Axis::Probability => quadratures::measure(plan),
        Axis::Numbers => numbers::measure(plan),
        Axis::Turning => turns::measure(plan),
        Axis::Curvature => curvature::measure(plan),
        Axis::Coverage => coverage::measure(plan),
        Axis::RollOuts | Axis::Path | Axis::Recording | Axis::Tolerance | Axis::Measures => match (axis, simulator) {
            (Axis::RollOuts, Some(Simulator::RollOut(roll_out))) => roll_outs::measure(plan, roll_out)?,
            (Axis::Path, Some(Simulator::Record(record))) => path::measure(plan, record)?,
            (Axis::Recording, Some(Simulator::Record(record))) => recording::measure(plan, record)?,
            (Axis::Tolerance, Some(Simulator::Record(record))) => tolerance::measure(plan, record)?,
            (Axis::Measures, Some(Simulator::Record(record))) => chosen_measures::measure(plan, record)?,
            _ => return Err(Error::Value(format!("the {} axis needs SUMO", axis.name()))),
        },
    };
    mark_fronts(&mut rows);
    Ok(rows)
}

/// Writes `study.csv`, the charts and `study.md` into a folder.
///
/// # Errors
/// An error that names the file that cannot be written.
pub fn write(folder: &Path, rows: &[Measurement], plan: &Plan) -> closecall_analysis::Result<()> {
    rows_csv::write(&folder.join("study.csv"), rows)?;
    for axis in Axis::ALL {
        let of_axis = rows.iter().filter(|row| row.axis == axis).cloned().collect::<Vec<_>>();
        // Shares of intervals that hold the truth are a table.
        if !of_axis.is_empty() && axis != Axis::Coverage {
            error_over_time::draw(folder, axis.name(), &panels::panels(axis, &of_axis), panels::note(axis))?;
        }
    }
    Ok(output_file::write(&folder.join("study.md"), page::of(rows, plan.quick).as_bytes())?)
}

/// Marks the rows that no other row of the same scene beats in error, time or both.
fn mark_fronts(rows: &mut [Measurement]) {
    let point = |row: &Measurement| [row.ns_per_item, row.error];
    for index in 0..rows.len() {
        let of_scene = rows.iter().filter(|row| row.scene == rows[index].scene).map(point);
        rows[index].on_pareto_front = is_on_front(point(&rows[index]), of_scene);
    }
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
    fn the_front_holds_every_method_that_none_beats() {
        let mut rows = vec![row("fast", 0.1, 1.0), row("exact", 0.0, 5.0), row("neither", 0.1, 6.0)];
        mark_fronts(&mut rows);
        assert_eq!(rows.iter().map(|row| row.on_pareto_front).collect::<Vec<_>>(), [true, true, false]);
    }
}
