//! The workers that do the runs of a sweep.

use std::path::Path;

use closecall_analysis::batch::sweep::Task;
use closecall_run::Result;

/// The workers that do the runs of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Workers {
    /// This number of processes on this machine.
    Local(usize),
    /// The workers of the Dask scheduler at this address.
    Scheduler(String),
}

impl Workers {
    /// The number of runs at the same time, if it is known.
    pub(crate) fn at_once(&self) -> usize {
        match self {
            Self::Local(processes) => *processes,
            Self::Scheduler(_) => 1,
        }
    }
}

/// Takes the name of a task that has ended and, if it failed, why.
pub type ReportEnd<'a> = dyn FnMut(&str, Option<&str>) + 'a;

/// Does the tasks in a working folder and reports the end of each.
pub type Distribute<'a> = dyn FnMut(&Workers, &Path, &[&Task], &mut ReportEnd) -> Result<()> + 'a;
