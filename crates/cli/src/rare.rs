//! `closecall rare`: the crash rate of a scenario in which drivers now and then respond late.

use std::path::{Path, PathBuf};

use clap::Args;

use super::error::Result;
use super::files::{absolute, default_folder};
use super::print::print;
use super::run_progress::{RunProgress, Telling};
use super::sumo::{Sumo, no_sumo};
use super::sweep::{ParseRun, Passed, UNFINISHED, check_runs, distribute};
use super::workers::{Workers, WorkersArgs};
use closecall::options::{duration, share};
use closecall::util::units::Second;
use closecall_analysis::batch::rare::{Repetition, estimate};
use closecall_analysis::batch::sweep::{Seeds, Sweep, Task};
use closecall_analysis::batch::whatif::{Asked, Tools};
use closecall_analysis::rows_csv;
use closecall_run::output::folder::LogFolder;
use closecall_run::util::input_file;

/// A scenario, and how much to simulate of it.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct RareArgs {
    /// SUMO configuration file.
    #[arg(value_name = "SCENARIO", help_heading = None::<&str>)]
    scenario: PathBuf,
    /// The share of conflicts in which a driver responds late.
    #[arg(long, value_name = "SHARE", default_value_t = 0.001, value_parser = share)]
    share: f64,
    /// Random seeds for SUMO, an independent repetition each.
    #[arg(long, value_name = "SEEDS", default_value = "1-20")]
    seeds: Seeds,
    /// Conflicts of each repetition that are rolled out.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    conflicts: u16,
    /// Roll-outs of each of them.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    rollouts: u32,
    /// How long a roll-out goes on after the conflict opened, in s.
    #[arg(long, value_name = "S", default_value_t = 8.0, value_parser = duration)]
    horizon: Second,
    #[command(flatten)]
    workers: WorkersArgs,
    #[command(flatten)]
    passed: Passed,
    /// Folder for the results [default: closecall-rare next to the scenario, or else in the working directory].
    #[arg(short, long, value_name = "DIR", help_heading = "Output", display_order = 0)]
    out: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long, help_heading = "Output", display_order = 0)]
    quiet: bool,
}

/// The name of the results' default folder, and of the table there.
const RESULTS: &str = "closecall-rare";
const TABLE: &str = "rare.csv";

/// Does the missing runs and writes the rate; returns the exit status, 1 if some failed.
pub fn run(arguments: RareArgs, sumo: Option<Sumo>, parse_run: &ParseRun) -> Result<u8> {
    let Some(mut sumo) = sumo else { return no_sumo().map(|()| 0) };
    let RareArgs { scenario, seeds, passed, quiet, .. } = &arguments;
    let out = absolute(arguments.out.as_deref().unwrap_or(&default_folder(scenario, RESULTS)))?;
    // Opened here so that an error carries the operating system's own message.
    input_file::file(scenario)?;
    let (args, files) = passed.shared(scenario, &[])?;
    let base = Sweep::plan(&args, &passed.for_sumo, seeds, &[], &out.join("base"), &files)?;
    check_runs(&base, seeds, parse_run)?;
    let _alone = LogFolder::claim(&out)?;
    let workers = arguments.workers.workers();
    let mut failed = all(&mut sumo, &workers, base.missing()?, &out, *quiet)?;
    let mut repetitions = Vec::new();
    for task in base.tasks.iter().filter(|task| task.file().exists()) {
        let asked = Asked { roll_outs: arguments.rollouts, horizon: arguments.horizon, seed: 1, ..Asked::default() };
        let mut tools = Tools { save_configuration: sumo.save_configuration, preset: None, driver: None };
        let count = usize::from(arguments.conflicts);
        repetitions.push(Repetition::prepare(task, count, asked, &out.join(&task.name), &mut tools)?);
        sumo.save_configuration = tools.save_configuration;
    }
    let mut cpu = 0.0;
    let phases: [fn(&mut Repetition) -> closecall_analysis::Result<Sweep>; 3] =
        [|one| one.whatif.original(), |one| one.whatif.baselines(), |one| one.whatif.roll_outs()];
    for phase in phases {
        let sweeps = repetitions.iter_mut().map(phase).collect::<closecall_analysis::Result<Vec<_>>>()?;
        let mut missing = Vec::new();
        for sweep in &sweeps {
            missing.extend(sweep.missing()?);
        }
        failed += all(&mut sumo, &workers, missing, &out, *quiet)?;
        cpu += sweeps.iter().flat_map(|sweep| &sweep.tasks).map(Task::processor_time).sum::<f64>();
    }
    let rate = estimate(&repetitions, arguments.share, cpu)?;
    let table = out.join(TABLE);
    rows_csv::write(&table, std::slice::from_ref(&rate))?;
    if !quiet {
        print(format_args!("{}\nMore is in {}\n", rate.in_words(), table.display()))?;
    }
    Ok(u8::from(failed > 0))
}

/// Does the missing runs of a phase; returns how many failed.
fn all(sumo: &mut Sumo, workers: &Workers, missing: Vec<&Task>, out: &Path, quiet: bool) -> Result<usize> {
    let telling = if quiet || missing.is_empty() { Telling::Nothing } else { Telling::Progress };
    let progress = RunProgress::new(&missing, 0, workers.at_once(), None, telling);
    distribute(sumo, workers, &missing, progress, &out.join(UNFINISHED))
}
