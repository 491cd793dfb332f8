//! Files in the formats of other tools: written next to the log (SUMO's SSM device, FHWA's SSAM), or exported from it (these,
//! maps, sumo-gui).

mod asam;
mod exported;
mod geojson;
mod geoparquet;
mod gpkg;
mod map_point;
mod poi;
mod ssm;
mod trajectories;

use std::path::{Path, PathBuf};

use super::input_hash::Input;
use crate::util::output_file::same_file;
use crate::{Error, Result};
pub use asam::{Scenario, scenario, trace};
use closecall::events::Conflict;
use closecall::traffic::frame::Frame;
use closecall::traffic::net::Net;
use closecall::traffic::placement::Placement;
use closecall::traffic::roster::{Roster, UserIndex};
pub use exported::{ExportFormat, Exported};
use ssm::Ssm;
use trajectories::Trajectories;
pub use trajectories::{FAR, origin as origin_of_trajectories};

/// Which files to write besides the log, and what becomes of an earlier log.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
#[command(next_help_heading = "Output")]
pub struct OutputFiles {
    /// Format of the conflicts in the log. Parquet replaces conflicts.csv when the run has ended.
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t)]
    pub log_format: LogFormat,
    /// Write each conflict that counts once in the format of SUMO's SSM device.
    #[arg(long, value_name = "FILE")]
    pub ssm_output: Option<PathBuf>,
    /// Write the trajectories of all vehicles in SSAM's format (.trj, version 3).
    #[arg(long, value_name = "FILE")]
    pub trj_output: Option<PathBuf>,
    /// Replace an earlier log in the folder, instead of moving it to the folder's own folder earlier.
    #[arg(long)]
    pub force: bool,
    /// Begin ids that a spreadsheet would run as formulas (=, +, -, @) with an apostrophe.
    #[arg(long)]
    pub csv_safe: bool,
}

/// The format of the conflicts in a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum LogFormat {
    /// conflicts.csv.
    #[default]
    Csv,
    /// conflicts.parquet, with run.json in it.
    Parquet,
}

impl OutputFiles {
    /// The options that name a file to be written.
    pub const OPTIONS: [&str; 2] = ["--ssm-output", "--trj-output"];

    /// The files to be written besides the log, each with its option.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let files = [&self.ssm_output, &self.trj_output];
        Self::OPTIONS.into_iter().zip(files).filter_map(|(option, file)| Some((option, file.as_deref()?)))
    }

    /// Checks that writing them overwrites none of the files to be kept.
    ///
    /// # Errors
    /// [`Error::Value`] if one would overwrite another or one of those.
    pub fn check<P: AsRef<Path>>(&self, kept: &[P]) -> Result<()> {
        let [ssm, trajectories] = [&self.ssm_output, &self.trj_output];
        let refused =
            |option: &str, over: &Path| Err(Error::Value(format!("{option} would be written over {}", over.display())));
        for (option, path) in self.files() {
            if let Some(over) = same_file(path, kept.iter().map(P::as_ref)) {
                return refused(option, over);
            }
        }
        match (ssm, trajectories) {
            (Some(ssm), Some(trajectories)) if same_file(ssm, [&**trajectories]).is_some() => {
                refused("--ssm-output", trajectories)
            }
            _ => Ok(()),
        }
    }
}

/// The files of a run besides its log; the default has none. Until they are complete there is nothing under their names.
#[derive(Debug, Default)]
pub(crate) struct Outputs {
    ssm: Option<Ssm>,
    trajectories: Option<Trajectories>,
    counts_artefacts: bool,
}

impl Outputs {
    /// Begins the files; conflicts with an artefact are among the others only where they count.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written; [`Error::Value`] if trajectories are wanted without a net, or if a
    /// file would overwrite another or one of the run's inputs.
    pub fn create(files: &OutputFiles, net: Option<&Net>, inputs: &[Input], counts_artefacts: bool) -> Result<Self> {
        files.check(&inputs.iter().map(|input| &input.path).collect::<Vec<_>>())?;
        let trajectories = match (&files.trj_output, net) {
            (Some(path), Some(net)) => Some(Trajectories::create(path, net)?),
            (Some(_), None) => return Err(Error::Value("--trj-output needs a net".to_owned())),
            (None, _) => None,
        };
        let ssm = files.ssm_output.as_deref().map(Ssm::create).transpose()?;
        Ok(Self { ssm, trajectories, counts_artefacts })
    }

    /// Whether any of them reports the vehicles' lanes.
    pub(crate) fn want_lanes(&self) -> bool {
        self.trajectories.is_some()
    }

    /// Notes where on the net the road user of a row is.
    pub(crate) fn place(&mut self, row: u32, placement: &Placement) {
        if let Some(trajectories) = &mut self.trajectories {
            trajectories.place(row, placement.lane);
        }
    }

    /// Writes the road users of a step.
    pub(crate) fn write_step(&mut self, frame: &Frame, roster: &Roster, net: Option<&Net>) -> Result<()> {
        match (&mut self.trajectories, net) {
            (Some(trajectories), Some(net)) => trajectories.write_step(frame, roster, net),
            _ => Ok(()),
        }
    }

    /// Forgets a road user that has left the scene.
    pub(crate) fn forget(&mut self, user: UserIndex) {
        if let Some(trajectories) = &mut self.trajectories {
            trajectories.forget(user);
        }
    }

    /// Writes conflicts that have closed.
    pub(crate) fn write_conflicts(&mut self, closed: &[Conflict]) -> Result<()> {
        let Some(ssm) = &mut self.ssm else { return Ok(()) };
        let mut counting = closed.iter().filter(|conflict| conflict.artefact.is_none() || self.counts_artefacts);
        counting.try_for_each(|conflict| ssm.write_conflict(conflict))
    }

    /// Completes the files.
    pub(crate) fn finish(&mut self) -> Result<()> {
        self.ssm.take().map_or(Ok(()), Ssm::finish)?;
        self.trajectories.take().map_or(Ok(()), Trajectories::finish)
    }
}
