//! One run of a sweep, and its file in the data set.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::logged::{self, Label, LoggedRun, PARQUET, Packed, RunTime};
use crate::{Error, Result};
use closecall_run::options::SERIES_FILES;
use closecall_run::output::clips::CLIPS;
use closecall_run::run::roll_out::ROLL_OUT;
use closecall_run::util::output_file::check_is_no_link;

/// The folder of the data set in a sweep's folder.
pub(super) const CONFLICTS: &str = "conflicts";

/// The prefix of a run's folder in the data set, as is usual for partitions.
pub(super) const RUN: &str = "run=";

/// One run of a sweep; serialised to JSON for the worker that runs it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Its name, from the varied options and the seed.
    pub name: String,
    /// The words of `closecall run`, without `--out`.
    pub args: Vec<String>,
    /// The sweep's folder.
    pub out: PathBuf,
    /// The columns that distinguish it from the other runs.
    pub(super) labels: Vec<Label>,
    /// The hash of everything that defines the run.
    pub(super) fingerprint: String,
}

impl Task {
    /// Adds the run's log to the data set; its series and its clips, if there are any, go to a folder beside it.
    ///
    /// # Errors
    /// [`Error::content`] if the run did not reach its end; those of [`logged::pack`].
    pub fn finish(&self, log: &Path, run_time: RunTime) -> Result<()> {
        if !LoggedRun::read(log)?.complete {
            return Err(Error::content(log, "the run did not reach its end"));
        }
        let folder = self.beside();
        let fault = |source| Error::file(&folder, source);
        let written_into = [self.out.join("series"), folder.clone(), data_set(&self.out), self.log()];
        written_into.iter().try_for_each(|folder| check_is_no_link(folder))?;
        if folder.exists() {
            // The series of the run that this one replaces.
            fs::remove_dir_all(&folder).map_err(fault)?;
        }
        for name in SERIES_FILES.into_iter().chain([CLIPS, ROLL_OUT]).filter(|name| log.join(name).is_file()) {
            fs::create_dir_all(&folder).map_err(fault)?;
            fs::rename(log.join(name), folder.join(name)).map_err(fault)?;
        }
        logged::pack(log, &self.labels, &self.fingerprint, run_time, &self.file())
    }

    /// The folder of its series, its clips and what came of its roll-out.
    pub fn beside(&self) -> PathBuf {
        series_of(&self.out, &self.name)
    }

    /// The folder of its file in the data set, which is a log once the run is done.
    pub fn log(&self) -> PathBuf {
        log_of(&self.out, &self.name)
    }

    /// The processor time of its run, in s; 0 before it has ended.
    pub fn processor_time(&self) -> f64 {
        Packed::of(&self.file()).map_or(0.0, |packed| packed.run_time.map_or(0.0, |time| time.cpu))
    }

    /// Its file in the data set.
    pub fn file(&self) -> PathBuf {
        self.log().join(PARQUET)
    }
}

/// The folder of a run's file in a sweep's folder.
pub(in crate::batch) fn log_of(out: &Path, name: &str) -> PathBuf {
    data_set(out).join(format!("{RUN}{name}"))
}

/// The folder of a run's series, its clips and what came of its roll-out.
pub(in crate::batch) fn series_of(out: &Path, name: &str) -> PathBuf {
    out.join("series").join(format!("{RUN}{name}"))
}

/// The folder of the data set in a sweep's folder.
pub(super) fn data_set(out: &Path) -> PathBuf {
    out.join(CONFLICTS)
}
