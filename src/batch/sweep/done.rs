//! What of a sweep is done already.
//!
//! A run is done where its file is there, says that the run came to its end, was asked for in the same words by the
//! same version, and the files that it read are what they were then.

use std::fs;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;
use sha2::{Digest, Sha256};

use super::task::{RUN, Task, data_set};
use crate::analysis::logged::{Label, LabelValue, LoggedRun, PARQUET, Packed};
use crate::output::input_hash::Input;
use crate::output::log;
use crate::{Error, Result};

/// The hashes of files that are read besides what SUMO reads.
pub(super) fn contents(files: &[PathBuf]) -> Result<Vec<String>> {
    files.iter().map(|path| Input::of(path).map(|input| input.sha256)).collect()
}

/// The hash of what is asked of a run.
pub(super) fn fingerprint(words: &[String], labels: &[Label], read: &[String]) -> String {
    let mut hasher = Sha256::new();
    for part in [env!("CARGO_PKG_VERSION")].into_iter().chain(words.iter().chain(read).map(String::as_str)) {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.update(format!("{labels:?}"));
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

pub(super) fn missing<'a>(out: &Path, tasks: &'a [Task]) -> Result<Vec<&'a Task>> {
    let log = out.join(log::CONFLICTS);
    if log.exists() {
        let message = "this is a single run's, which would count as one of the sweep's: choose another --out";
        return Err(Error::content(&log, message));
    }
    check_columns(out, tasks)?;
    let mut hashes = FxHashMap::default();
    Ok(tasks.iter().filter(|task| !is_done(task, &mut hashes)).collect())
}

/// The input files with the hashes that they have now, each read once; none where one is gone.
type Hashes = FxHashMap<PathBuf, Option<String>>;

fn is_done(task: &Task, hashes: &mut Hashes) -> bool {
    // What cannot be read is done again.
    let Ok(packed) = Packed::of(&task.file()) else { return false };
    let Ok(run) = serde_json::from_str::<LoggedRun>(&packed.record) else { return false };
    let mut is_as_it_was = |input: &Input| {
        let now =
            hashes.entry(input.path.clone()).or_insert_with_key(|path| Input::of(path).ok().map(|now| now.sha256));
        now.as_ref() == Some(&input.sha256)
    };
    run.complete && packed.fingerprint == task.fingerprint && run.inputs.iter().all(&mut is_as_it_was)
}

/// All files of a data set have the same columns, those of runs before included.
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
