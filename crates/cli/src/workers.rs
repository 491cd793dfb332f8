//! The workers that do the runs of a sweep.

use std::path::Path;

use clap::Args;

use closecall::util::threads::processors;
use closecall_analysis::batch::sweep::Task;
use closecall_run::Result;

/// Which workers do the runs.
#[derive(Args)]
pub(crate) struct WorkersArgs {
    /// Runs at the same time on this machine [default: one per processor].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    workers: Option<u16>,
    /// Address of a Dask scheduler whose workers do the runs instead of this machine.
    #[arg(long, value_name = "ADDRESS", conflicts_with = "workers")]
    scheduler: Option<String>,
}

impl WorkersArgs {
    /// The workers that were asked for.
    pub fn workers(&self) -> Workers {
        match &self.scheduler {
            Some(address) => Workers::Scheduler(address.clone()),
            None => Workers::Local(self.workers.map_or_else(processors, usize::from)),
        }
    }
}

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
