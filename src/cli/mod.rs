//! The command line: parse, call the library, print.
//!
//! `closecall run` needs Python, which this crate does not know: whoever calls [`main`] passes in how to run a
//! simulation ([`Sumo`]), or nothing.

mod mu;
mod plot;
mod regress;
mod replay;
mod report;
mod run;
mod settings;
mod stats;
#[cfg(feature = "study")]
mod stress;
#[cfg(feature = "study")]
mod study;
mod sweep;

use std::ffi::OsString;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::options::Options;
use crate::regress::Scenario;
use crate::{Error, Result};

pub use run::{RunRequest, Simulate};
pub use sweep::{Distribute, Ended, Workers};

#[derive(Parser)]
#[command(name = "closecall", version, about, args_override_self = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a SUMO scenario with the checker attached
    #[command(args_override_self = true)]
    Run(Box<run::RunArgs>),
    /// Run a scenario with many seeds and options, in parallel, into one data set
    Sweep(Box<sweep::SweepArgs>),
    /// Check a recording: SUMO's fcd-output, in XML or CSV, also gzipped
    #[command(args_override_self = true)]
    Replay(Box<replay::ReplayArgs>),
    /// Run scenarios and compare the conflicts with those blessed
    Regress(regress::RegressArgs),
    /// Print the minimal collision distance μ of two road users, by all three models
    #[command(args_override_self = true)]
    Mu(mu::MuArgs),
    /// Check stiff and extreme cases against exact references
    #[cfg(feature = "study")]
    Stress(stress::StressArgs),
    /// Measure error against run time, for every choice that closecall makes
    #[cfg(feature = "study")]
    Study(study::StudyArgs),
    /// Statistics of logs: rates, quantiles, the worst conflicts, before and after
    Stats(stats::StatsArgs),
    /// Make one HTML page of logs: map, time line, distributions, hot spots, the worst conflicts
    #[command(args_override_self = true)]
    Report(report::ReportArgs),
    /// Draw the same charts as PNG or SVG, for papers
    #[command(args_override_self = true)]
    Plot(plot::PlotArgs),
}

/// What the commands that run SUMO need of whoever knows it.
pub struct Sumo<'a> {
    /// Runs a simulation in this process.
    pub simulate: &'a mut Simulate<'a>,
    /// Has the runs of a sweep done.
    pub distribute: &'a mut Distribute<'a>,
    /// The command line that starts closecall in a process of its own, without arguments; it ends when its standard input
    /// does.
    pub closecall: Vec<OsString>,
    /// Whether the user has asked to stop; who never asked is ended at once.
    pub interrupted: &'a mut dyn FnMut() -> bool,
}

/// Runs the command that `words` (the program's name first) say; returns the exit status.
///
/// Messages go to standard error, one clear line each, results to standard output.
pub fn main(words: impl IntoIterator<Item = OsString>, sumo: Option<Sumo>) -> u8 {
    let words = words.into_iter().collect::<Vec<_>>();
    let cli = match parse(words) {
        Ok(cli) => cli,
        Err(Stop::Clap(error)) => {
            if error.use_stderr() {
                return failed(&usage(&error));
            }
            // Nothing can be done where even this cannot be printed.
            let _ = error.print();
            return 0;
        }
        Err(Stop::Error(error)) => return failed(&error),
    };
    let done = match cli.command {
        Command::Run(arguments) => run::run(*arguments, sumo).map(|()| 0),
        Command::Sweep(arguments) => sweep::run(*arguments, sumo),
        Command::Replay(arguments) => replay::run(*arguments, sumo).map(|()| 0),
        Command::Regress(arguments) => regress::run(arguments, &settings::known(&command()), sumo),
        Command::Mu(arguments) => mu::run(&arguments).map(|()| 0),
        #[cfg(feature = "study")]
        Command::Stress(arguments) => stress::run(&arguments).map(|()| 0),
        #[cfg(feature = "study")]
        Command::Study(arguments) => study::run(&arguments, sumo).map(|()| 0),
        Command::Stats(arguments) => stats::run(arguments).map(|()| 0),
        Command::Report(arguments) => report::run(&arguments).map(|()| 0),
        Command::Plot(arguments) => plot::run(&arguments).map(|()| 0),
    };
    match done {
        Ok(status) => status,
        Err(error) => failed(&error),
    }
}

