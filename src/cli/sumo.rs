//! What the commands that run SUMO ask of the bridge, which knows SUMO.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::say::value;
use crate::Result;
use crate::batch::sweep::Task;
use crate::options::Options;
use crate::output::formats::OutputFiles;
use crate::output::summary::Summary;

/// What the commands that run SUMO need of whoever knows it.
pub struct Sumo<'a> {
    /// Runs a simulation in this process.
    pub simulate: &'a mut Simulate<'a>,
    /// Has the runs of a sweep done.
    pub distribute: &'a mut Distribute<'a>,
    /// The command line that starts closecall in a process of its own, without arguments; it ends when its standard input
    /// does.
    pub closecall: Vec<OsString>,
    /// Whether the user has asked to stop; who never asked is ended at once.
    pub interrupted: &'a mut dyn FnMut() -> bool,
}

/// What the command returns where SUMO is not at hand.
pub(super) fn no_sumo() -> Result<()> {
    Err(value("this binary was built without Python and cannot run SUMO; `pip install closecall` gives one that can"))
}

/// What `closecall run` was asked to do.
#[derive(Clone, Debug)]
pub struct RunRequest {
    /// The SUMO configuration file.
    pub scenario: PathBuf,
    /// Whether to show the run in sumo-gui.
    pub gui: bool,
    /// Folder of the log.
    pub out: PathBuf,
    /// How many threads to use, SUMO's own included: the results are the same.
    pub threads: u8,
    /// Whether to print nothing but errors.
    pub quiet: bool,
    /// Files to write besides the log.
    pub outputs: OutputFiles,
    /// The detector's options.
    pub options: Options,
    /// Words for SUMO, after the program's name.
    pub sumo_words: Vec<String>,
}

/// Runs SUMO with the checker attached.
pub type Simulate<'a> = dyn FnMut(&RunRequest) -> Result<Summary> + 'a;

/// Who does the runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Workers {
    /// So many processes of this machine.
    Local(usize),
    /// Those of the Dask scheduler at this address.
    Scheduler(String),
}

/// Takes the name of a task that has ended, and why it failed if it did.
pub type Ended<'a> = dyn FnMut(&str, Option<&str>) + 'a;

/// Does the tasks, in a working folder, and tells of each one's end.
pub type Distribute<'a> = dyn FnMut(&Workers, &Path, &[&Task], &mut Ended) -> Result<()> + 'a;
