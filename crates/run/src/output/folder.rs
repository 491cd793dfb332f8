//! The folder of a log, for one run at a time: two that write to it would destroy each other's log.
//!
//! A run holds a lock of the operating system on a file in it, which ends with the process, however that ends.

use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use crate::util::output_file::{folder_of, sync_folder};
use crate::{Error, Result};
use closecall::util::units::counted;

/// The file that is locked: it holds the number of the process, and its time is the begin of the run.
const LOCK: &str = ".closecall.lock";

/// A folder that no other run writes its log to.
#[derive(Debug)]
pub struct LogFolder {
    path: PathBuf,
    /// Locked until it is closed.
    _lock: File,
    is_new: bool,
}

impl LogFolder {
    /// Claims a folder, which is made if it does not exist.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written; [`Error::Content`] where another run writes there.
    pub fn claim(path: &Path) -> Result<Self> {
        let is_new = !path.exists();
        Self::claim_as(path, is_new)
    }

    /// Claims a new folder whose name is that of `path` and a number.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written.
    pub fn claim_new(path: &Path) -> Result<Self> {
        let within = folder_of(path);
        fs::create_dir_all(within).map_err(|source| Error::file(within, source))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let mut number = 0_u64;
        loop {
            number += 1;
            let numbered = path.with_file_name(format!("{name}-{number}"));
            match fs::create_dir(&numbered) {
                Ok(()) => return Self::claim_as(&numbered, true),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Error::file(&numbered, error)),
            }
        }
    }

    fn claim_as(path: &Path, is_new: bool) -> Result<Self> {
        let folder = Self { _lock: lock(path)?, path: path.to_owned(), is_new };
        if is_new {
            sync_folder(folder_of(path));
        }
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for LogFolder {
    fn drop(&mut self) {
        // What cannot be removed stays, and hinders no later run.
        let _ = fs::remove_file(self.path.join(LOCK));
        if self.is_new {
            // Only if it is empty: a run that came to nothing leaves no folder.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

fn lock(folder: &Path) -> Result<File> {
    let path = folder.join(LOCK);
    let fault = |source| Error::file(&path, source);
    loop {
        fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
        if path.is_symlink() {
            return Err(Error::content(&path, "a symbolic link, where a run has its lock"));
        }
        let mut file = match File::options().read(true).write(true).create(true).truncate(false).open(&path) {
            Ok(file) => file,
            // Another run has just ended, and removed its folder.
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(error) => return Err(fault(error)),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(taken(folder, &mut file)),
            // Some file systems have no locks.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(fault(error)),
        }
        // Another run may have ended, and removed the file, before this one locked it.
        if is_at(&file, &path) {
            file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id())).map_err(fault)?;
            return Ok(file);
        }
    }
}

/// That another run writes to the folder, with what its lock says.
fn taken(folder: &Path, lock: &mut File) -> Error {
    let mut process = String::new();
    // Where it cannot be read, the message does without.
    let _ = lock.read_to_string(&mut process);
    let begun = lock.metadata().and_then(|lock| lock.modified()).ok().and_then(|begun| begun.elapsed().ok());
    let process = Some(process.trim()).filter(|process| !process.is_empty());
    let which = process.map_or_else(String::new, |process| format!(" (process {process}"));
    let since = begun.map_or_else(String::new, |begun| format!(", begun {} ago", counted(begun.as_secs(), "second")));
    let which = if which.is_empty() { which } else { which + &since + ")" };
    Error::content(
        folder,
        format!("another run writes its log there{which}; name another folder, or auto for a new one"),
    )
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let number = |metadata: &fs::Metadata| (metadata.dev(), metadata.ino());
    matches!((file.metadata(), path.symlink_metadata()), (Ok(a), Ok(b)) if number(&a) == number(&b))
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::Builder;

    #[test]
    fn a_folder_is_for_one_run_at_a_time() {
        let within = tempfile::tempdir().unwrap();
        let path = within.path().join("log");
        let first = LogFolder::claim(&path).unwrap();
        let refused = LogFolder::claim(&path).unwrap_err().to_string();
        let process = format!("(process {}, begun 0 seconds ago)", std::process::id());
        assert!(refused.contains(&process), "{refused}");
        assert!(path.exists());
        drop(first);
        assert!(!path.exists(), "a run that came to nothing left its folder");
        fs::create_dir(&path).unwrap();
        fs::write(path.join(LOCK), "1").unwrap();
        drop(LogFolder::claim(&path).unwrap());
        assert_eq!(fs::read_dir(&path).unwrap().count(), 0, "an old lock does not hinder a run, and goes");
    }

    #[test]
    fn each_of_many_runs_gets_a_folder_of_its_own() {
        let within = tempfile::tempdir().unwrap();
        let path = within.path().join("log");
        let claim = || LogFolder::claim_new(&path).unwrap();
        let claimed = std::thread::scope(|scope| {
            let threads = (0..8).map(|_| Builder::new().spawn_scoped(scope, claim).unwrap()).collect::<Vec<_>>();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
        });
        let mut paths = claimed.iter().map(|folder| folder.path().to_owned()).collect::<Vec<_>>();
        paths.sort();
        assert_eq!(paths, (1..=8).map(|number| within.path().join(format!("log-{number}"))).collect::<Vec<_>>());
    }

    #[test]
    fn runs_that_begin_and_end_at_once_never_share() {
        let within = tempfile::tempdir().unwrap();
        let inside = std::sync::atomic::AtomicUsize::new(0);
        let claim = || {
            for _ in 0..200 {
                if let Ok(_folder) = LogFolder::claim(within.path()) {
                    assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                    inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                }
            }
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(Builder::new().spawn_scoped(scope, claim).unwrap())));
    }

    #[cfg(unix)]
    #[test]
    fn a_lock_is_never_written_through_a_link() {
        let within = tempfile::tempdir().unwrap();
        let mine = within.path().join("mine");
        fs::write(&mine, "mine").unwrap();
        std::os::unix::fs::symlink(&mine, within.path().join(LOCK)).unwrap();
        assert!(LogFolder::claim(within.path()).is_err());
        assert_eq!(fs::read_to_string(&mine).unwrap(), "mine");
    }
}
