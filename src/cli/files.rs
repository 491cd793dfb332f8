//! Paths that commands share.

use std::path::{Path, PathBuf};

use crate::options::Options;
use crate::{Error, Result};

/// The files of a run's own that none besides its log may be written over; SUMO's are known once it has started.
pub(super) fn kept(config: Option<PathBuf>, options: &Options, out: &Path) -> Vec<PathBuf> {
    config.into_iter().chain(options.filter.clone()).chain(crate::output::log::files(out)).collect()
}

/// Runs in processes of their own have working directories of their own.
pub(super) fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|source| Error::file(path, source))
}
