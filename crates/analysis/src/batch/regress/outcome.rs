//! The results of a scenario's runs, one per seed; the expected results are the same, in two files.
//!
//! `conflicts.csv` holds the rows of all seeds with the seed as first column. `summary.json` holds the versions, the
//! options, the input files, and the counts and traffic of each seed.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::fingerprint::Fingerprint;
use crate::logged::{LoggedRun, SUMMARY};
use crate::{Error, Result};
use closecall::detection::kind::{Kind, Severity};
use closecall::util::units::Second;
use closecall_run::output::log;
use closecall_run::output::schema::{COLUMNS, Column, LoggedConflict, Presence};
use closecall_run::output::summary::{Count, Exposure};
use closecall_run::util::{input_file, output_file};

/// The results of a scenario's runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// How the runs were made, and their counts.
    pub summary: RunsSummary,
    /// The conflicts of all seeds, in the order of seeds and rows.
    pub conflicts: Vec<SeedConflict>,
    /// `conflicts.csv`, byte for byte.
    pub csv: Vec<u8>,
}

/// How the runs were made, and their counts: `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunsSummary {
    /// closecall's version.
    pub closecall: String,
    /// SUMO's version.
    pub sumo: String,
    /// Operating system and processor: arithmetic may differ between them.
    pub platform: String,
    /// Options for SUMO, but the configuration and the seed.
    pub sumo_options: Vec<String>,
    /// Length of a step in s.
    pub step_length: Second,
    /// The options of the run.
    pub options: Value,
    /// Input files with their hashes and parts.
    pub inputs: Vec<Fingerprint>,
    /// The counts and traffic of each seed.
    pub seeds: Vec<SeedSummary>,
}

/// The counts and the traffic of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeedSummary {
    /// SUMO's random seed.
    pub seed: u32,
    /// Steps that were checked.
    pub steps: u64,
    /// Conflicts by kind and severity; those set aside by reason.
    pub conflicts: Vec<Count>,
    /// Conflicts in which the two rectangles overlapped.
    pub collisions: u64,
    /// The amount of traffic.
    pub exposure: Exposure,
}

/// One conflict of the runs.
#[derive(Clone, Debug, PartialEq)]
pub struct SeedConflict {
    /// SUMO's random seed.
    pub seed: u32,
    /// SUMO's id of the ego.
    pub ego: String,
    /// SUMO's id of the foe.
    pub foe: String,
    /// The kind.
    pub kind: Kind,
    /// The severity.
    pub severity: Severity,
    /// First step that meets the log's condition, in s.
    pub begin: Second,
    /// Last step that meets it, in s.
    pub end: Second,
    /// The seed, and a cell for each of the [`COLUMNS`]; empty where the file lacks one.
    cells: csv::StringRecord,
}

impl SeedConflict {
    /// The conflict in a row, of which `places` tells where the seed and each of the [`COLUMNS`] is; none where a cell does not fit its column.
    fn new(places: &[Option<usize>], row: &csv::StringRecord) -> Option<Self> {
        let cells = places.iter().map(|place| place.and_then(|place| row.get(place)).unwrap_or_default());
        let cells = cells.collect::<csv::StringRecord>();
        let cell = |column: usize| COLUMNS[column].column_type.parse(cells.get(column + 1).unwrap_or_default());
        let LoggedConflict { ego, foe, kind, severity, begin, end, .. } = LoggedConflict::from_cells(cell).ok()?;
        let (ego, foe) = (ego.into(), foe.into());
        Some(Self { seed: cells.get(0)?.parse().ok()?, ego, foe, kind, severity, begin, end, cells })
    }

    /// The text in a column; empty where there is none.
    pub fn text(&self, column: &str) -> &str {
        let place = COLUMNS.iter().position(|known| known.name == column);
        place.and_then(|place| self.cells.get(place + 1)).unwrap_or_default()
    }

    /// The number in a column, if there is one.
    pub fn number(&self, column: &str) -> Option<f64> {
        self.text(column).parse().ok()
    }
}

impl RunsSummary {
    /// Whether the runs count conflicts that are none of traffic's.
    pub(crate) fn counts_artefacts(&self) -> bool {
        self.options.get("artefacts").and_then(Value::as_bool).unwrap_or_default()
    }
}

impl SeedSummary {
    /// The number of conflicts that count.
    pub fn counted(&self) -> u64 {
        self.conflicts.iter().filter(|count| count.artefact.is_none()).map(|count| count.count).sum()
    }
}

