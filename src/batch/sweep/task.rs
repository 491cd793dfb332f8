//! One run of a sweep, and the file that it becomes.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::analysis::logged::{self, Label, LoggedRun, PARQUET};
use crate::output::log::ENCOUNTERS;
use crate::{Error, Result};

/// The folder of the data set in a sweep's folder.
pub(super) const CONFLICTS: &str = "conflicts";

/// What the folder of a run in it begins with, as partitions of a data set do.
pub(super) const RUN: &str = "run=";

/// One run of a sweep; as JSON it travels to whoever does it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Its name: what was varied, and the seed.
    pub name: String,
    /// The words of `closecall run`, without those that say where the log goes.
    pub words: Vec<String>,
    /// The sweep's folder.
    pub out: PathBuf,
    /// What tells it from the other runs, as columns.
    pub(super) labels: Vec<Label>,
    /// The hash of what was asked for.
    pub(super) fingerprint: String,
}

impl Task {
    /// Makes the run's log a part of the data set; encounters, where there are any, come to lie beside it.
    ///
    /// # Errors
    /// [`Error::Content`] where the run did not come to its end; those of [`logged::pack`].
    pub fn finish(&self, log: &Path) -> Result<()> {
        if !LoggedRun::read(log)?.complete {
            return Err(Error::content(log, "the run did not come to its end"));
        }
        let encounters = log.join(ENCOUNTERS);
        let folder = self.out.join("encounters").join(format!("{RUN}{}", self.name));
        let fault = |source| Error::file(&folder, source);
        if folder.exists() {
            // Those of the run that this one takes the place of.
            fs::remove_dir_all(&folder).map_err(fault)?;
        }
        if encounters.is_file() {
            fs::create_dir_all(&folder).map_err(fault)?;
            fs::rename(encounters, folder.join(ENCOUNTERS)).map_err(fault)?;
        }
        logged::pack(log, &self.labels, &self.fingerprint, &self.file())
    }

    /// The file that it becomes.
    pub(super) fn file(&self) -> PathBuf {
        data_set(&self.out).join(format!("{RUN}{}", self.name)).join(PARQUET)
    }
}

/// The folder of the data set in a sweep's folder.
pub(super) fn data_set(out: &Path) -> PathBuf {
    out.join(CONFLICTS)
}
