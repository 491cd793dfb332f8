//! `closecall replay`: the same checks on a recording; no SUMO is needed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::files::kept;
use super::progress::Progress;
use super::say::say;
use super::sumo::Sumo;
use crate::input::replay::Replay;
use crate::options::Options;
use crate::output::formats::{OutputFiles, Outputs};
use crate::output::input_hash::Input;
use crate::output::log::Log;
use crate::output::record::{RunRecord, Versions};
use crate::output::summary::Summary;
use crate::run::Run;
use crate::traffic::net::Net;
use crate::{Error, Result};

/// A recording and how to check it.
#[derive(Args)]
pub struct ReplayArgs {
    /// SUMO's fcd-output: XML, CSV, or either gzipped.
    #[arg(value_name = "FCD")]
    recording: PathBuf,
    /// The net on which it was recorded.
    #[arg(short = 'n', long, value_name = "NET")]
    net: PathBuf,
    /// Route and additional files with the vehicle types; others are SUMO's own.
    #[arg(short = 'r', long, value_name = "FILE,…", value_delimiter = ',')]
    route_files: Vec<PathBuf>,
    /// The recording is of SUMO's sublane model (--lateral-resolution): road users move to the side within their lane.
    #[arg(long)]
    sublane: bool,
    /// Folder of the log [default: closecall-out beside the recording].
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// TOML file of options.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Threads that look at the pairs of a step: worth more than one where there are thousands of road users.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=64))]
    threads: u8,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    outputs: OutputFiles,
    #[command(flatten)]
    pub(super) options: Options,
}

/// Checks the recording and prints the summary.
pub fn run(arguments: ReplayArgs, sumo: Option<Sumo>) -> Result<()> {
    let options = arguments.options.clone().checked()?;
    let recording = &arguments.recording;
    let beside = recording.parent().unwrap_or(Path::new("")).join("closecall-out");
    let out = arguments.out.unwrap_or(beside);
    arguments.outputs.check(&kept(arguments.config, &options, &out))?;
    let net = Arc::new(Net::read(&arguments.net)?);
    let mut replay = Replay::open(recording, &arguments.route_files, &net, &options)?;
    let mut run = Run::new(&options, Some(net.clone()))?;
    run.set_threads(arguments.threads.into());
    run.set_fixed_routes(true);
    if arguments.sublane {
        run.set_sublane(true);
    }
    let files = [recording.clone(), arguments.net.clone()].into_iter().chain(arguments.route_files.clone());
    let mut record = RunRecord {
        versions: Versions::with_sumo(None),
        scenario: recording.clone(),
        seed: None,
        step_length: None,
        sublane: arguments.sublane,
        options,
        sumo_words: Vec::new(),
        inputs: files.map(|path| Input::of(&path)).collect::<Result<_>>()?,
        complete: false,
        error: None,
        summary: Summary::default(),
    };
    // Only who would lose what was found asks.
    let mut interrupted = || false;
    let interrupted = sumo.map_or(&mut interrupted as &mut dyn FnMut() -> bool, |sumo| sumo.interrupted);
    let outputs = Outputs::create(&arguments.outputs, Some(&net), &record.inputs)?;
    let log = Log::create(&out, arguments.options.log_encounters)?;
    log.write_record(&record)?;
    run.log_to(log, false);
    run.write_to(outputs);
    let ended = steps(&mut replay, &mut run, interrupted, arguments.quiet);
    record.summary = run.finish(Vec::new())?;
    record.summary.remarks.extend(replay.remark());
    record.complete = ended.is_ok();
    record.error = ended.as_ref().err().map(ToString::to_string);
    if let Some(log) = run.take_log() {
        log.write_record(&record)?;
    }
    if !arguments.quiet && matches!(ended, Ok(()) | Err(Error::CutShort { .. })) {
        say(format_args!("{}", record.summary))?;
        say(format_args!("log in {}\n", out.display()))?;
    }
    ended
}

fn steps(replay: &mut Replay, run: &mut Run, interrupted: &mut dyn FnMut() -> bool, quiet: bool) -> Result<()> {
    let mut progress = None;
    while let Some(time) = replay.next(run)? {
        let progress = progress.get_or_insert_with(|| Progress::new(time, None, !quiet));
        progress.show(time, replay.road_users(), run.conflicts_so_far());
        if interrupted() {
            return Err(Error::Interrupted { time });
        }
    }
    Ok(())
}
