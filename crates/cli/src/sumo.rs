//! The interface between the commands that run SUMO and the bridge that can.

use std::ffi::OsString;
use std::path::PathBuf;

use super::error;
use super::print::value;
use closecall::detection::kind::Severity;
use closecall_run::Result;
use closecall_run::RunOptions;
use closecall_run::output::folder::LogFolder;
use closecall_run::output::formats::OutputFiles;
use closecall_run::output::summary::Summary;
use closecall_run::run::roll_out::RollOut;

use super::workers::Distribute;

pub use closecall_analysis::batch::extract::{ConvertNet, SaveConfiguration};

/// What the bridge offers the commands that run SUMO.
pub struct Sumo<'a> {
    /// Runs a simulation in this process.
    pub simulate: &'a mut Simulate<'a>,
    /// Shows a clip in sumo-gui.
    pub show: &'a mut dyn FnMut(&ShowRequest) -> Result<()>,
    /// Makes a film of pictures: the file's bytes.
    pub film: &'a mut dyn FnMut(&FilmRequest) -> Result<Vec<u8>>,
    /// Saves SUMO's options, as these words and the configuration that they name set them, in a configuration of their own.
    pub save_configuration: &'a mut SaveConfiguration<'a>,
    /// Writes the part of a net that is within bounds as OpenDRIVE.
    pub convert_net: &'a mut ConvertNet<'a>,
    /// Distributes the runs of a sweep to workers.
    pub distribute: &'a mut Distribute<'a>,
    /// The command line that starts closecall in a separate process, without arguments. The process ends when its standard
    /// input closes.
    pub closecall: Vec<OsString>,
    /// Whether the user has interrupted the command. Until the first call, an interrupt ends the process at once.
    pub interrupted: &'a mut dyn FnMut() -> bool,
}

/// The error of a binary without Python.
pub(super) fn no_sumo() -> error::Result<()> {
    Err(value("this binary was built without Python and cannot run SUMO; `pip install closecall` gives one that can"))
}

/// A run of SUMO that was asked for.
#[derive(Clone, Debug)]
pub struct RunRequest {
    /// The SUMO configuration file.
    pub scenario: PathBuf,
    /// How to show the run in sumo-gui; none if not at all.
    pub gui: Option<GuiRequest>,
    /// Folder for the log.
    pub out: PathBuf,
    /// Threads, SUMO's own included. The number does not change the results.
    pub threads: u8,
    /// Whether to print only errors.
    pub quiet: bool,
    /// Files to write besides the log.
    pub outputs: OutputFiles,
    /// The detector's options.
    pub options: RunOptions,
    /// Words for SUMO, after the program's name.
    pub sumo_words: Vec<String>,
    /// What drivers do wrong, if this is a roll-out of `closecall whatif`.
    pub roll_out: Option<RollOut>,
}

/// How to show a run in sumo-gui.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GuiRequest {
    /// Whether to write the kind and the time left beside each conflict.
    pub label: bool,
    /// Whether to close sumo-gui at the end.
    pub quit_on_end: bool,
    /// Halt at each conflict that becomes this severe.
    pub pause_at: Option<Severity>,
}

/// A clip that is to be shown in sumo-gui.
#[derive(Clone, Debug)]
pub struct ShowRequest {
    /// The net, the clip and the conflict as JSON (`analysis::playback::Show`).
    pub scene: String,
    /// Whether to write the kind and the time left beside the conflict.
    pub label: bool,
    /// Whether to close sumo-gui at the end, and not to halt before.
    pub quit_on_end: bool,
}

/// A film to be made from pictures.
#[derive(Clone, Debug)]
pub struct FilmRequest {
    /// Its pictures as SVGs, in their order.
    pub pictures: Vec<String>,
    /// Pictures a second.
    pub rate: u32,
    /// The format's name, which is also the file's extension.
    pub format: &'static str,
    /// The font of the pictures' texts, as the bytes of its file.
    pub font: &'static [u8],
}

/// Runs SUMO with the checker attached; the folder is the request's, for this run alone.
pub type Simulate<'a> = dyn FnMut(&RunRequest, LogFolder) -> Result<Summary> + 'a;
