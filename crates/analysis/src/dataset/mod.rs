//! The conflicts of several logs, and their net: the input of a report or a picture.

pub(crate) mod conflict_table;
pub(crate) mod kept;
mod logs;
pub(crate) mod nets;

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::filter::{ConflictFilter, NamedPlaces, set_aside_in_words};
use super::logged::{ConflictReader, LostRows, Progress, Reading, log_folders};
use super::variants::{Variant, Variants};
use crate::Result;
use closecall::detection::kind::{Kind, Severity};
use closecall::geometry::Point;
use closecall::traffic::net::Net;
use closecall::util::units::Second;
use closecall_run::output::summary::{SetAside, in_words};
use conflict_table::ConflictTable;
use kept::{KeptConflicts, MOST, RunConflict};
use nets::Ground;

/// The conflicts of several logs; of more than 300,000, the worst.
#[derive(Debug)]
pub struct Conflicts {
    /// The folders of the logs.
    pub(super) logs: Vec<PathBuf>,
    /// Their `run.json`; null where there is none.
    pub(super) records: Vec<serde_json::Value>,
    /// Their variants: runs that were made alike but for the seed.
    pub(super) variants: Vec<Variant>,
    /// The net, and notes about it.
    pub(super) ground: Ground,
    /// The conflicts, worst first.
    pub(super) conflicts: Vec<RunConflict>,
    /// Their rows.
    pub(super) table: ConflictTable,
    /// How many there are in the logs.
    pub(super) seen: u64,
    /// How many others are none of traffic's, and why, in words.
    pub(super) set_aside: Option<String>,
    /// The filter that they passed, as the words of a command line; none for all.
    pub(super) filter: Option<String>,
    /// Which part of the traffic they are of.
    pub(super) scope: Scope,
    /// The places with names of their own.
    pub(super) named: Option<NamedPlaces>,
    /// The logs that lack rows.
    pub(super) lost: Vec<LostRows>,
}

/// Whether the filter selects a part of the net or of the time: the traffic of that part alone is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Scope {
    /// It names places.
    pub place: bool,
    /// It names a period.
    pub period: bool,
    /// It counts those that are none of traffic's, too.
    pub artefacts: bool,
}

/// Reads the logs in `folders`, each a log itself or a folder of logs. The net is read from `net`, or from the path in the
/// first log. It reports to `progress` how far it has read.
///
/// # Errors
/// [`closecall_run::Error::File`] where a folder cannot be read, [`closecall_run::Error::Content`] where a folder holds no log,
/// [`closecall_run::Error::Line`] where a row of `conflicts.csv` is not as docs/log.md describes it.
pub fn read(
    folders: &[PathBuf],
    net: Option<&Path>,
    filter: &ConflictFilter,
    progress: &mut Progress,
) -> Result<Conflicts> {
    filter.check()?;
    let logs = log_folders(folders)?;
    let mut records = logs.iter().map(|log| logs::record(log)).collect::<Result<Vec<_>>>()?;
    let (mut variants, expected) = variants_of(&records);
    let mut reading = Reading::new(expected, progress);
    let mut worst = KeptConflicts::new(MOST);
    let mut lost = Vec::new();
    let (mut all, mut set_aside) = (0_u64, SetAside::new());
    for (run, log) in (0..).zip(&logs) {
        let mut conflicts = ConflictReader::open(log)?.with_snapshots();
        while let Some(conflict) = conflicts.next_row()? {
            reading.count(1);
            if filter.sets_aside(conflict, &mut set_aside) {
                continue;
            }
            all += 1;
            if filter.passes(conflict) {
                worst.push(run, conflict);
            }
        }
        lost.extend(conflicts.lost());
    }
    let mut ground = nets::find(net, &logs, &records)?;
    // A record without steps is that of a run that has begun; null means that the record is missing.
    let without = records.iter().filter(|record| record["summary"]["steps"].as_u64().is_none_or(|steps| steps == 0));
    let without = without.count();
    if without > 0 {
        ground.notes.push(format!(
            "{without} of {} runs have no result, killed or not at their end yet: their conflicts count, their traffic is \
             not known.",
            logs.len()
        ));
    }
    if variants.are_several() {
        let varied = variants.varied.join(", ");
        ground
            .notes
            .push(format!("The runs differ in {varied}: the filter selects one variant, the page begins with all."));
    }
    ground.notes.append(&mut variants.notes);
    ground.notes.extend(lost.iter().map(ToString::to_string));
    let aside = set_aside_in_words(&set_aside);
    ground.notes.extend(in_words(&set_aside).map(|words| format!("The runs have {words} (--artefacts shows them).")));
    let seen = worst.seen();
    if !filter.is_empty() {
        let passed = if seen == 0 { "none".to_owned() } else { seen.to_string() };
        ground.notes.push(format!("Filtered: {passed} of {all} conflicts, by {filter}."));
    }
    if filter.has_period() {
        // How much of the traffic was in the period is not known.
        let summaries = records.iter_mut().filter_map(|record| record.get_mut("summary")?.as_object_mut());
        summaries.for_each(|summary| drop(summary.remove("entered")));
    }
    let scope = Scope { place: !filter.places.is_empty(), period: filter.has_period(), artefacts: filter.artefacts };
    let named = filter.named.clone();
    let filter = (!filter.is_empty()).then(|| filter.to_string());
    let (conflicts, table) = worst.into_sorted();
    let variants = variants.all;
    Ok(Conflicts {
        logs,
        records,
        variants,
        ground,
        conflicts,
        table,
        seen,
        set_aside: aside,
        filter,
        scope,
        named,
        lost,
    })
}

