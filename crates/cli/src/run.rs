//! `closecall run`: checks the arguments and hands them to the bridge, which runs SUMO.

use std::path::PathBuf;

use clap::Args;

use super::check_args::CheckArgs;
use super::error::Result;
use super::sumo::{GuiRequest, RunRequest, Sumo, no_sumo};
use closecall::detection::kind::Severity;
use closecall::options::{step_length, time};
use closecall::util::threads::default_threads;
use closecall::util::units::Second;
use closecall_run::Error;
use closecall_run::input::{scenario_kind, sumo_files};
use closecall_run::run::roll_out::RollOut;
use closecall_run::util::input_file;

/// A SUMO scenario and how to run it.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct RunArgs {
    /// SUMO configuration file.
    #[arg(value_name = "SCENARIO", required_unless_present = "configuration_file", help_heading = None::<&str>)]
    scenario: Option<PathBuf>,
    /// Show the run in sumo-gui and paint the conflicts.
    #[arg(long)]
    gui: bool,
    /// Simulated time at which the run begins, in s.
    #[arg(short = 'b', long, value_name = "S", value_parser = time)]
    begin: Option<Second>,
    /// Simulated time at which the run ends, in s.
    #[arg(short = 'e', long, value_name = "S", value_parser = time)]
    end: Option<Second>,
    /// Random seed for SUMO.
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// Length of a simulation step, in s.
    #[arg(long, value_name = "S", value_parser = step_length)]
    step_length: Option<Second>,
    /// Maximum number of threads, SUMO's own included [default: one per processor]. With 2, closecall works while SUMO computes
    /// its next step; more help with thousands of road users. Use 1 when running many simulations at once.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=64))]
    threads: Option<u8>,
    /// With `--gui`, write the kind and the time left beside each conflict.
    #[arg(long, requires = "gui")]
    label: bool,
    /// With `--gui`, halt at each conflict that becomes this severe, in its view, until you press Enter.
    #[arg(long, value_enum, value_name = "SEVERITY", requires = "gui")]
    pause_at: Option<Severity>,
    /// With `--gui`, close sumo-gui when the run ends.
    #[arg(long, requires = "gui")]
    quit_on_end: bool,
    /// SUMO configuration file, under SUMO's own option name.
    #[arg(short = 'c', long, value_name = "FILE", conflicts_with = "scenario")]
    configuration_file: Option<PathBuf>,
    /// What drivers do wrong, as JSON: the runs of `closecall whatif` have it.
    #[arg(long, value_name = "JSON", value_parser = RollOut::parse, hide = true, conflicts_with = "gui")]
    roll_out: Option<RollOut>,
    #[command(flatten)]
    pub(super) check: CheckArgs,
    /// Options passed on to SUMO.
    #[arg(last = true, value_name = "SUMO OPTIONS", help_heading = None::<&str>)]
    sumo_options: Vec<String>,
}

/// Runs the scenario and prints its summary.
pub fn run(arguments: RunArgs, sumo: Option<Sumo>) -> Result<()> {
    let Some(sumo) = sumo else { return no_sumo() };
    let mut request = request(&arguments)?;
    let folder = arguments.check.claim(&request.out)?;
    folder.path().clone_into(&mut request.out);
    let summary = (sumo.simulate)(&request, folder)?;
    arguments.check.finish(&summary, &request.scenario, &request.out)
}

/// The request for the bridge, with everything checked that can be before SUMO starts.
pub(super) fn request(arguments: &RunArgs) -> Result<RunRequest> {
    let scenario = arguments.configuration_file.as_ref().or(arguments.scenario.as_ref()).cloned().unwrap_or_default();
    // Opened here so that an error carries the operating system's own message, and SUMO never waits for a pipe.
    input_file::file(&scenario)?;
    if scenario.is_dir() {
        return Err(Error::content(&scenario, "it is a folder, not a SUMO configuration").into());
    }
    scenario_kind::check_is_scenario(&scenario)?;
    sumo_files::check_are_files(&scenario)?;
    let out = arguments.check.log_folder(&scenario);
    let options = arguments.check.checked(&out)?;
    options.model.check_future_is_unknown()?;
    let mut sumo_words = vec!["-c".to_owned(), scenario.display().to_string()];
    let times = [("--begin", arguments.begin), ("--end", arguments.end), ("--step-length", arguments.step_length)];
    for (option, time) in times {
        if let Some(time) = time {
            sumo_words.extend([option.to_owned(), time.to_string()]);
        }
    }
    if let Some(seed) = arguments.seed {
        sumo_words.extend(["--seed".to_owned(), seed.to_string()]);
    }
    sumo_words.extend_from_slice(&arguments.sumo_options);
    Ok(RunRequest {
        scenario,
        gui: arguments.gui.then_some(GuiRequest {
            label: arguments.label,
            quit_on_end: arguments.quit_on_end,
            pause_at: arguments.pause_at,
        }),
        out,
        threads: arguments.threads.unwrap_or_else(default_threads),
        quiet: arguments.check.quiet,
        outputs: arguments.check.outputs.clone(),
        options,
        sumo_words,
        roll_out: arguments.roll_out.clone(),
    })
}