/// The files of a run's own that none besides its log may be written over; SUMO's are known once it has started.
fn kept(config: Option<PathBuf>, options: &Options, out: &Path) -> Vec<PathBuf> {
    config.into_iter().chain(options.filter.clone()).chain(crate::log::files(out)).collect()
}

/// The scenario at a path: a folder, or a SUMO configuration with the settings beside it.
///
/// # Errors
/// Those of [`Scenario::read`].
pub fn scenario(path: &Path) -> Result<Scenario> {
    Scenario::at(path, &settings::known(&command()))
}

/// Prints results. A reader that has seen enough is no error.
fn say(text: impl Display) -> Result<()> {
    let mut output = std::io::stdout();
    match write!(output, "{text}").and_then(|()| output.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(value(format!("standard output: {error}"))),
        _ => Ok(()),
    }
}

fn failed(error: &Error) -> u8 {
    eprintln!("closecall: {error}");
    error.exit_status()
}

/// Why a command line does not lead to a command.
enum Stop {
    /// clap's own: help, version, a usage error.
    Clap(clap::Error),
    /// The TOML file's.
    Error(Error),
}

impl From<clap::Error> for Stop {
    fn from(error: clap::Error) -> Self {
        Self::Clap(error)
    }
}

/// clap's command; a negative number is a value, which the option's own check may refuse.
fn command() -> clap::Command {
    Cli::command().mut_subcommands(|command| {
        command.mut_args(|argument| {
            let takes_value = argument.get_action().takes_values() && !argument.is_positional();
            if takes_value { argument.allow_negative_numbers(true) } else { argument }
        })
    })
}

/// Parses the words; those of a TOML file that they name stand before them, so that what was typed wins.
fn parse(words: Vec<OsString>) -> std::result::Result<Cli, Stop> {
    let matches = command().try_get_matches_from(&words)?;
    let Some((name, arguments)) = matches.subcommand() else { return Ok(Cli::from_arg_matches(&matches)?) };
    let known = settings::long_options(&command(), name);
    let file = match arguments.try_get_one::<std::path::PathBuf>("config") {
        Ok(Some(path)) => settings::read(&command(), path).map_err(Stop::Error)?,
        _ => return Ok(Cli::from_arg_matches(&matches)?),
    };
    let place = words.iter().position(|word| word == name).map_or(words.len(), |place| place + 1);
    let here = |word: &&String| known.iter().any(|option| option == settings::option_of(word));
    let (before, after) = words.split_at(place);
    let all = before.iter().cloned().chain(file.words.iter().filter(here).map(OsString::from)).chain(after.to_vec());
    let mut cli = Cli::from_arg_matches(&command().try_get_matches_from(all)?)?;
    match &mut cli.command {
        Command::Run(arguments) => arguments.options.types = file.types,
        Command::Replay(arguments) => arguments.options.types = file.types,
        _ => {}
    }
    Ok(cli)
}

/// clap's message in one line, without the usage.
fn usage(error: &clap::Error) -> Error {
    let text = error.to_string();
    let said = text.split("\n\n").filter(|part| !part.starts_with("Usage") && !part.starts_with("For more"));
    let line = said.flat_map(str::split_whitespace).collect::<Vec<_>>().join(" ").replace(" tip: ", "; tip: ");
    value(line.trim_start_matches("error: "))
}

/// One line for a value that is out of its range.
fn value(message: impl Into<String>) -> Error {
    Error::Value(message.into())
}

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Runs in processes of their own have working directories of their own.
fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|source| Error::file(path, source))
}

/// What the command returns where SUMO is not at hand.
fn no_sumo() -> Result<()> {
    Err(value("this binary was built without Python and cannot run SUMO; `pip install closecall` gives one that can"))
}