impl Outcome {
    /// Collects the logs of the runs, each with its seed; `folder` is where they ran.
    ///
    /// # Errors
    /// An error that names the log's file that cannot be read or does not hold what it should.
    pub fn collect(folder: &Path, logs: &[(u32, std::path::PathBuf)]) -> Result<Self> {
        let mut csv = csv::Writer::from_writer(Vec::new());
        let mut summary: Option<RunsSummary> = None;
        for (seed, log) in logs {
            let record = LoggedRun::read(log)?;
            append(&mut csv, *seed, &log.join(log::CONFLICTS), summary.is_none())?;
            let of_seed = SeedSummary {
                seed: *seed,
                steps: record.summary.steps,
                conflicts: record.summary.conflicts,
                collisions: record.summary.collisions,
                exposure: rounded(record.summary.exposure),
            };
            match &mut summary {
                Some(summary) => summary.seeds.push(of_seed),
                None => {
                    summary = Some(RunsSummary {
                        closecall: record.versions.closecall,
                        sumo: record.versions.sumo.unwrap_or_default(),
                        platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
                        sumo_options: sumo_options(&record.sumo_words),
                        step_length: record.step_length.unwrap_or_default(),
                        options: record.options,
                        inputs: record
                            .inputs
                            .into_iter()
                            .map(|input| Fingerprint::of(folder, input))
                            .collect::<Result<_>>()?,
                        seeds: vec![of_seed],
                    });
                }
            }
        }
        let bytes = csv.into_inner().map_err(|error| Error::Value(error.to_string()))?;
        let summary = summary.ok_or_else(|| Error::content(folder, "the scenario has no seeds"))?;
        Ok(Self { conflicts: conflicts(&bytes, &folder.join(log::CONFLICTS))?, csv: bytes, summary })
    }

    /// Reads the expected results; none where nothing is blessed.
    ///
    /// # Errors
    /// An error that names the file that cannot be read or does not hold what it should.
    pub fn read(expected: &Path) -> Result<Option<Self>> {
        let table = expected.join(log::CONFLICTS);
        let summary = expected.join(SUMMARY);
        if !table.exists() && !summary.exists() {
            return Ok(None);
        }
        let csv = input_file::text(&table)?.into_bytes();
        Ok(Some(Self { summary: read_json(&summary)?, conflicts: conflicts(&csv, &table)?, csv }))
    }

    /// Writes this as the expected results.
    ///
    /// # Errors
    /// [`Error::file`] that names what cannot be written.
    pub fn write(&self, expected: &Path) -> Result<()> {
        let text =
            serde_json::to_string_pretty(&self.summary).map_err(|error| Error::content(expected, error.to_string()))?;
        output_file::check_is_no_link(expected)?;
        for (name, bytes) in [(log::CONFLICTS, self.csv.clone()), (SUMMARY, (text + "\n").into_bytes())] {
            output_file::write(&expected.join(name), &bytes)?;
        }
        Ok(())
    }

    /// The seeds, in the order of the runs.
    pub fn seeds(&self) -> Vec<u32> {
        self.summary.seeds.iter().map(|of_seed| of_seed.seed).collect()
    }
}

/// Copies a run's rows and puts the seed before them.
fn append(csv: &mut csv::Writer<Vec<u8>>, seed: u32, path: &Path, with_header: bool) -> Result<()> {
    let fail = |error: csv::Error| Error::content(path, error.to_string());
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).map_err(fail)?;
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(fail)?;
        let first = if row == 0 { "seed".to_owned() } else { seed.to_string() };
        if row > 0 || with_header {
            csv.write_record(std::iter::once(first.as_str()).chain(&record)).map_err(fail)?;
        }
    }
    Ok(())
}

fn conflicts(csv: &[u8], path: &Path) -> Result<Vec<SeedConflict>> {
    let fail = |error: csv::Error| Error::content(path, error.to_string());
    let mut reader = csv::Reader::from_reader(csv);
    let header = reader.headers().map_err(fail)?;
    // Only runs with `--measures` have the columns that may be added.
    let is_there =
        |column: &&Column| column.presence != Presence::Chosen || header.iter().any(|name| name == column.name);
    let there = COLUMNS.iter().filter(is_there).map(|column| column.name);
    if !header.iter().eq(std::iter::once("seed").chain(there)) {
        return Err(Error::line(path, 1, "these are not the columns of this version; bless again"));
    }
    let place = |name| header.iter().position(|known| known == name);
    let places = std::iter::once("seed").chain(COLUMNS.map(|column| column.name)).map(place).collect::<Vec<_>>();
    reader
        .records()
        .map(|record| {
            let record = record.map_err(fail)?;
            let line = record.position().map_or(1, csv::Position::line);
            SeedConflict::new(&places, &record)
                .ok_or_else(|| Error::line(path, line, "this is not the row of a conflict"))
        })
        .collect()
}

fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T> {
    let text = input_file::text(path)?;
    serde_json::from_str(&text).map_err(|error| Error::line(path, error.line() as u64, error.to_string()))
}

/// SUMO's words without the configuration and the seed, each option with its value.
fn sumo_options(words: &[String]) -> Vec<String> {
    let mut options: Vec<String> = Vec::new();
    for word in words {
        match options.last_mut() {
            Some(option) if !word.starts_with('-') => {
                option.push(' ');
                option.push_str(word);
            }
            _ => options.push(word.clone()),
        }
    }
    options.retain(|option| !option.starts_with("-c ") && !option.starts_with("--seed "));
    options
}

/// Six decimals, as in the CSV files: further digits depend on the order of sums.
fn rounded(exposure: Exposure) -> Exposure {
    let round = |value: f64| (value * 1e6).round() / 1e6;
    Exposure {
        vehicle_kilometres: round(exposure.vehicle_kilometres),
        vehicle_hours: round(exposure.vehicle_hours),
        ..exposure
    }
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::outcome::*;

    #[test]
    fn the_configuration_and_the_seed_are_not_options() {
        let words = ["-c", "a.sumocfg", "--end", "20", "--seed", "4", "--no-warnings"].map(str::to_owned);
        assert_eq!(sumo_options(&words), ["--end 20", "--no-warnings"]);
    }
}