/// The variants of the runs with these records, and how many conflicts those counted. A run without a result belongs to none.
fn variants_of(records: &[serde_json::Value]) -> (Variants, u64) {
    let runs = records.iter().map(logs::run).collect::<Vec<_>>();
    let known = (0..).zip(&runs).filter_map(|(place, run)| Some((place, run.as_ref()?)));
    let known = known.filter(|(_, run)| run.summary.steps > 0).collect::<Vec<_>>();
    let mut variants = Variants::of(&known.iter().map(|(_, run)| *run).collect::<Vec<_>>());
    for variant in &mut variants.all {
        variant.runs.iter_mut().for_each(|run| *run = known[*run].0);
    }
    (variants, known.iter().map(|(_, run)| run.conflicts()).sum())
}

impl Conflicts {
    /// The net; none where it is gone.
    pub fn net(&self) -> Option<&Net> {
        self.ground.net.as_ref()
    }

    /// Kind, severity and conflict point of each.
    pub fn places(&self) -> impl Iterator<Item = (Kind, Severity, Point)> {
        let [x, y] = ["x", "y"].map(|name| self.table.numbers(name));
        self.conflicts
            .iter()
            .filter_map(move |one| Some((one.kind, one.severity, Point::new(x(one.row)?, y(one.row)?))))
    }

    /// The largest value of each conflict in these columns, with its severity.
    pub fn numbers<'a>(&'a self, columns: &[&str]) -> impl Iterator<Item = (Severity, f64)> + use<'a> {
        let numbers = columns.iter().map(|name| self.table.numbers(name)).collect::<Vec<_>>();
        let largest = move |row| numbers.iter().filter_map(|number| number(row)).reduce(f64::max);
        self.conflicts.iter().filter_map(move |one| Some((one.severity, largest(one.row)?)))
    }

    /// First and last second of all runs.
    pub fn period(&self) -> (Second, Second) {
        let of_run = |key| self.records.iter().filter_map(move |record| record.get("summary")?.get(key)?.as_f64());
        let times = self.numbers(&["time"]).map(|(_, time)| time).chain(of_run("begin")).chain(of_run("end"));
        let (begin, end) = times.fold((f64::INFINITY, 0.0), |(begin, end), time| (time.min(begin), time.max(end)));
        (begin.min(end), end)
    }

    /// The threshold beyond which a measure makes a conflict serious, by the first run's options; none if it never does.
    pub(crate) fn threshold(&self, name: &str) -> Option<f64> {
        let option = |key| self.records.iter().find_map(|record| record.get("options")?.get(key));
        let key = match name {
            "ttc" => "serious_ttc",
            "drac" => "serious_drac",
            _ => return None,
        };
        // Logs of earlier versions have the rule as "severity".
        let threshold = match option("severity_rule").or_else(|| option("severity"))?.as_str()? {
            "fhwa" => option(key)?.as_f64()?,
            // The same for TTC, in s, and DRAC, in m/s².
            "ssm" => 3.0,
            _ => return None,
        };
        Some(threshold).filter(|threshold| *threshold > 0.0)
    }
}
