//! `closecall regress`: runs scenarios and reports what changed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use super::error::Result;
use super::files::absolute;
use super::print::{print, value};
use super::progress::CountBar;
use super::sumo::{Sumo, no_sumo};
use closecall::util::threads::processors;
use closecall_analysis::batch::regress::{Level, Report, Runner, Scenario, junit, regress, scenario, summary};
use closecall_analysis::batch::sweep::Seeds;
use closecall_run::util::output_file::same_file;

/// Which scenarios to run, and how to compare them.
#[derive(Args)]
pub(crate) struct RegressArgs {
    /// Scenario folders, or folders that contain scenario folders.
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// Approve the results of this run as the baseline.
    #[arg(long)]
    bless: bool,
    /// Write the results as JUnit XML as well.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Runs at the same time [default: one per processor].
    #[arg(long, alias = "jobs", value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    workers: Option<u16>,
    /// Run only the scenario of this name; may be repeated.
    #[arg(long, value_name = "NAME", action = clap::ArgAction::Append)]
    only: Vec<String>,
    /// Random seeds for SUMO instead of the scenarios' own, such as 1-10 or 1,2,5-9; the comparison is then statistical.
    #[arg(long, value_name = "SEEDS")]
    seeds: Option<Seeds>,
    /// Folder in which to keep the logs of all runs.
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Show all differences, not only the first ten of each sort.
    #[arg(long)]
    all: bool,
}

/// Runs the scenarios and prints their reports; returns the exit status. A scenario's settings may name the `known` long
/// options.
pub fn run(arguments: RegressArgs, known: &[String], sumo: Option<Sumo>) -> Result<u8> {
    let Some(sumo) = sumo else { return no_sumo().map(|()| 0) };
    let mut folders = Vec::new();
    for path in &arguments.folders {
        folders.extend(scenario::folders(path)?);
    }
    let name = |folder: &Path| {
        let full = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        full.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
    };
    let is_wanted = |folder: &PathBuf| arguments.only.is_empty() || arguments.only.contains(&name(folder));
    if let Some(missing) = arguments.only.iter().find(|only| folders.iter().all(|folder| name(folder) != **only)) {
        return Err(value(format!("--only {missing}: no such scenario")));
    }
    folders.retain(is_wanted);
    let mut scenarios = Vec::new();
    let mut reports = BTreeMap::new();
    let mut places = Vec::new();
    let seeds = arguments.seeds.as_ref().map_or(&[][..], |seeds| &seeds.0);
    for (place, folder) in folders.iter().enumerate() {
        match Scenario::read(folder, known).and_then(|scenario| scenario.with_seeds(seeds)) {
            Ok(scenario) => {
                scenario.remarks.iter().for_each(|remark| eprintln!("closecall: {remark}"));
                scenarios.push(scenario);
                places.push(place);
            }
            Err(error) => drop(reports.insert(place, Report::unreadable(name(folder), Level::Exact, error))),
        }
    }
    if let Some(path) = &arguments.junit {
        let read = scenarios.iter().flat_map(Scenario::files).collect::<Vec<_>>();
        if let Some(over) = same_file(path, read.iter().map(|file| &**file)) {
            return Err(value(format!("--junit would be written over {}", over.display())));
        }
    }
    let mut bar = CountBar::new("runs", true);
    let mut progress = |done, all| bar.show(done, all);
    let mut runner = Runner {
        closecall: sumo.closecall,
        workers: arguments.workers.map_or_else(processors, usize::from),
        out: arguments.out.as_deref().map(absolute).transpose()?,
        interrupted: sumo.interrupted,
        progress: &mut progress,
    };
    let done = regress(&scenarios, &mut runner, arguments.bless)?;
    drop(bar);
    reports.extend(places.into_iter().zip(done));
    let mut reports = reports.into_values().collect::<Vec<_>>();
    for report in &mut reports {
        report.shows_all = arguments.all;
        print(format_args!("{report}"))?;
    }
    print(format_args!("{}\n", summary(&reports)))?;
    if let Some(path) = &arguments.junit {
        junit::write(path, &reports)?;
    }
    Ok(reports.iter().map(Report::exit_status).max().unwrap_or_default())
}
