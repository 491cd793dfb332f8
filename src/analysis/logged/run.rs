//! `run.json`, read back.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::folders::PARQUET;
use super::parquet::Packed;
use crate::output::input_hash::Input;
use crate::output::log::RUN;
use crate::output::summary::Summary;
use crate::util::units::Second;
use crate::{Error, Result};

/// How a run was made: the part of `run.json` that statistics need.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct LoggedRun {
    /// Versions of what took part.
    pub versions: LoggedVersions,
    /// The SUMO configuration, or the recording that was replayed.
    pub scenario: PathBuf,
    /// SUMO's random seed; none where nothing was simulated, or SUMO chose one itself (its option random).
    pub seed: Option<String>,
    /// Length of a step in s.
    pub step_length: Option<Second>,
    /// Words for SUMO, after the program's name.
    pub sumo_words: Vec<String>,
    /// Input files with their hashes.
    pub inputs: Vec<Input>,
    /// The detector's options.
    pub options: serde_json::Value,
    /// Whether the run reached its end.
    pub complete: bool,
    /// What it found.
    pub summary: Summary,
}

/// Versions of what took part in a run.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct LoggedVersions {
    /// closecall's.
    pub closecall: String,
    /// SUMO's; none where nothing was simulated.
    pub sumo: Option<String>,
}

/// The text of a log folder's `run.json`, and the file that holds it: `run.json` itself or `conflicts.parquet`.
///
/// # Errors
/// [`Error::File`] where neither is there; [`Error::Content`] where the Parquet file has none or cannot be read.
pub fn record(folder: &Path) -> Result<(PathBuf, String)> {
    let own = folder.join(RUN);
    let packed = folder.join(PARQUET);
    if own.exists() || !packed.exists() {
        let text = std::fs::read_to_string(&own).map_err(|source| Error::file(&own, source))?;
        return Ok((own, text));
    }
    let record = Packed::record_of(&packed)?;
    Ok((packed, record))
}

impl LoggedRun {
    /// Reads the [`fn@record`] of a log folder.
    ///
    /// # Errors
    /// [`Error::File`] or [`Error::Line`] where it is missing or closecall did not write it.
    pub fn read(folder: &Path) -> Result<Self> {
        let (path, text) = record(folder)?;
        serde_json::from_str(&text).map_err(|error| Error::line(&path, error.line() as u64, error.to_string()))
    }

    /// Simulated hours from the first to the last step.
    pub fn hours(&self) -> f64 {
        (self.summary.end - self.summary.begin) / 3600.0
    }
}
