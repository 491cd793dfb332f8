//! Which folders are logs.

use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashSet;

use crate::{Error, Result};
use closecall_run::output::earlier_log::EARLIER;
pub use closecall_run::output::log::PARQUET;
use closecall_run::output::log::{CONFLICTS, files};
use closecall_run::util::output_file::same_file;

/// The name of the file of counts that a blessed scenario has.
pub const SUMMARY: &str = "summary.json";

/// The log folders among these and below them, each once, in the order of their paths. Earlier logs that a run has kept
/// are found only in folders that are named.
///
/// # Errors
/// [`Error::file`] where a folder is missing or cannot be read; [`Error::content`] where it holds no log.
pub fn log_folders(named: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut known = Vec::new();
    for folder in named {
        if folder.is_file() {
            return Err(Error::content(folder, "it is a file; name the folder of a log, such as closecall-out"));
        }
        let mut found = logs_below(folder)?;
        if found.is_empty() {
            return Err(Error::content(
                folder,
                format!("no log in it: neither {CONFLICTS} nor {PARQUET}, at any depth"),
            ));
        }
        known.append(&mut found);
    }
    known.sort();
    known.dedup_by(|a, b| a.0 == b.0);
    Ok(known.into_iter().map(|(_, folder)| folder).collect())
}

/// Checks that an output does not overwrite its own inputs: the files of the logs in these folders, and the net.
///
/// # Errors
/// Those of [`log_folders`]; [`Error::WouldReplace`] that names the file.
pub fn check_keeps_logs(out: &Path, folders: &[PathBuf], net: Option<&Path>) -> Result<()> {
    let logs = log_folders(folders)?;
    let read = logs.iter().flat_map(|log| files(log)).chain(net.map(Path::to_owned));
    let read = read.collect::<Vec<_>>();
    let over = same_file(out, read.iter().map(|file| &**file));
    over.map_or(Ok(()), |over| Err(Error::WouldReplace(over.to_owned())))
}

/// The logs in a folder and below it, each as its real folder and as it was come to. A folder that links lead to more than
/// once, or back to, is searched once.
fn logs_below(folder: &Path) -> Result<Vec<(PathBuf, PathBuf)>> {
    let mut logs = Vec::new();
    let mut searched = FxHashSet::default();
    let mut ahead = VecDeque::from([folder.to_owned()]);
    while let Some(folder) = ahead.pop_front() {
        let real = folder.canonicalize().map_err(|source| Error::file(&folder, source))?;
        if searched.insert(real.clone()) {
            let (is_log, below) = search(&folder)?;
            ahead.extend(below);
            if is_log {
                logs.push((real, folder));
            }
        }
    }
    Ok(logs)
}

/// Whether a folder is a log, and the folders in it to search.
fn search(folder: &Path) -> Result<(bool, Vec<PathBuf>)> {
    let entries = fs::read_dir(folder).map_err(|source| Error::file(folder, source))?;
    let mut below = Vec::new();
    let mut is_log = false;
    let mut is_blessed = false;
    for entry in entries {
        let path = entry.map_err(|source| Error::file(folder, source))?.path();
        let name = path.file_name().unwrap_or_default();
        // A hidden folder is a run that its sweep has not finished.
        if path.is_dir() && !name.as_encoded_bytes().starts_with(b".") {
            below.push(path);
        } else {
            is_log |= name == CONFLICTS || name == PARQUET;
            is_blessed |= name == SUMMARY;
        }
    }
    if is_log {
        below.retain(|path| path.file_name().unwrap_or_default() != EARLIER);
    }
    below.sort_unstable();
    // What `closecall regress` has blessed looks like a log, but is none.
    Ok((is_log && !is_blessed, below))
}

#[cfg(test)]
mod tests {
    use crate::logged::folders::*;

    #[test]
    fn logs_are_found_at_any_depth_and_each_once() {
        let top = std::env::temp_dir().join(format!("closecall-folders-{}", std::process::id()));
        for run in ["a/seed=1", "a/seed=2", "b"] {
            fs::create_dir_all(top.join(run)).unwrap();
            fs::write(top.join(run).join(CONFLICTS), "").unwrap();
        }
        fs::create_dir_all(top.join("expected")).unwrap();
        [CONFLICTS, SUMMARY].iter().for_each(|file| fs::write(top.join("expected").join(file), "").unwrap());
        let found = log_folders(&[top.clone(), top.join("b")]).unwrap();
        assert_eq!(found, [top.join("a/seed=1"), top.join("a/seed=2"), top.join("b")]);
        fs::remove_file(top.join("b").join(CONFLICTS)).unwrap();
        assert!(log_folders(&[top.join("b")]).unwrap_err().to_string().contains("no log in it"));
        assert!(log_folders(&[top.join("c")]).unwrap_err().to_string().contains("/c: "));
        fs::remove_dir_all(top).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_holds_itself_is_searched_once() {
        let top = tempfile::tempdir().unwrap();
        fs::create_dir(top.path().join("log")).unwrap();
        fs::write(top.path().join("log").join(CONFLICTS), "").unwrap();
        ["a", "b", "c"].iter().for_each(|link| std::os::unix::fs::symlink(top.path(), top.path().join(link)).unwrap());
        assert_eq!(log_folders(&[top.path().to_owned()]).unwrap(), [top.path().join("log")]);
    }

    #[test]
    fn earlier_logs_count_only_where_they_are_named() {
        let top = tempfile::tempdir().unwrap();
        let log = top.path().join("log");
        for folder in [log.clone(), log.join("earlier/1"), log.join("earlier/2")] {
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join(CONFLICTS), "").unwrap();
        }
        assert_eq!(log_folders(&[top.path().to_owned()]).unwrap(), std::slice::from_ref(&log));
        let earlier = log.join("earlier");
        assert_eq!(log_folders(std::slice::from_ref(&earlier)).unwrap(), [earlier.join("1"), earlier.join("2")]);
    }
}
