//! `closecall replay`: the same checks on a recording; SUMO is not needed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::check_args::CheckArgs;
use super::error::{Error, Result};
use super::progress::Progress;
use super::sumo::Sumo;
use closecall::traffic::net::Net;
use closecall::util::remark::Remark;
use closecall::util::threads::default_threads;
use closecall_run::Error as RunError;
use closecall_run::RunOptions;
use closecall_run::input::replay::Replay;
use closecall_run::input::scenario_kind;
use closecall_run::input::tracks::{self, TrackOptions};
use closecall_run::output::folder::LogFolder;
use closecall_run::output::input_hash::Input;
use closecall_run::output::record::RunRecord;
use closecall_run::output::summary::Summary;
use closecall_run::run::Run;
use closecall_run::run::recorded::{Ending, RecordedRun};

/// A recording and how to check it.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct ReplayArgs {
    /// Recording to check: SUMO's fcd-output as XML, CSV or Parquet, SSAM's .trj, Vissim's .fzp, or a table of trajectories; also
    /// gzipped. Several tables of one time base, such as those of vehicles and of pedestrians, are one recording; see --each.
    #[arg(value_name = "FILE", required = true, help_heading = None::<&str>)]
    pub(super) recordings: Vec<PathBuf>,
    /// Net on which the recording was made. Without one, paths follow no lanes: see --path arc.
    #[arg(short = 'n', long, value_name = "NET")]
    net: Option<PathBuf>,
    #[command(flatten)]
    tracks: TrackOptions,
    /// Route and additional files that define the vehicle types and the routes; other types are SUMO's defaults.
    #[arg(short = 'r', long, value_name = "FILE,…", value_delimiter = ',')]
    route_files: Vec<PathBuf>,
    /// What the traffic lights showed: SUMO's output of a timedEvent SaveTLSStates or SaveTLSSwitchStates; also gzipped. It needs
    /// a net. Without it the causes ran_red and late_amber are not found.
    #[arg(long, value_name = "FILE", requires = "net")]
    signals: Option<PathBuf>,
    /// Where vehicles stopped: SUMO's --stop-output; also gzipped. Without it the cause stood is found only for obstacles.
    #[arg(long, value_name = "FILE")]
    stops: Option<PathBuf>,
    /// The recording was made with SUMO's sublane model (--lateral-resolution), where vehicles move sideways within a lane.
    #[arg(long)]
    sublane: bool,
    /// Maximum number of threads that test the pairs of a step [default: one per processor]. With 1, no thread reads the steps
    /// ahead.
    #[arg(long, value_name = "N", help_heading = "Run", value_parser = clap::value_parser!(u8).range(1..=64))]
    pub(super) threads: Option<u8>,
    /// Check each file as a recording of its own, in parallel: its log goes to a folder of its name in that of --out. All
    /// other options hold for each; --threads is then 1 by default.
    #[arg(long, help_heading = "Run", requires = "out", conflicts_with = "explain")]
    pub(super) each: bool,
    /// Recordings at the same time, with --each [default: one per processor].
    #[arg(long, value_name = "N", help_heading = "Run", value_parser = clap::value_parser!(u16).range(1..))]
    pub(super) workers: Option<u16>,
    #[command(flatten)]
    pub(super) check: CheckArgs,
}

impl ReplayArgs {
    /// The recording, or the first file of it.
    fn recording(&self) -> &Path {
        self.recordings.first().map_or(Path::new(""), PathBuf::as_path)
    }
}

/// What a check may ask for and tell.
pub(super) struct Asking<'a> {
    /// Whether the user wants to stop, while there are no results to keep.
    pub stopped: &'a mut dyn FnMut() -> bool,
    /// The same once there are results.
    pub interrupted: &'a mut dyn FnMut() -> bool,
    /// Takes the remarks that are known before the first step.
    pub remark: &'a dyn Fn(&Remark),
    /// Whether to show the progress.
    pub shows_progress: bool,
}

/// Checks the recording and prints the summary.
pub fn run(arguments: ReplayArgs, sumo: Option<Sumo>) -> Result<()> {
    let recording = arguments.recording().to_owned();
    let Prepared { options, folder, net } = prepare(&arguments)?;
    let out = folder.path().to_owned();
    let quiet = arguments.check.quiet;
    let print = |remark: &Remark| eprintln!("closecall: {remark}");
    // From its first call on, an interrupt no longer ends the process, so it is first called when there are results.
    let mut never = || false;
    let asking = Asking {
        stopped: &mut || false,
        interrupted: sumo.map_or(&mut never as &mut dyn FnMut() -> bool, |sumo| sumo.interrupted),
        remark: if quiet { &|_| () } else { &print },
        shows_progress: !quiet,
    };
    let threads = arguments.threads.unwrap_or_else(default_threads);
    let (summary, outcome) = check(&arguments, &arguments.recordings, options, net, folder, threads, asking)?;
    if let Some(summary) = summary {
        arguments.check.finish(&summary, &recording, &out)?;
    }
    outcome
}

