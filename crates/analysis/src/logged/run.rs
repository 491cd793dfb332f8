//! `run.json`, read back.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::folders::PARQUET;
use super::packed::Packed;
use crate::{Error, Result};
use closecall::util::limits::{DURATION, TIME};
use closecall::util::units::Second;
use closecall_run::output::input_hash::Input;
use closecall_run::output::log::RUN;
use closecall_run::output::schema::LoggedConflict;
use closecall_run::output::summary::Summary;
use closecall_run::util::input_file;

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
    /// The SHA-256 of its `conflicts.csv`; none in the logs of earlier versions, and where the run was killed.
    #[serde(default)]
    pub conflicts_sha256: Option<String>,
    /// Whether texts that spreadsheets would run as formulas begin with an apostrophe.
    #[serde(default)]
    pub csv_safe: bool,
    /// What it found.
    pub summary: Summary,
    /// Whether its risk index has the name of earlier versions, `expected_crashes`.
    #[serde(skip)]
    pub has_old_names: bool,
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
/// [`Error::file`] where neither is there; [`Error::content`] where the Parquet file has none or cannot be read.
pub fn record(folder: &Path) -> Result<(PathBuf, String)> {
    let own = folder.join(RUN);
    let packed = folder.join(PARQUET);
    if own.exists() || !packed.exists() {
        let text = input_file::text(&own)?;
        return Ok((own, text));
    }
    let record = Packed::record_of(&packed)?;
    Ok((packed, record))
}

impl LoggedRun {
    /// Reads the [`fn@record`] of a log folder.
    ///
    /// # Errors
    /// [`Error::file`] or [`Error::line`] where it is missing or closecall did not write it.
    pub fn read(folder: &Path) -> Result<Self> {
        let (path, text) = record(folder)?;
        Self::parse(&path, &text)
    }

    /// Reads the text of a `run.json`; `path` names it in errors.
    ///
    /// # Errors
    /// [`Error::line`] or [`Error::content`] where closecall did not write it.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let mut run: Self = serde_json::from_str(text)
            .map_err(|error| Error::line(path, error.line() as u64, error.to_string().replace('\n', " ")))?;
        run.check().map_err(|why| Error::content(path, why))?;
        run.has_old_names = text.contains("\"expected_crashes\"");
        Ok(run)
    }

    fn check(&self) -> std::result::Result<(), String> {
        let Summary { begin, end, .. } = self.summary;
        TIME.check("begin", begin)?;
        TIME.check("end", end)?;
        DURATION.check("step_length", self.step_length.unwrap_or_default())?;
        if begin > end { Err(format!("its end, {end} s, is before its begin, {begin} s")) } else { Ok(()) }
    }

    /// The scenario's name: that of its file, without what follows the first dot.
    pub fn name(&self) -> String {
        let file = self.scenario.file_name().unwrap_or_default().to_string_lossy();
        file.split('.').find(|part| !part.is_empty()).unwrap_or("closecall").to_owned()
    }

    /// Whether it logs only conflicts in the sense of margin < 0: unless its options name another condition.
    pub(crate) fn logs_margins_below_zero(&self) -> bool {
        matches!(self.options.get("log").and_then(serde_json::Value::as_str), None | Some("margin < 0" | "paper"))
    }

    /// The number of conflicts in its log.
    pub fn conflicts(&self) -> u64 {
        self.summary.logged()
    }

    /// Whether one of its conflicts is none of traffic's, and it did not count that.
    pub(crate) fn sets_aside(&self, conflict: &LoggedConflict) -> bool {
        let counts_all = self.options.get("artefacts").and_then(serde_json::Value::as_bool).unwrap_or_default();
        !conflict.artefact.is_empty() && !counts_all
    }

    /// Simulated hours: from the first step to the end of the last, which lasts as long as the others.
    pub fn hours(&self) -> f64 {
        (self.summary.end - self.summary.begin + self.step_length.unwrap_or_default()) / 3600.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::options::Options;
    use closecall::traffic::frame::State;
    use closecall::traffic::profile::Profile;
    use closecall::traffic::sumo_type::SumoType;
    use closecall_run::output::folder::LogFolder;
    use closecall_run::output::formats::OutputFiles;
    use closecall_run::output::record::RunRecord;
    use closecall_run::run::Run;
    use closecall_run::run::recorded::{Ending, RecordedRun};

    #[test]
    fn the_risk_index_is_read_by_its_old_name_too() {
        for (name, is_old) in [("risk_index", false), ("expected_crashes", true)] {
            let summary = format!(
                r#"{{"begin": 0, "end": 1, "steps": 2, "conflicts": [], "collisions": 0, "{name}": 4.5, "exposure":
                {{"vehicles": 1, "persons": 0, "vehicle_kilometres": 1, "vehicle_hours": 1}}}}"#
            );
            let text = format!(
                r#"{{"versions": {{"closecall": "0.1.0", "sumo": null}}, "scenario": "a", "seed": null, "step_length": 1,
                "sumo_words": [], "inputs": [], "options": {{}}, "complete": true, "summary": {summary}}}"#
            );
            let run = LoggedRun::parse(Path::new("run.json"), &text).unwrap();
            assert_eq!((run.summary.risk_index, run.has_old_names), (4.5, is_old));
        }
    }

    /// A run of a car at 10 m/s with a step at each of these times, read back.
    fn logged(times: &[Second], step_length: Option<Second>) -> LoggedRun {
        let folder = tempfile::tempdir().unwrap();
        let options = Options::default();
        let record = RunRecord { step_length, ..RunRecord::new(PathBuf::new(), options.clone().into()) };
        let run = Run::new(&options.clone().into(), None).unwrap();
        let mut recorded =
            RecordedRun::open(run, record, LogFolder::claim(folder.path()).unwrap(), &OutputFiles::default()).unwrap();
        let run = &mut recorded.run;
        let profile = run.roster.profile(Profile::vehicle(&SumoType::car("car"), &options)).unwrap();
        let car = run.enter("car", profile);
        for time in times {
            run.begin_step(*time);
            run.frame.push(car, State { x: 10.0 * time, y: 0.0, z: 0.0, heading: 0.0, speed: 10.0 });
            run.step(|_, _| Ok::<_, Error>(())).unwrap();
        }
        recorded.close(Ending::default()).unwrap();
        LoggedRun::read(folder.path()).unwrap()
    }

    #[test]
    fn every_step_counts_in_full_the_last_included() {
        for (times, step_length, seconds) in
            [(&[2.0, 2.5, 3.0, 3.5][..], None, 2.0), (&[2.0, 2.5], Some(0.5), 1.0), (&[2.0], Some(0.5), 0.5)]
        {
            let run = logged(times, step_length);
            assert_eq!(run.step_length, Some(0.5));
            let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found}, not {wanted}");
            near(run.hours(), seconds / 3600.0);
            near(run.summary.exposure.vehicle_hours, seconds / 3600.0);
            near(run.summary.exposure.vehicle_kilometres, seconds * 10.0 / 1000.0);
        }
    }
}
