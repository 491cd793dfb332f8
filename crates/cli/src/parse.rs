//! The command line as clap reads it, with the options of a TOML file.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};

use super::error::{Error, Result};
use super::print::value;
use super::{example, export, extract, inspect, mu, playback, regress, replay, report, run, settings, stats};
use closecall_run::options::{OptionsFile, old_names};

use super::plot;
use super::sweep;
use super::{rare, stress, study, whatif};

#[derive(Parser)]
#[command(name = "closecall", version, about, args_override_self = true)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Run a SUMO scenario and check every step for conflicts
    #[command(args_override_self = true)]
    Run(Box<run::RunArgs>),
    /// Run a scenario with many seeds and options in parallel and collect the conflicts in one data set
    Sweep(Box<sweep::SweepArgs>),
    /// Check a recording for conflicts: SUMO's fcd-output, SSAM's .trj, Vissim's .fzp, tables of trajectories
    #[command(args_override_self = true)]
    Replay(Box<replay::ReplayArgs>),
    /// Identify a recording, list missing data, and print the command that replays it
    Inspect(inspect::InspectArgs),
    /// Write a scenario that comes with closecall, to try it on
    Example(example::ExampleArgs),
    /// Run scenarios and compare their conflicts with the approved baseline
    Regress(regress::RegressArgs),
    /// Print the minimal collision distance μ of two road users under each model
    #[command(args_override_self = true)]
    Mu(mu::MuArgs),
    /// Check stiff and extreme cases against exact references
    Stress(stress::StressArgs),
    /// Measure error against run time: which step length a scenario needs, or every choice that closecall makes
    Study(Box<study::StudyArgs>),
    /// Print statistics of logs: rates, quantiles, the worst conflicts, before and after
    Stats(stats::StatsArgs),
    /// Make an HTML page from logs: map, time line, distributions, hot spots, the worst conflicts
    #[command(args_override_self = true)]
    Report(report::ReportArgs),
    /// Draw the seconds around a conflict as an animated SVG
    #[command(args_override_self = true)]
    Clip(playback::ClipArgs),
    /// Show the seconds around a conflict in sumo-gui
    #[command(args_override_self = true)]
    Show(playback::ShowArgs),
    /// Extract a conflict as a standalone scenario and a test
    #[command(args_override_self = true)]
    Extract(extract::ExtractArgs),
    /// Roll conflicts out again with drivers that err: would they have crashed?
    #[command(name = "whatif", args_override_self = true)]
    WhatIf(whatif::WhatIfArgs),
    /// Estimate a crash rate too rare to wait for, with drivers that now and then respond late
    Rare(Box<rare::RareArgs>),
    /// Write a log in the format of another tool: GeoJSON, GeoParquet, GeoPackage, sumo-gui, device.ssm
    #[command(args_override_self = true)]
    Export(export::ExportArgs),
    /// Draw the charts of the report as PNG or SVG files
    #[command(args_override_self = true)]
    Plot(plot::PlotArgs),
}

/// Why a command line does not lead to a command.
pub(super) enum ParseError {
    /// clap's help, version or usage error.
    Clap(clap::Error),
    /// The TOML file cannot be used.
    File(Error),
}

impl From<clap::Error> for ParseError {
    fn from(error: clap::Error) -> Self {
        Self::Clap(error)
    }
}

/// The clap command. A negative number counts as a value, so that the option's own check can refuse it.
pub(super) fn command() -> clap::Command {
    Cli::command().mut_subcommands(|command| {
        command.mut_args(|argument| {
            let takes_value = argument.get_action().takes_values() && !argument.is_positional();
            if takes_value { argument.allow_negative_numbers(true) } else { argument }
        })
    })
}

/// Parses the words; also returns what to tell the user of old names among them, unless only errors are wanted. The options of a
/// TOML file come before the words, so that what was typed wins.
pub(super) fn parse(args: Vec<OsString>) -> std::result::Result<(Cli, BTreeSet<String>), ParseError> {
    let all = command();
    let matches = all.clone().try_get_matches_from(&args)?;
    let Some((name, arguments)) = matches.subcommand() else {
        return Ok((Cli::from_arg_matches(&matches)?, BTreeSet::new()));
    };
    let file = match arguments.try_get_one::<PathBuf>("config") {
        Ok(Some(path)) => settings::read(&all, path).map_err(|error| ParseError::File(error.into()))?,
        _ => OptionsFile::default(),
    };
    let known = settings::long_options(&all, name);
    let is_known = |word: &&String| known.iter().any(|option| option == settings::option_of(word));
    let place = args.iter().position(|word| word == name).map_or(args.len(), |place| place + 1);
    let (before, after) = args.split_at(place);
    let of_file = file.args.iter().filter(is_known).map(OsString::from);
    let words = before.iter().cloned().chain(of_file).chain(after.iter().cloned());
    let matches = all.clone().try_get_matches_from(words)?;
    let is_quiet = |of: &ArgMatches| matches!(of.try_get_one("quiet"), Ok(Some(true)));
    let remarks = match matches.subcommand() {
        Some((_, arguments)) if is_quiet(arguments) => BTreeSet::new(),
        _ => all
            .find_subcommand(name)
            .into_iter()
            .flat_map(|own| old_names_in(own, after))
            .chain(file.remarks.clone())
            .collect(),
    };
    let mut cli = Cli::from_arg_matches(&matches)?;
    match &mut cli.command {
        Command::Run(arguments) => arguments.check.options.set_tables(file),
        Command::Replay(arguments) => arguments.check.options.set_tables(file),
        _ => {}
    }
    Ok((cli, remarks))
}

/// What to tell the user of old names among the words of a command. No value begins with two dashes, but for those after `--`.
fn old_names_in(command: &clap::Command, words: &[OsString]) -> impl Iterator<Item = String> {
    let options = words.iter().filter_map(|word| word.to_str()).take_while(|word| *word != "--");
    options.filter(|word| word.starts_with("--")).filter_map(|word| old_names::remark(command, word))
}

/// clap's message as one line, without the usage.
fn in_one_line(error: &clap::Error) -> Error {
    let text = error.to_string();
    let parts = text.split("\n\n").filter(|part| !part.starts_with("Usage") && !part.starts_with("For more"));
    let line = parts.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ").replace(" tip: ", "; tip: ");
    value(line.trim_start_matches("error: "))
}

/// Parses a command line of `closecall run`, which begins with the program's name.
///
/// # Errors
/// clap's error as one line, and the errors of the TOML file.
pub(super) fn parse_run(args: Vec<OsString>) -> Result<run::RunArgs> {
    match parse(args) {
        Ok((Cli { command: Command::Run(arguments) }, _)) => Ok(*arguments),
        Ok(_) => Err(value("these are not the words of closecall run")),
        Err(ParseError::Clap(error)) => Err(in_one_line(&error)),
        Err(ParseError::File(error)) => Err(error),
    }
}