/// What all recordings of a command share.
pub(super) struct Prepared {
    pub options: RunOptions,
    /// The folder of --out.
    pub folder: LogFolder,
    pub net: Option<Arc<Net>>,
}

/// Checks the options, claims the folder and reads the net.
pub(super) fn prepare(arguments: &ReplayArgs) -> Result<Prepared> {
    let out = arguments.check.log_folder(arguments.recording());
    let options = arguments.check.checked(&out)?;
    let folder = arguments.check.claim(&out)?;
    let net = arguments.net.as_deref().map(closecall_run::net::read).transpose()?.map(Arc::new);
    Ok(Prepared { options, folder, net })
}

/// Checks one recording, which may be several tables; returns its summary, if there are results to show, and how its steps
/// ended.
pub(super) fn check(
    arguments: &ReplayArgs,
    recordings: &[PathBuf],
    options: RunOptions,
    net: Option<Arc<Net>>,
    folder: LogFolder,
    threads: u8,
    asking: Asking,
) -> Result<(Option<Summary>, Result<()>)> {
    recordings.iter().try_for_each(|recording| scenario_kind::check_is_recording(recording))?;
    let opened = tracks::open(recordings, &arguments.tracks, net.as_deref(), asking.stopped)?;
    let demand = arguments.route_files.iter().cloned().chain(opened.types()).collect::<Vec<_>>();
    let mut replay = Replay::open_unless(opened.recording(), &demand, net.as_deref(), &options.model, asking.stopped)?;
    if threads > 1 {
        replay = replay.read_ahead()?;
    }
    if let (Some(signals), Some(net)) = (&arguments.signals, &net) {
        replay.set_lights(signals, net)?;
    }
    arguments.stops.iter().try_for_each(|stops| replay.set_stops(stops))?;
    let mut run = Run::new(&options, net)?;
    run.set_threads(threads.into());
    run.set_fixed_routes(true);
    run.set_sublane(arguments.sublane);
    run.drop_closed_conflicts();
    let of_recording = opened.remarks();
    let of_run = run.opening_remarks(Some(replay.step_length()));
    of_recording.iter().chain(&of_run).for_each(asking.remark);
    run.set_tracked(opened.is_tracked());
    run.set_averaged_over(if opened.has_speeds_of_moments() { 0.0 } else { replay.averaged_over() });
    let record = RunRecord { aligned: run.aligns(), ..record(arguments, recordings, options)? };
    let mut recorded = RecordedRun::open(run, record, folder, &arguments.check.outputs)?;
    let outcome = check_steps(&mut replay, &mut recorded.run, asking.interrupted, asking.shows_progress);
    let closed = recorded.close(Ending {
        error: outcome.as_ref().err().map(ToString::to_string),
        remarks: [of_recording, replay.remarks()].concat(),
        ..Ending::default()
    });
    let has_results = matches!(outcome, Ok(()) | Err(Error::Run(RunError::CutShort { .. })));
    Ok((if has_results { Some(closed?) } else { None }, outcome))
}

/// The record of a replay that begins.
fn record(arguments: &ReplayArgs, recordings: &[PathBuf], options: RunOptions) -> Result<RunRecord> {
    let files = recordings
        .iter()
        .chain(&arguments.net)
        .chain(&arguments.route_files)
        .chain(&arguments.signals)
        .chain(&arguments.stops);
    Ok(RunRecord {
        sublane: arguments.sublane,
        inputs: files.map(|path| Input::of(path)).collect::<closecall_run::Result<_>>()?,
        ..RunRecord::new(recordings.first().cloned().unwrap_or_default(), options)
    })
}

/// Checks every step.
fn check_steps(
    replay: &mut Replay,
    run: &mut Run,
    interrupted: &mut dyn FnMut() -> bool,
    shows_progress: bool,
) -> Result<()> {
    let mut progress = None;
    while let Some(time) = replay.next(run)? {
        let progress = progress.get_or_insert_with(|| Progress::new(time, None, shows_progress));
        progress.show(time, replay.road_users(), run.closed_conflicts());
        if interrupted() {
            return Err(RunError::Interrupted { time }.into());
        }
    }
    Ok(())
}
