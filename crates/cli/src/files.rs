//! Paths that several commands handle.

use std::path::{Path, PathBuf};

use super::error::Result;
use super::print::print;
use closecall_run::Error;
use closecall_run::RunOptions;

/// The run's own files, which its other outputs must not overwrite. SUMO's files are known only once it has started.
pub(super) fn kept(config: Option<&Path>, options: &RunOptions, out: &Path) -> Vec<PathBuf> {
    config
        .map(Path::to_owned)
        .into_iter()
        .chain(options.log.filter.clone())
        .chain(closecall_run::output::log::files(out))
        .collect()
}

/// The default folder for results: beside the input, or in the working directory where that cannot be written.
pub(super) fn default_folder(input: &Path, name: &str) -> PathBuf {
    let beside = beside(input, name);
    let here = PathBuf::from(name);
    if !can_be_written(&beside) && can_be_written(&here) { here } else { beside }
}

/// Says why the default folder is not beside the input, if it is not.
pub(super) fn print_if_elsewhere(folder: &Path, input: &Path, name: &str) -> Result<()> {
    let beside = beside(input, name);
    if folder == beside {
        return Ok(());
    }
    print(format_args!("{} cannot be written, so the results are in the working directory\n", beside.display()))
}

fn beside(input: &Path, name: &str) -> PathBuf {
    input.parent().unwrap_or(Path::new("")).join(name)
}

/// Whether a folder, which need not exist yet, can be written.
fn can_be_written(folder: &Path) -> bool {
    let there = folder.ancestors().find(|part| part.as_os_str().is_empty() || part.exists());
    let there = there.filter(|part| !part.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // A file without a name leaves no trace.
    tempfile::tempfile_in(there).is_ok()
}

/// A path that other processes can use: their working directories may differ.
pub(super) fn absolute(path: &Path) -> Result<PathBuf> {
    Ok(std::path::absolute(path).map_err(|source| Error::file(path, source))?)
}
