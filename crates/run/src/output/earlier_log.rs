//! The earlier log in a run's folder: it is moved aside, so that running a command again loses no log.
//!
//! It goes into the folder itself, because the folder above may not be writable, and its other files may be the user's
//! own.

use std::fs;
use std::path::{Path, PathBuf};

use super::log::{RUN, files};
use crate::util::output_file::check_is_no_link;
use crate::{Error, Result};

/// The folder of the earlier logs, within the log's own: `earlier/1`, `earlier/2`, …
pub const EARLIER: &str = "earlier";

/// A log that was moved aside.
#[derive(Debug)]
pub(crate) struct EarlierLog {
    folder: PathBuf,
    /// Where it is now.
    pub kept: PathBuf,
}

impl EarlierLog {
    /// Moves the log in a folder, if there is one, aside.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be moved.
    pub fn keep(folder: &Path) -> Result<Option<Self>> {
        if !files(folder).any(|path| path.is_file()) {
            return Ok(None);
        }
        let within = folder.join(EARLIER);
        check_is_no_link(&within)?;
        let numbers = fs::read_dir(&within).into_iter().flatten().flatten();
        let numbers = numbers.filter_map(|entry| entry.file_name().to_str()?.parse::<u64>().ok());
        let last = numbers.max().unwrap_or_default();
        let of = |number: u64| within.join(number.to_string());
        let kept = if last > 0 && is_rest(folder, &of(last)) { of(last) } else { of(last + 1) };
        check_is_no_link(&kept)?;
        fs::create_dir_all(&kept).map_err(|source| Error::file(&kept, source))?;
        move_log(folder, &kept)?;
        Ok(Some(Self { folder: folder.to_owned(), kept }))
    }

    /// Moves it back: the run that would have replaced it came to nothing.
    pub fn restore(self) {
        // What cannot be moved stays where it is: the error to report is the one that led here.
        let _ = fs::create_dir_all(&self.folder);
        if move_log(&self.kept, &self.folder).is_ok() {
            let _ = fs::remove_dir(&self.kept);
            let _ = fs::remove_dir(self.folder.join(EARLIER));
        }
    }
}

/// Whether a move to `kept` ended in the middle, so that `folder` has the rest of that log: `run.json` goes last.
fn is_rest(folder: &Path, kept: &Path) -> bool {
    let both = || files(folder).zip(files(kept));
    folder.join(RUN).is_file() && !both().any(|(rest, moved)| rest.is_file() && moved.exists())
}

fn move_log(from: &Path, to: &Path) -> Result<()> {
    for (file, target) in files(from).zip(files(to)).filter(|(file, _)| file.is_file()) {
        fs::rename(&file, target).map_err(|source| Error::file(&file, source))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::log::CONFLICTS;

    #[test]
    fn every_earlier_log_is_kept_and_other_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let of = |path: &str| fs::read_to_string(folder.path().join(path)).ok();
        fs::write(folder.path().join("mine.xml"), "mine").unwrap();
        assert!(EarlierLog::keep(folder.path()).unwrap().is_none());
        for text in ["first", "second"] {
            fs::write(folder.path().join(CONFLICTS), text).unwrap();
            assert!(EarlierLog::keep(folder.path()).unwrap().is_some());
        }
        assert_eq!(of("earlier/1/conflicts.csv").as_deref(), Some("first"));
        assert_eq!(of("earlier/2/conflicts.csv").as_deref(), Some("second"));
        assert_eq!((of("mine.xml").as_deref(), of(CONFLICTS)), (Some("mine"), None));
    }

    #[test]
    fn a_move_that_was_interrupted_is_completed() {
        let folder = tempfile::tempdir().unwrap();
        let of = |path: &str| fs::read_to_string(folder.path().join(path)).ok();
        fs::create_dir_all(folder.path().join("earlier/1")).unwrap();
        fs::write(folder.path().join("earlier/1").join(CONFLICTS), "first").unwrap();
        fs::write(folder.path().join(RUN), "its record").unwrap();
        EarlierLog::keep(folder.path()).unwrap();
        assert_eq!(of("earlier/1/conflicts.csv").as_deref(), Some("first"));
        assert_eq!((of("earlier/1/run.json").as_deref(), of(RUN)), (Some("its record"), None));
    }

    #[test]
    fn a_restored_log_is_where_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join(CONFLICTS);
        fs::write(&log, "first").unwrap();
        EarlierLog::keep(folder.path()).unwrap().unwrap().restore();
        assert_eq!(fs::read_to_string(&log).unwrap(), "first");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
