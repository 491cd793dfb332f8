//! `closecall replay --each`: many recordings in parallel, each with a log of its own.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::error::{Error, Result};
use super::print::{print, value};
use super::progress::CountBar;
use super::replay::{Asking, Prepared, ReplayArgs, check, prepare};
use super::sumo::Sumo;
use closecall::detection::kind::Severity;
use closecall::traffic::net::Net;
use closecall::util::remark::Remark;
use closecall::util::threads::processors;
use closecall::util::units::counted;
use closecall_analysis::batch::pool::Pool;
use closecall_run::Error as RunError;
use closecall_run::RunOptions;
use closecall_run::output::folder::LogFolder;
use closecall_run::output::log;
use closecall_run::output::summary::Summary;
use closecall_run::util::panics::caught;

/// Checks each recording into a folder of its name in that of --out; returns the greatest of their exit statuses.
pub(super) fn run(arguments: &ReplayArgs, sumo: Option<Sumo>) -> Result<u8> {
    if let Some((option, _)) = arguments.check.outputs.files().next() {
        return Err(value(format!("{option}: all recordings would write the same file")));
    }
    let Prepared { options, folder, net } = prepare(arguments)?;
    let out = folder.path();
    let own = out.join(log::CONFLICTS);
    if own.exists() {
        let message = "this is the log of a single recording, which would count as one of these: choose another --out";
        return Err(RunError::content(&own, message).into());
    }
    let logs = logs(&arguments.recordings, out)?;
    let quiet = arguments.check.quiet;
    let mut bar = CountBar::new("recordings", !quiet);
    let complete = AtomicU64::new(0);
    let mut never = || false;
    let mut pool = Pool {
        workers: arguments.workers.map_or_else(processors, usize::from),
        interrupted: sumo.map_or(&mut never as &mut dyn FnMut() -> bool, |sumo| sumo.interrupted),
        progress: &mut |done, all| bar.show(done, all),
    };
    let checked = pool.run(&logs, |(log, recording), stop| {
        let checked = one(arguments, &options, net.as_ref(), recording, log, stop);
        complete.fetch_add(checked.1.is_ok().into(), Ordering::Relaxed);
        checked
    });
    drop(bar);
    let checked = checked.map_err(|error| match error.into() {
        Error::Run(RunError::Stopped) => Error::InterruptedEach(complete.into_inner(), logs.len() as u64),
        other => other,
    })?;
    let mut status = 0;
    for ((log, recording), (summary, outcome)) in logs.iter().zip(checked) {
        if let Err(error) = outcome {
            eprintln!("closecall: {}", named(recording, &error.to_string()));
            status = status.max(error.exit_status());
        }
        if let (Some(summary), false) = (summary, quiet) {
            tell(recording, log, &summary)?;
        }
    }
    Ok(status)
}

/// The folder of each recording's log, with the recording; named as the file is up to its first dot.
fn logs(recordings: &[PathBuf], out: &Path) -> Result<Vec<(PathBuf, PathBuf)>> {
    let mut logs = BTreeMap::new();
    for recording in recordings {
        let file = recording.file_name().unwrap_or_default().to_string_lossy();
        let name = file.split('.').find(|part| !part.is_empty()).unwrap_or("recording");
        if let Some(other) = logs.insert(out.join(name), recording.clone()) {
            let (other, recording) = (other.display(), recording.display());
            return Err(value(format!("{other} and {recording}: the logs of both would be named {name}")));
        }
    }
    Ok(logs.into_iter().collect())
}

/// Checks one recording; returns its summary, if there are results, and how it ended.
fn one(
    arguments: &ReplayArgs,
    options: &RunOptions,
    net: Option<&Arc<Net>>,
    recording: &PathBuf,
    log: &Path,
    stop: &AtomicBool,
) -> (Option<Summary>, Result<()>) {
    let is_set = || stop.load(Ordering::Relaxed);
    let remark = |remark: &Remark| {
        if !arguments.check.quiet {
            eprintln!("closecall: {}", named(recording, &remark.to_string()));
        }
    };
    let checked = caught(|| {
        let asking =
            Asking { stopped: &mut { is_set }, interrupted: &mut { is_set }, remark: &remark, shows_progress: false };
        let folder = LogFolder::claim(log)?;
        // The recordings already keep the processors busy.
        let threads = arguments.threads.unwrap_or(1);
        let recordings = std::slice::from_ref(recording);
        let checked = check(arguments, recordings, options.clone(), net.cloned(), folder, threads, asking)?;
        if checked.0.is_some() {
            arguments.check.complete(log)?;
        }
        Ok::<_, Error>(checked)
    });
    checked.map_err(Error::from).flatten().unwrap_or_else(|error| (None, Err(error)))
}

/// Prints what a recording has, in a line, after the remarks that were not said at the beginning.
fn tell(recording: &Path, log: &Path, summary: &Summary) -> Result<()> {
    let remarks = summary.remarks.iter().filter(|remark| !remark.code.is_of_opening());
    remarks.for_each(|remark| eprintln!("closecall: {}", named(recording, &remark.to_string())));
    let conflicts = counted(summary.count(None, None), "conflict");
    let serious = summary.count(None, Some(Severity::Serious));
    let critical = summary.count(None, Some(Severity::Critical));
    print(format_args!("{}: {conflicts}, {serious} serious, {critical} critical\n", log.display()))
}

/// The message with the recording's name, unless it names that itself.
fn named(recording: &Path, message: &str) -> String {
    let recording = recording.display().to_string();
    if message.contains(&recording) { message.to_owned() } else { format!("{recording}: {message}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_recordings_never_share_a_log() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let found = logs(&paths(&["b/two.fcd.xml.gz", "a/one.csv"]), Path::new("out")).unwrap();
        assert_eq!(found.iter().map(|(log, _)| log.clone()).collect::<Vec<_>>(), paths(&["out/one", "out/two"]));
        let refused = logs(&paths(&["a/fcd.xml", "b/fcd.csv"]), Path::new("out")).unwrap_err().to_string();
        assert_eq!(refused, "a/fcd.xml and b/fcd.csv: the logs of both would be named fcd");
    }
}
