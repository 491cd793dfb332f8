//! Error against run time, on the user's own scenario: `closecall study SCENARIO`.
//!
//! A [`Plan`] lists settings around the user's own; a sweep runs each with every seed; [`Study`] reads the logs and compares
//! the settings of each axis over pairs of runs with the same seed, so that the noise of seeds is separated from the error of
//! the step. docs/step_length.md states the method.

mod comparison;
mod error_chart;
mod estimate;
mod measures;
mod page;
mod plan;
mod recommendation;
mod richardson;
mod rows;

use std::path::Path;

use crate::Result;
use closecall_run::util::output_file;

pub use comparison::Study;
pub use plan::Plan;

/// Writes `study.csv`, the charts and `study.md`; returns the sentences that answer the question.
///
/// # Errors
/// An error that names the file that cannot be written.
pub fn write(study: &Study, folder: &Path, scenario: &str) -> Result<String> {
    rows::write(study, &folder.join("study.csv"))?;
    let charts = error_chart::draw(study, folder)?;
    let answer = page::answer(study);
    output_file::write(&folder.join("study.md"), page::of(study, scenario, &answer, &charts).as_bytes())?;
    Ok(answer)
}
