//! Paths that several commands handle.

use std::path::{Path, PathBuf};

use crate::options::Options;
use crate::{Error, Result};

/// The run's own files, which its other outputs must not overwrite. SUMO's files are known only once it has started.
pub(super) fn kept(config: Option<&Path>, options: &Options, out: &Path) -> Vec<PathBuf> {
    config.map(Path::to_owned).into_iter().chain(options.filter.clone()).chain(crate::output::log::files(out)).collect()
}

/// A path that other processes can use: their working directories may differ.
pub(super) fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|source| Error::file(path, source))
}
