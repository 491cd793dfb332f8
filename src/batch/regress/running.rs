//! Runs as processes of their own: libsumo allows one simulation per process.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::scenario::Scenario;
use crate::{Error, Result};

/// How often a process is asked whether it has ended.
const ASKED_EVERY: Duration = Duration::from_millis(5);

/// How scenarios are run.
pub struct Runner<'a> {
    /// The command line that starts closecall, without arguments; it ends when its standard input does.
    pub closecall: Vec<OsString>,
    /// How many processes at once.
    pub jobs: usize,
    /// Where the logs of the runs are kept; none to throw them away.
    pub out: Option<PathBuf>,
    /// Whether the user wants to stop; asked again and again.
    pub interrupted: &'a mut dyn FnMut() -> bool,
}

/// One run.
#[derive(Clone, Debug)]
pub(super) struct Job<'a> {
    pub(super) scenario: &'a Scenario,
    /// Which of the scenarios it belongs to.
    pub(super) number: usize,
    pub(super) seed: u32,
    /// The folder of its log.
    pub(super) log: PathBuf,
}

/// What a run says of itself where it fails.
type Ended = std::result::Result<(), String>;

impl Runner<'_> {
    /// Runs all jobs; what each ended with, in their order.
    pub(super) fn run(&mut self, jobs: &[Job]) -> Result<Vec<Ended>> {
        let next = AtomicUsize::new(0);
        let stop = AtomicBool::new(false);
        let ended = Mutex::new(vec![None; jobs.len()]);
        let closecall = &self.closecall;
        let work = || {
            while !stop.load(Ordering::Relaxed) {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(job) = jobs.get(number) else { return };
                let end = one(closecall, job, &stop);
                ended.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(end);
            }
        };
        std::thread::scope(|scope| {
            let workers = (0..self.jobs.clamp(1, jobs.len().max(1))).map(|_| scope.spawn(work)).collect::<Vec<_>>();
            while workers.iter().any(|worker| !worker.is_finished()) {
                if (self.interrupted)() {
                    stop.store(true, Ordering::Relaxed);
                }
                std::thread::sleep(ASKED_EVERY);
            }
        });
        // A run that a terminal's Ctrl-C has ended too may have ended the last worker before it was asked for.
        if stop.into_inner() || (self.interrupted)() {
            return Err(Error::Stopped);
        }
        let ended = ended.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(ended.into_iter().map(|end| end.unwrap_or_else(|| Err("it never ran".to_owned()))).collect())
    }
}

/// Runs one job to its end, or until everything is to stop.
fn one(closecall: &[OsString], job: &Job, stop: &AtomicBool) -> Ended {
    let told = job.log.join("stderr.txt");
    let mut child = start(closecall, job, &told).map_err(|error| error.to_string())?;
    let status = loop {
        if stop.load(Ordering::Relaxed) {
            // One that has ended by itself needs neither.
            let _ = child.kill();
            let _ = child.wait();
            return Err("interrupted".to_owned());
        }
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) => std::thread::sleep(ASKED_EVERY),
            Err(error) => return Err(error.to_string()),
        }
    };
    if status.success() {
        return Ok(());
    }
    let text = std::fs::read_to_string(&told).unwrap_or_default();
    let own = text.lines().rev().find_map(|line| line.strip_prefix("closecall: "));
    let last = own.or_else(|| text.lines().rev().find(|line| !line.trim().is_empty()));
    Err(last.map_or_else(|| format!("closecall run ended with {status}"), str::to_owned))
}

fn start(closecall: &[OsString], job: &Job, told: &Path) -> Result<Child> {
    let Some((program, words)) = closecall.split_first() else {
        return Err(Error::Value("there is no command that runs SUMO".to_owned()));
    };
    std::fs::create_dir_all(&job.log).map_err(|source| Error::file(&job.log, source))?;
    let stderr = File::create(told).map_err(|source| Error::file(told, source))?;
    let scenario = job.scenario;
    let mut command = Command::new(program);
    command.args(words).args(scenario.words());
    // The jobs share the processor's threads among themselves: more of them per run would only be in their way.
    command.args(["--quiet", "--threads=1", "--seed", &job.seed.to_string(), "--out"]).arg(&job.log);
    if !scenario.settings.sumo_options.is_empty() {
        command.arg("--").args(&scenario.settings.sumo_options);
    }
    // In the scenario's folder, so that what its settings name is found, and the same is logged wherever it lies.
    // However this process ends, they do too.
    command.current_dir(&scenario.folder).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(stderr);
    command.spawn().map_err(|source| Error::file(Path::new(program), source))
}
