//! The command line: parse, call the library, print.
//!
//! `closecall run` needs Python, which this crate does not know. The caller of [`main`] may pass in how to run a simulation
//! ([`Sumo`]).

mod check_args;
mod ending;
mod error;
mod example;
mod exit_status;
mod export;
mod extract;
mod files;
mod inspect;
mod mu;
mod parse;
mod playback;
mod plot;
mod print;
pub mod progress;
mod rare;
mod regress;
mod replay;
mod replay_each;
mod report;
mod run;
mod run_progress;
mod selector;
mod settings;
mod stats;
mod stress;
mod study;
mod study_scenario;
mod sumo;
mod sweep;
mod whatif;
mod workers;

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;

use closecall_analysis::batch::regress::Scenario;
use closecall_run::util::panics::caught;
use error::Result;
use parse::{Command, ParseError, command, parse};

pub use closecall_run::util::panics::keep_quiet as keep_panics_quiet;
pub use error::Error;
pub use sumo::{ConvertNet, FilmRequest, GuiRequest, RunRequest, SaveConfiguration, ShowRequest, Simulate, Sumo};
pub use workers::{Distribute, ReportEnd, Workers};

/// Runs the command line `args`, which begins with the program's name; returns the exit status.
///
/// Results go to standard output, messages to standard error, one line each; the usage follows that of a wrong word.
pub fn main(args: impl IntoIterator<Item = OsString>, sumo: Option<Sumo>) -> u8 {
    let args = args.into_iter().collect::<Vec<_>>();
    let (cli, remarks) = match parse(args) {
        Ok(parsed) => parsed,
        Err(ParseError::Clap(error)) => return refused(&error),
        Err(ParseError::File(error)) => return failed(&error),
    };
    remarks.iter().for_each(|remark| eprintln!("closecall: {remark}"));
    let done = caught(|| match cli.command {
        Command::Run(arguments) => run::run(*arguments, sumo).map(|()| 0),
        Command::Sweep(arguments) => sweep::run(*arguments, sumo, &parse::parse_run),
        Command::Replay(arguments) if arguments.each => replay_each::run(&arguments, sumo),
        Command::Replay(arguments) => replay::run(*arguments, sumo).map(|()| 0),
        Command::Regress(arguments) => regress::run(arguments, &settings::known(&command()), sumo),
        Command::Mu(arguments) => mu::run(&arguments).map(|()| 0),
        Command::Stress(arguments) => stress::run(&arguments).map(|()| 0),
        Command::Study(arguments) => study::run(*arguments, sumo, &parse::parse_run),
        Command::Stats(arguments) => stats::run(arguments).map(|()| 0),
        Command::Clip(arguments) => playback::clip(&arguments, sumo).map(|()| 0),
        Command::Show(arguments) => playback::show(&arguments, sumo).map(|()| 0),
        Command::Inspect(arguments) => inspect::run(&arguments).map(|()| 0),
        Command::Example(arguments) => example::run(&arguments).map(|()| 0),
        Command::Extract(arguments) => extract::run(&arguments, &settings::known(&command()), sumo).map(|()| 0),
        Command::WhatIf(arguments) => whatif::run(&arguments, &settings::known(&command()), sumo),
        Command::Rare(arguments) => rare::run(*arguments, sumo, &parse::parse_run),
        Command::Export(arguments) => export::run(arguments).map(|()| 0),
        Command::Report(arguments) => report::run(&arguments).map(|()| 0),
        Command::Plot(arguments) => plot::run(&arguments).map(|()| 0),
    });
    match done.map_err(Error::from).flatten() {
        Ok(status) => status,
        Err(error) => failed(&error),
    }
}

/// The scenario at a path: a folder, or a SUMO configuration with the settings beside it.
///
/// # Errors
/// Those of `Scenario::read`.
pub fn scenario(path: &Path) -> Result<Scenario> {
    Ok(Scenario::at(path, &settings::known(&command()))?)
}

/// Prints clap's help, version, or message with the usage below it.
fn refused(error: &clap::Error) -> u8 {
    let text = error.to_string();
    // If even this cannot be printed, there is nothing else to do.
    let _ = match text.strip_prefix("error: ") {
        Some(message) => write!(std::io::stderr(), "closecall: {message}"),
        None => error.print(),
    };
    // clap's own status: 0 for help and version that were asked for, 2 otherwise.
    u8::try_from(error.exit_code()).unwrap_or(2)
}

fn failed(error: &Error) -> u8 {
    eprintln!("closecall: {error}");
    error.exit_status()
}
