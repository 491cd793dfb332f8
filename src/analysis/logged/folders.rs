//! Which folders are logs.

use std::fs;
use std::path::{Path, PathBuf};

use crate::output::earlier_log::EARLIER;
use crate::output::log::CONFLICTS;
use crate::{Error, Result};

/// The name of the conflicts' file in a sweep.
pub const PARQUET: &str = "conflicts.parquet";
/// The name of the file of counts that a blessed scenario has.
pub const SUMMARY: &str = "summary.json";

/// How many levels below a named folder are searched: a guard against links that lead upwards.
const DEEPEST: usize = 16;

/// The log folders among these and below them, each once, in the order of their paths. Earlier logs that a run has kept
/// are found only in folders that are named.
///
/// # Errors
/// [`Error::File`] where a folder is missing or cannot be read; [`Error::Content`] where it holds no log.
pub fn log_folders(named: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for folder in named {
        let before = found.len();
        search(folder, DEEPEST, &mut found)?;
        if found.len() == before {
            return Err(Error::content(
                folder,
                format!("there is no log in it: no {CONFLICTS} or {PARQUET}, at any depth"),
            ));
        }
    }
    let mut known = Vec::with_capacity(found.len());
    for folder in found {
        known.push((folder.canonicalize().map_err(|source| Error::file(&folder, source))?, folder));
    }
    known.sort();
    known.dedup_by(|a, b| a.0 == b.0);
    Ok(known.into_iter().map(|(_, folder)| folder).collect())
}

fn search(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) -> Result<()> {
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
    // What `closecall regress` has blessed looks like a log, but is none.
    if is_log && !is_blessed {
        found.push(folder.to_owned());
    }
    if depth > 0 {
        below.iter().try_for_each(|path| search(path, depth - 1, found))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::analysis::logged::folders::*;

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
        assert!(log_folders(&[top.join("b")]).unwrap_err().to_string().contains("there is no log in it"));
        assert!(log_folders(&[top.join("c")]).unwrap_err().to_string().contains("/c: "));
        fs::remove_dir_all(top).unwrap();
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
