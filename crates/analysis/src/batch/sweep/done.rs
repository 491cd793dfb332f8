//! Which runs of a sweep are done already.
//!
//! A run is done if its file exists, whole, and records that the run ended normally, if the words and the version are the
//! same, and if the files that it read have not changed since.

use std::fs;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use super::task::{RUN, Task, data_set};
use crate::logged::{ConflictReader, Label, LabelValue, LoggedRun, PARQUET, Packed};
use crate::{Error, Result};
use closecall_run::output::input_hash::{Hasher, Input};
use closecall_run::output::log;

/// The hashes of the files that closecall itself reads.
pub(super) fn contents(files: &[PathBuf]) -> Result<Vec<String>> {
    files.iter().map(|path| Ok(Input::of(path)?.sha256)).collect()
}

/// The hash of everything that defines a run.
pub(super) fn fingerprint(args: &[String], labels: &[Label], read: &[String]) -> String {
    let mut hasher = Hasher::default();
    for part in [env!("CARGO_PKG_VERSION")].into_iter().chain(args.iter().chain(read).map(String::as_str)) {
        hasher.add((part.len() as u64).to_le_bytes());
        hasher.add(part);
    }
    hasher.add(format!("{labels:?}"));
    hasher.digits()
}

pub(super) fn missing<'a>(out: &Path, tasks: &'a [Task]) -> Result<Vec<&'a Task>> {
    let log = out.join(log::CONFLICTS);
    if log.exists() {
        let message = "this is the log of a single run, which would count as one of the sweep: choose another --out";
        return Err(Error::content(&log, message));
    }
    check_columns(out, tasks)?;
    let mut hashes = FxHashMap::default();
    Ok(tasks.iter().filter(|task| !is_done(task, &mut hashes)).collect())
}

/// The present hashes of the input files, each read once; none for a file that is gone.
type Hashes = FxHashMap<PathBuf, Option<String>>;

fn is_done(task: &Task, hashes: &mut Hashes) -> bool {
    // A run whose file cannot be read is repeated.
    let Ok(packed) = Packed::of(&task.file()) else { return false };
    let Ok(run) = serde_json::from_str::<LoggedRun>(&packed.record) else { return false };
    let mut is_as_it_was = |input: &Input| {
        let now =
            hashes.entry(input.path.clone()).or_insert_with_key(|path| Input::of(path).ok().map(|now| now.sha256));
        now.as_ref() == Some(&input.sha256)
    };
    run.complete
        && packed.fingerprint == task.fingerprint
        && run.inputs.iter().all(&mut is_as_it_was)
        && is_whole(&task.file())
}

/// Whether all rows of a file can be read, and are those that its run counted.
fn is_whole(file: &Path) -> bool {
    let Some(Ok(mut rows)) = file.parent().map(ConflictReader::open) else { return false };
    rows.by_ref().all(|row| row.is_ok()) && rows.lost().is_none()
}

/// All files of a data set must have the same columns, including those of earlier runs.
fn check_columns(out: &Path, tasks: &[Task]) -> Result<()> {
    let Some(first) = tasks.first() else { return Ok(()) };
    let is_number = |value: &LabelValue| !matches!(value, LabelValue::Text(_));
    let own = first.labels.iter().map(|label| (label.name.clone(), is_number(&label.value))).collect::<Vec<_>>();
    for folder in runs_in(&data_set(out)) {
        let Ok(packed) = Packed::of(&folder.join(PARQUET)) else { continue };
        if packed.labels != own {
            let names =
                |labels: &[(String, bool)]| labels.iter().map(|label| label.0.clone()).collect::<Vec<_>>().join(", ");
            let message = format!(
                "it holds a run of a sweep that varied {}, not {}: choose another --out",
                names(&packed.labels),
                names(&own)
            );
            return Err(Error::content(&folder, message));
        }
    }
    Ok(())
}

fn runs_in(data_set: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(data_set).into_iter().flatten().flatten();
    let mut folders = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(RUN)).collect::<Vec<_>>();
    folders.sort_by_key(fs::DirEntry::file_name);
    folders.iter().map(fs::DirEntry::path).collect()
}
