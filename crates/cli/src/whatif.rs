//! `closecall whatif`: rolls conflicts of a log out, with drivers that err.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::error::Result;
use super::files::{absolute, default_folder};
use super::print::{print, value};
use super::run_progress::{RunProgress, Telling};
use super::sumo::{Sumo, no_sumo};
use super::sweep::{UNFINISHED, distribute};
use super::workers::{Workers, WorkersArgs};
use closecall::options::{DriverModel, DriverOptions, duration};
use closecall::util::units::Second;
use closecall_analysis::batch::sweep::Sweep;
use closecall_analysis::batch::whatif::{Asked, Draws, Onset, Tools, WhatIf, Whose};
use closecall_analysis::logged::{with_ids, worst};
use closecall_run::RunOptions;
use closecall_run::options::OptionsFile;
use closecall_run::output::folder::LogFolder;
use closecall_run::run::roll_out::DriverError;

/// Which conflicts, and what to ask about them.
#[derive(Args)]
pub(crate) struct WhatIfArgs {
    /// Log folder of a run of SUMO.
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// The conflicts' ids in the log.
    #[arg(value_name = "ID")]
    ids: Vec<u64>,
    /// Take the N worst conflicts instead.
    #[arg(long, value_name = "N", conflicts_with = "ids", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    worst: u16,
    /// Roll-outs of each conflict.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    rollouts: u32,
    /// The drivers' response times and brakes: attentive, distracted, crash-involved, competent, automated, or a TOML file with a
    /// table [driver] [default: the run's].
    #[arg(long, value_name = "PRESET|FILE")]
    driver: Option<String>,
    /// What the driver does wrong.
    #[arg(long, value_enum, default_value_t)]
    error: DriverError,
    /// Whose error it is.
    #[arg(long, value_enum, default_value_t)]
    whose: Whose,
    /// When the driver would have to respond.
    #[arg(long, value_enum, default_value_t)]
    from: Onset,
    /// What SUMO draws at random in a roll-out.
    #[arg(long, value_enum, default_value_t)]
    draws: Draws,
    /// Simulate each roll-out from the run's beginning instead of from a saved state. Nothing drifts, but each takes as long as
    /// the run up to there.
    #[arg(long)]
    exact: bool,
    /// How long a roll-out goes on after the conflict opened, in s.
    #[arg(long, value_name = "S", default_value_t = 8.0, value_parser = duration)]
    horizon: Second,
    /// Another number gives other roll-outs.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u32,
    #[command(flatten)]
    workers: WorkersArgs,
    /// Folder for the results [default: closecall-whatif beside the log, or else in the working directory].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long)]
    quiet: bool,
}

/// The name of the results' default folder.
const RESULTS: &str = "closecall-whatif";

/// Does the missing runs and writes what all of them show; returns the exit status, 1 if some failed.
pub fn run(arguments: &WhatIfArgs, known: &[String], sumo: Option<Sumo>) -> Result<u8> {
    let Some(mut sumo) = sumo else { return no_sumo().map(|()| 0) };
    let WhatIfArgs { log, ids, quiet, .. } = arguments;
    let out = absolute(arguments.out.as_deref().unwrap_or(&default_folder(log, RESULTS)))?;
    let conflicts = if ids.is_empty() { worst(log, usize::from(arguments.worst))? } else { with_ids(log, ids)? };
    if arguments.exact && arguments.draws == Draws::New {
        return Err(value("--exact with --draws new: with another seed from its beginning on, it is another run"));
    }
    let (preset, driver) = drivers(arguments.driver.as_deref(), known)?;
    let asked = Asked {
        roll_outs: arguments.rollouts,
        horizon: arguments.horizon,
        error: arguments.error,
        whose: arguments.whose,
        from: arguments.from,
        draws: arguments.draws,
        is_exact: arguments.exact,
        seed: arguments.seed,
    };
    let _alone = LogFolder::claim(&out)?;
    let mut tools = Tools { save_configuration: sumo.save_configuration, preset, driver };
    let mut whatif = WhatIf::prepare(log, conflicts, asked, &out, &mut tools)?;
    sumo.save_configuration = tools.save_configuration;
    let workers = arguments.workers.workers();
    let lost = roll_out(&mut sumo, &workers, &mut whatif, &out, *quiet)?;
    let mut run = |sweep: &Sweep, telling| all(&mut sumo, &workers, sweep, &out, telling, *quiet);
    run(&whatif.answered()?, Telling::Nothing)?;
    run(&whatif.filmed()?, Telling::Nothing)?;
    let answers = whatif.answers(&lost)?;
    let [table, page] = whatif.write(&answers)?;
    if !quiet {
        answers.iter().try_for_each(|answer| print(format_args!("{}\n", answer.in_words())))?;
        print(format_args!("More is in {} and {}\n", table.display(), page.display()))?;
    }
    Ok(u8::from(!lost.is_empty()))
}

/// Does the missing runs until the roll-outs have ended; returns the names of those that failed.
pub(super) fn roll_out(
    sumo: &mut Sumo,
    workers: &Workers,
    whatif: &mut WhatIf,
    out: &Path,
    quiet: bool,
) -> Result<Vec<String>> {
    all(sumo, workers, &whatif.original()?, out, Telling::Nothing, quiet)?;
    all(sumo, workers, &whatif.baselines()?, out, Telling::Nothing, quiet)?;
    all(sumo, workers, &whatif.roll_outs()?, out, Telling::Cost, quiet)
}

/// Does the missing runs of a phase; returns the names of those that failed.
fn all(
    sumo: &mut Sumo,
    workers: &Workers,
    sweep: &Sweep,
    out: &Path,
    telling: Telling,
    quiet: bool,
) -> Result<Vec<String>> {
    let missing = sweep.missing()?;
    let telling = if quiet || missing.is_empty() { Telling::Nothing } else { telling };
    let done = sweep.tasks.len() - missing.len();
    let progress = RunProgress::new(&missing, done, workers.at_once(), None, telling);
    if distribute(sumo, workers, &missing, progress, &out.join(UNFINISHED))? == 0 {
        return Ok(Vec::new());
    }
    Ok(sweep.missing()?.into_iter().map(|task| task.name.clone()).collect())
}

/// The preset of the drivers, and values that change it.
fn drivers(asked: Option<&str>, known: &[String]) -> Result<(Option<&'static str>, Option<DriverOptions>)> {
    let Some(asked) = asked else { return Ok((None, None)) };
    if let Ok(preset) = DriverModel::from_str(asked, false) {
        return Ok((Some(preset.name()), None));
    }
    let path = Path::new(asked);
    if !path.exists() {
        let presets = DriverModel::value_variants().iter().map(|preset| preset.name()).collect::<Vec<_>>().join(", ");
        return Err(value(format!("--driver {asked}: neither a file nor one of {presets}")));
    }
    let file = OptionsFile::read(path, known, RunOptions::check_setting)?;
    let preset = file.args.iter().find_map(|word| word.strip_prefix("--driver="));
    let preset = preset.and_then(|name| DriverModel::from_str(name, false).ok());
    Ok((preset.map(DriverModel::name), Some(file.driver)))
}
