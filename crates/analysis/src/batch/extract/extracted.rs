//! What was cut out, and its folder: new, and whole or not there.

use std::fs;
use std::path::Path;

use crate::logged::LoggedConflict;
use crate::{Error, Result};
use closecall_run::util::output_file::{self, folder_of};

/// What was cut out.
#[derive(Debug)]
pub struct Extracted {
    /// The conflict.
    pub conflict: LoggedConflict,
    /// What the user should know about it.
    pub remark: Option<String>,
}

/// Fills a folder that must be new or empty, whole or not at all. `make` gets the folder to fill, which is then renamed, and
/// one for what is not kept.
pub fn fill<T>(out: &Path, make: impl FnOnce(&Path, &Path) -> Result<T>) -> Result<T> {
    check_is_new(out)?;
    let within = folder_of(out);
    fs::create_dir_all(within).map_err(|source| Error::file(within, source))?;
    let draft = tempfile::Builder::new().prefix(".closecall-").tempdir_in(within);
    let draft = draft.map_err(|source| Error::file(within, source))?;
    let place = draft.path().join("scenario");
    fs::create_dir(&place).map_err(|source| Error::file(&place, source))?;
    let made = make(&place, draft.path())?;
    if out.exists() {
        fs::remove_dir(out).map_err(|source| Error::file(out, source))?;
    }
    fs::rename(&place, out).map_err(|source| Error::file(out, source))?;
    output_file::sync_folder(within);
    Ok(made)
}

fn check_is_new(out: &Path) -> Result<()> {
    match fs::read_dir(out).map(|mut entries| entries.next().is_some()) {
        Ok(true) => Err(Error::content(out, "it is not empty; a cut-out needs a folder of its own")),
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::file(out, error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_empty_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        check_is_new(folder.path()).unwrap();
        check_is_new(&folder.path().join("new")).unwrap();
        fs::write(folder.path().join("a"), "").unwrap();
        assert!(check_is_new(folder.path()).unwrap_err().to_string().contains("it is not empty"));
        assert!(matches!(check_is_new(&folder.path().join("a")), Err(Error::Run(closecall_run::Error::File { .. }))));
    }
}
