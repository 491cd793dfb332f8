//! `run.json`: how a run was made and what it found, in counts.

use std::path::PathBuf;

use serde::Serialize;

use super::input_hash::Input;
use super::summary::Summary;
use crate::options::Options;
use crate::util::units::Second;

/// How a run was made and what it found.
#[derive(Clone, Debug, Serialize)]
pub struct RunRecord {
    /// Versions of what took part.
    pub versions: Versions,
    /// The SUMO configuration, or the recording that was replayed.
    pub scenario: PathBuf,
    /// SUMO's random seed; none where nothing was simulated, or SUMO chose one that it does not tell (its option random).
    pub seed: Option<String>,
    /// Length of a step in s.
    pub step_length: Option<Second>,
    /// Whether road users may move to the side without changing lanes (SUMO's sublane model).
    pub sublane: bool,
    /// The options.
    pub options: Options,
    /// Words for SUMO, after the program's name.
    pub sumo_words: Vec<String>,
    /// Input files with their hashes.
    pub inputs: Vec<Input>,
    /// Whether the run came to its end.
    pub complete: bool,
    /// Why it did not.
    pub error: Option<String>,
    /// What it found.
    pub summary: Summary,
}

/// Versions of what took part in a run.
#[derive(Clone, Debug, Serialize)]
pub struct Versions {
    /// closecall's.
    pub closecall: &'static str,
    /// SUMO's; none where nothing was simulated.
    pub sumo: Option<String>,
}

impl Versions {
    /// This closecall and that SUMO.
    pub fn with_sumo(sumo: Option<String>) -> Self {
        Self { closecall: env!("CARGO_PKG_VERSION"), sumo }
    }
}
