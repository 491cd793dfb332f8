//! `run.json`: how a run was made, and the counts of what it found.

use std::path::PathBuf;

use serde::Serialize;

use super::input_hash::Input;
use super::summary::Summary;
use crate::options::RunOptions;
use closecall::util::units::Second;

/// How a run was made and what it found.
#[derive(Clone, Debug, Serialize)]
pub struct RunRecord {
    /// Versions of closecall and SUMO.
    pub versions: Versions,
    /// The SUMO configuration, or the recording that was replayed.
    pub scenario: PathBuf,
    /// SUMO's random seed; none for a replay, and where SUMO chose one that it does not report (its option random).
    pub seed: Option<String>,
    /// Length of a step, in s: SUMO's, or the time between a recording's first two steps.
    pub step_length: Option<Second>,
    /// Whether road users may move sideways without changing lanes (SUMO's sublane model).
    pub sublane: bool,
    /// Whether road users were moved back by half a step, to the moment to which their speeds belong.
    pub aligned: bool,
    /// The options.
    pub options: RunOptions,
    /// SUMO's command line, without the program's name.
    pub sumo_words: Vec<String>,
    /// Input files with their hashes.
    pub inputs: Vec<Input>,
    /// Whether the run reached its end.
    pub complete: bool,
    /// Why it did not reach its end.
    pub error: Option<String>,
    /// The SHA-256 of `conflicts.csv`; none while the run goes on.
    pub conflicts_sha256: Option<String>,
    /// The number of clips in `clips.jsonl.gz`; none while the run goes on.
    pub clips: Option<u64>,
    /// Whether texts that spreadsheets would run as formulas begin with an apostrophe in the CSV files.
    pub csv_safe: bool,
    /// What it found.
    pub summary: Summary,
}

impl RunRecord {
    /// The record of a run that begins, without SUMO and without inputs.
    pub fn new(scenario: PathBuf, options: RunOptions) -> Self {
        Self {
            versions: Versions::with_sumo(None),
            scenario,
            seed: None,
            step_length: None,
            sublane: false,
            aligned: false,
            options,
            sumo_words: Vec::new(),
            inputs: Vec::new(),
            complete: false,
            error: None,
            conflicts_sha256: None,
            clips: None,
            csv_safe: false,
            summary: Summary::default(),
        }
    }
}

/// The versions that a run was made with.
#[derive(Clone, Debug, Serialize)]
pub struct Versions {
    /// closecall's.
    pub closecall: &'static str,
    /// SUMO's; none for a replay.
    pub sumo: Option<String>,
}

impl Versions {
    /// This closecall with this version of SUMO.
    pub fn with_sumo(sumo: Option<String>) -> Self {
        Self { closecall: env!("CARGO_PKG_VERSION"), sumo }
    }
}

#[cfg(test)]
mod tests {
    use closecall::util::remark::{Remark, RemarkCode};
    use strum::VariantArray;

    #[test]
    fn the_codes_of_remarks_are_documented() {
        let page = include_str!("../../../../docs/log.md");
        // A later version's code is not known, and the place of an earlier log is only printed.
        let written = |code: &&RemarkCode| !matches!(code, RemarkCode::Other | RemarkCode::EarlierLog);
        for code in RemarkCode::VARIANTS.iter().filter(written) {
            assert!(page.contains(&format!("`{}`", code.name())), "{code:?}");
        }
    }

    #[test]
    fn the_remark_of_a_later_version_is_read() {
        let read = serde_json::from_str::<Remark>(r#"{"code": "not_yet_known", "text": "a"}"#).unwrap();
        assert_eq!(read, Remark::new(RemarkCode::Other, "a"));
        for code in RemarkCode::VARIANTS {
            assert_eq!(serde_json::to_value(code).unwrap(), code.name());
        }
    }
}
