//! `closecall study`: error against run time, axis by axis.

use std::path::{Path, PathBuf};

use clap::Args;

use super::say::say;
use super::sumo::{RunRequest, Sumo};
use crate::Result;
use crate::options::Options;
use crate::output::folder::LogFolder;
use crate::output::formats::OutputFiles;
use crate::study::{self, Axis, Plan};
use crate::util::units::Second;

/// What to measure, and where to write it.
#[derive(Args)]
pub struct StudyArgs {
    /// Folder for study.csv, study.md and the charts.
    #[arg(short, long, value_name = "DIR", default_value = "closecall-study")]
    out: PathBuf,
    /// Use fewer items and repetitions, so that it takes under two minutes.
    #[arg(long)]
    quick: bool,
    /// Measure only this axis.
    #[arg(long, value_enum, value_name = "AXIS")]
    only: Option<Axis>,
    /// Folder with the scenarios for the path axis.
    #[arg(long, value_name = "DIR", default_value = "sumo_nets")]
    nets: PathBuf,
}

/// Measures the axes; writes each as soon as it is measured.
pub fn run(arguments: &StudyArgs, mut sumo: Option<Sumo>) -> Result<()> {
    let plan = Plan { quick: arguments.quick, nets: arguments.nets.clone() };
    let mut rows = Vec::new();
    for axis in Axis::ALL.into_iter().filter(|axis| arguments.only.is_none_or(|only| only == *axis)) {
        eprintln!("{} …", axis.name());
        let measured = match &mut sumo {
            Some(sumo) => {
                let mut record = |scenario: &Path, recording: &Path, end: Second| {
                    let request = recorded(scenario, recording, end);
                    (sumo.simulate)(&request, LogFolder::claim(&request.out)?).map(|_| ())
                };
                study::measure(axis, &plan, Some(&mut record))?
            }
            None if axis == Axis::Path && arguments.only.is_none() => {
                eprintln!("skipped: this binary was built without Python and cannot run SUMO");
                continue;
            }
            None => study::measure(axis, &plan, None)?,
        };
        rows.extend(measured);
        study::write(&arguments.out, &rows)?;
    }
    say(format_args!("{} rows in {}\n", rows.len(), arguments.out.join("study.csv").display()))?;
    let off = rows.iter().filter(|row| row.default && !row.on_pareto_front);
    for row in off {
        say(format_args!("off the Pareto front: {} {} ({})\n", row.axis.name(), row.method, row.parameter))?;
    }
    Ok(())
}

/// A run of a scenario that records every step as fcd-output.
fn recorded(scenario: &Path, recording: &Path, end: Second) -> RunRequest {
    let words = [
        "-c",
        &scenario.display().to_string(),
        "--end",
        &end.to_string(),
        "--step-length",
        "0.1",
        "--fcd-output",
        &recording.display().to_string(),
        "--fcd-output.attributes",
        "all",
        "--precision",
        "9",
        "--no-warnings",
    ];
    RunRequest {
        scenario: scenario.to_owned(),
        gui: false,
        out: recording.with_extension("log"),
        threads: 2,
        quiet: true,
        outputs: OutputFiles::default(),
        options: Options::default(),
        sumo_words: words.map(str::to_owned).to_vec(),
    }
}
