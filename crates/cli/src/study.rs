//! `closecall study`: error against run time, of closecall's own choices axis by axis, or of a scenario's.

use std::path::{Path, PathBuf};

use clap::Args;

use super::error::Result;
use super::print::{print, value};
use super::study_scenario::{RESULTS, ScenarioArgs};
use super::sumo::{RunRequest, Sumo};
use super::sweep::ParseRun;
use super::whatif::roll_out;
use super::workers::Workers;
use closecall::util::threads::processors;
use closecall::util::units::{Second, counted};
use closecall_analysis::batch::sweep::Task;
use closecall_analysis::batch::whatif::{Asked, Tools, WhatIf};
use closecall_analysis::logged::worst;
use closecall_run::output::folder::LogFolder;
use closecall_run::output::formats::OutputFiles;
use closecall_run::run::roll_out::{Outcome, ROLL_OUT};
use closecall_run::{Error as RunError, RunOptions};
use closecall_study::{self, Axis, Plan, RolledOut, Simulator};

/// How long a roll-out goes on after the conflict opened, in s: as in `closecall whatif`.
const HORIZON: Second = 8.0;

/// What to measure, and where to write it.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct StudyArgs {
    /// SUMO configuration file: study this scenario's step length and other settings, instead of closecall's own choices.
    #[arg(value_name = "SCENARIO", help_heading = None::<&str>)]
    scenario: Option<PathBuf>,
    /// Fewer items, repetitions, values and seeds; without a scenario it takes about two minutes.
    #[arg(long)]
    quick: bool,
    /// Measure only this axis of closecall's own choices.
    #[arg(long, value_enum, value_name = "AXIS", conflicts_with = "scenario")]
    only: Option<Axis>,
    /// Folder with the scenarios for the axes of closecall's own choices that replay recordings.
    #[arg(long, value_name = "DIR", default_value = "sumo_nets", conflicts_with = "scenario")]
    nets: PathBuf,
    #[command(flatten)]
    of_scenario: ScenarioArgs,
    /// Folder for study.csv, study.md and the charts [default: closecall-study, next to the scenario if there is one].
    #[arg(short, long, value_name = "DIR", help_heading = "Output", display_order = 0)]
    out: Option<PathBuf>,
}

/// Studies the scenario, or closecall's own choices; returns the exit status.
pub fn run(arguments: StudyArgs, sumo: Option<Sumo>, parse_run: &ParseRun) -> Result<u8> {
    match &arguments.scenario {
        Some(scenario) => {
            arguments.of_scenario.run(scenario, arguments.out.as_deref(), arguments.quick, sumo, parse_run)
        }
        None => {
            arguments.of_scenario.check_without_scenario()?;
            own_choices(&arguments, sumo).map(|()| 0)
        }
    }
}

/// Measures the axes; writes each as soon as it is measured.
fn own_choices(arguments: &StudyArgs, mut sumo: Option<Sumo>) -> Result<()> {
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from(RESULTS));
    let plan = Plan { quick: arguments.quick, nets: arguments.nets.clone() };
    let mut rows = Vec::new();
    for axis in Axis::ALL.into_iter().filter(|axis| arguments.only.is_none_or(|only| only == *axis)) {
        eprintln!("{} …", axis.name());
        let measured = match &mut sumo {
            Some(sumo) if axis == Axis::RollOuts => {
                let mut roll_out = |scenario: &Path, end: Second, count: u32| {
                    rolled_out(sumo, scenario, end, count).map_err(|error| RunError::Value(error.to_string()))
                };
                closecall_study::measure(axis, &plan, Some(Simulator::RollOut(&mut roll_out)))?
            }
            Some(sumo) => {
                let mut record = |scenario: &Path, recording: &Path, end: Second| {
                    let request = recorded(scenario, recording, end);
                    (sumo.simulate)(&request, LogFolder::claim(&request.out)?).map(|_| ())
                };
                closecall_study::measure(axis, &plan, Some(Simulator::Record(&mut record)))?
            }
            None if axis.needs_sumo() && arguments.only.is_none() => {
                eprintln!("skipped: this binary was built without Python and cannot run SUMO");
                continue;
            }
            None => closecall_study::measure(axis, &plan, None)?,
        };
        rows.extend(measured);
        closecall_study::write(&out, &rows, &plan)?;
    }
    print(format_args!("{} rows in {}\n", rows.len(), out.join("study.csv").display()))?;
    let off = rows.iter().filter(|row| row.default && !row.on_pareto_front);
    for row in off {
        print(format_args!("off the Pareto front: {} {} ({})\n", row.axis.name(), row.method, row.parameter))?;
    }
    Ok(())
}

/// Runs a scenario and rolls out its worst conflict.
fn rolled_out(sumo: &mut Sumo, scenario: &Path, end: Second, count: u32) -> Result<RolledOut> {
    let request = recorded(scenario, &scenario.with_extension("fcd.xml"), end);
    (sumo.simulate)(&request, LogFolder::claim(&request.out)?)?;
    let conflicts = worst(&request.out, 1)?;
    let begin = conflicts[0].begin;
    let asked = Asked { roll_outs: count, horizon: HORIZON, seed: 1, ..Asked::default() };
    let out = scenario.with_extension("whatif");
    let mut tools = Tools { save_configuration: &mut *sumo.save_configuration, preset: None, driver: None };
    let mut whatif = WhatIf::prepare(&request.out, conflicts, asked, &out, &mut tools)?;
    let lost = roll_out(sumo, &Workers::Local(processors()), &mut whatif, &out, false)?;
    if !lost.is_empty() {
        return Err(value(format!("{} failed", counted(lost.len() as u64, "roll-out"))));
    }
    let before = [whatif.original()?, whatif.baselines()?];
    let before = before.iter().flat_map(|sweep| &sweep.tasks).map(Task::processor_time).sum();
    let tasks = whatif.roll_outs()?.tasks;
    let outcome = |task: &Task| {
        let outcome = Outcome::read(&task.beside().join(ROLL_OUT))?;
        Ok((outcome.contact.is_some(), task.processor_time()))
    };
    Ok(RolledOut { begin, before, roll_outs: tasks.iter().map(outcome).collect::<Result<_>>()? })
}

/// A run of a scenario that records every step as fcd-output.
fn recorded(scenario: &Path, recording: &Path, end: Second) -> RunRequest {
    let args = [
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
        "--collision-output",
        &recording.with_extension("collisions.xml").display().to_string(),
        "--no-warnings",
    ];
    RunRequest {
        scenario: scenario.to_owned(),
        gui: None,
        out: recording.with_extension("log"),
        threads: 2,
        quiet: true,
        outputs: OutputFiles::default(),
        options: RunOptions::default(),
        sumo_words: args.map(str::to_owned).to_vec(),
        roll_out: None,
    }
}
