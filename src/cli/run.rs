//! `closecall run`: what is asked for, handed to whoever can run SUMO.

use std::path::{Path, PathBuf};

use clap::Args;

use super::files::kept;
use super::say::say;
use super::sumo::{RunRequest, Sumo, no_sumo};
use crate::options::{Options, not_negative, positive};
use crate::output::formats::OutputFiles;
use crate::util::units::Second;
use crate::{Error, Result};

/// A SUMO scenario and how to run it.
#[derive(Args)]
pub struct RunArgs {
    /// SUMO configuration file.
    #[arg(value_name = "CONFIG", required_unless_present = "configuration_file")]
    scenario: Option<PathBuf>,
    /// The same, as SUMO spells it.
    #[arg(short = 'c', long, value_name = "FILE", conflicts_with = "scenario")]
    configuration_file: Option<PathBuf>,
    /// Show the run in sumo-gui, conflicts painted.
    #[arg(long)]
    gui: bool,
    /// Folder of the log [default: closecall-out beside the scenario].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// First simulated second.
    #[arg(short = 'b', long, value_name = "S", value_parser = not_negative)]
    begin: Option<Second>,
    /// Simulated second at which the run ends.
    #[arg(short = 'e', long, value_name = "S", value_parser = not_negative)]
    end: Option<Second>,
    /// SUMO's random seed.
    #[arg(long, value_name = "N")]
    seed: Option<u32>,
    /// Length of a step in s.
    #[arg(long, value_name = "S", value_parser = positive)]
    step_length: Option<Second>,
    /// TOML file of options.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// 2: accurate tests, events and log beside SUMO's next step, more: with all but SUMO's own; 1: after it, for many
    /// runs at once.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=64))]
    threads: u8,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    outputs: OutputFiles,
    #[command(flatten)]
    pub(super) options: Options,
    /// Options for SUMO itself.
    #[arg(last = true, value_name = "SUMO OPTIONS")]
    sumo_options: Vec<String>,
}

/// Runs the scenario and prints its summary.
pub fn run(arguments: RunArgs, sumo: Option<Sumo>) -> Result<()> {
    let Some(sumo) = sumo else { return no_sumo() };
    let request = request(arguments)?;
    let summary = (sumo.simulate)(&request)?;
    if !request.quiet {
        say(format_args!("{summary}"))?;
        say(format_args!("log in {}\n", request.out.display()))?;
    }
    Ok(())
}

/// What is asked for, checked as far as that can be done before SUMO starts.
pub(super) fn request(arguments: RunArgs) -> Result<RunRequest> {
    let scenario = arguments.configuration_file.or(arguments.scenario).unwrap_or_default();
    // Opened here for the operating system's own words on why it cannot be.
    std::fs::File::open(&scenario).map_err(|source| Error::file(&scenario, source))?;
    if scenario.is_dir() {
        return Err(Error::content(&scenario, "it is a folder, not a SUMO configuration"));
    }
    let beside = scenario.parent().unwrap_or(Path::new("")).join("closecall-out");
    let out = arguments.out.unwrap_or(beside);
    let options = arguments.options.checked()?;
    arguments.outputs.check(&kept(arguments.config, &options, &out))?;
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
    sumo_words.extend(arguments.sumo_options);
    Ok(RunRequest {
        scenario,
        gui: arguments.gui,
        out,
        threads: arguments.threads,
        quiet: arguments.quiet,
        outputs: arguments.outputs,
        options,
        sumo_words,
    })
}
