//! Runs as separate processes, since libsumo allows only one simulation per process.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};

use super::scenario::Scenario;
use crate::batch::pool::{ASKED_EVERY, Pool};
use crate::{Error, Result};

/// How scenarios are run.
pub struct Runner<'a> {
    /// The command line that starts closecall, without arguments. The process must end when its standard input is closed.
    pub closecall: Vec<OsString>,
    /// The number of parallel processes.
    pub workers: usize,
    /// The folder in which the runs' logs are kept; none to discard them.
    pub out: Option<PathBuf>,
    /// Whether the user wants to stop; called repeatedly.
    pub interrupted: &'a mut dyn FnMut() -> bool,
    /// Told repeatedly how many runs of how many have ended.
    pub progress: &'a mut dyn FnMut(u64, u64),
}

/// One run.
#[derive(Clone, Debug)]
pub(in crate::batch) struct Job<'a> {
    pub(in crate::batch) scenario: &'a Scenario,
    /// Which of the scenarios it belongs to.
    pub(in crate::batch) number: usize,
    pub(in crate::batch) seed: u32,
    /// The folder of its log.
    pub(in crate::batch) log: PathBuf,
}

/// The result of a run, with its own error message.
type JobResult = std::result::Result<(), String>;

impl Runner<'_> {
    /// Runs all jobs and returns their results, in the order of the jobs.
    pub(in crate::batch) fn run(&mut self, jobs: &[Job]) -> Result<Vec<JobResult>> {
        let Self { workers, interrupted, progress, .. } = self;
        let closecall = &self.closecall;
        Pool { workers: *workers, interrupted, progress }.run(jobs, |job, stop| one(closecall, job, stop))
    }
}

/// Runs one job until it ends or `stop` is set.
fn one(closecall: &[OsString], job: &Job, stop: &AtomicBool) -> JobResult {
    let told = job.log.join("stderr.txt");
    let mut child = start(closecall, job, &told).map_err(|error| error.to_string())?;
    let status = loop {
        if stop.load(Ordering::Relaxed) {
            // Both fail if the process has already ended, which is harmless.
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
    let Some((program, args)) = closecall.split_first() else {
        return Err(Error::Value("the command that runs SUMO is empty".to_owned()));
    };
    std::fs::create_dir_all(&job.log).map_err(|source| Error::file(&job.log, source))?;
    let stderr = File::create(told).map_err(|source| Error::file(told, source))?;
    let scenario = job.scenario;
    let mut command = Command::new(program);
    command.args(args).args(scenario.args());
    // The jobs already keep the processor's threads busy.
    command.args(["--quiet", "--threads=1", "--seed", &job.seed.to_string(), "--out"]).arg(&job.log);
    if !scenario.settings.sumo_options.is_empty() {
        command.arg("--").args(&scenario.settings.sumo_options);
    }
    // In the scenario's folder, the paths in its settings resolve, and the log does not depend on where the folder is.
    // The pipe closes when this process ends in any way, which ends the child as well.
    command.current_dir(&scenario.folder).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(stderr);
    command.spawn().map_err(|source| Error::file(Path::new(program), source))
}
