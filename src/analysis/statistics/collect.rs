//! One pass over the logs of a set of runs: counts per run, the values of each measure, the worst conflicts.
//!
//! Each conflict leaves four numbers (32 B), so 10⁷ conflicts fit in 1 GiB.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;
use serde::Serialize;

use super::extremes::Tails;
use super::group::By;
use super::quantiles::quantile;
use super::worst::WorstOf;
use crate::analysis::logged::{ConflictReader, LoggedConflict, LoggedRun, log_folders};
use crate::detection::kind::{Kind, Severity};
use crate::{Error, Result};

/// The measures whose values are kept, by their names in every output.
pub const MEASURES: [&str; 4] = ["ttc", "pet", "margin", "delta_v"];

/// The values of the [`MEASURES`].
pub type Columns = [Vec<f64>; MEASURES.len()];

/// The number of conflicts per run, for the runs that had any, in the order of the runs.
#[derive(Clone, Debug, Default)]
pub struct Counts(Vec<(u32, u64)>);

impl Counts {
    fn add(&mut self, run: usize) {
        match self.0.last_mut() {
            Some((last, count)) if *last as usize == run => *count += 1,
            _ => self.0.push((run as u32, 1)),
        }
    }

    /// The counts with one entry per run.
    pub fn per_run(&self, runs: usize) -> Vec<f64> {
        let mut counts = vec![0.0; runs];
        for &(run, count) in &self.0 {
            counts[run as usize] = count as f64;
        }
        counts
    }

    /// The count over all runs.
    pub fn sum(&self) -> u64 {
        self.0.iter().map(|(_, count)| count).sum()
    }
}

/// A group of conflicts.
#[derive(Debug, Default)]
pub struct ConflictGroup {
    /// The number of conflicts per run.
    pub counts: Counts,
    /// The number of conflicts in which the rectangles overlapped.
    pub collisions: u64,
    /// The values of the measures.
    pub columns: Columns,
}

/// The conflicts of one edge or junction.
#[derive(Debug, Default)]
pub struct Spot {
    /// The number of conflicts per run.
    pub counts: Counts,
    /// The number of conflicts of each severity.
    pub severities: [u64; 3],
}

/// A log that is not counted or needs a warning, and why.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOutLog {
    /// The log folder.
    pub folder: PathBuf,
    /// Why.
    pub why: String,
}

/// The result of one pass over a set of runs.
#[derive(Debug)]
pub struct Collection {
    /// The record of each run.
    pub runs: Vec<LoggedRun>,
    /// The folder of each run.
    pub folders: Vec<Arc<Path>>,
    /// The runs of each seed.
    by_seed: FxHashMap<Option<String>, Vec<usize>>,
    /// Logs that were not counted, were counted in part, or repeat another.
    pub left_out: Vec<LeftOutLog>,
    /// The conflicts, by group.
    pub groups: FxHashMap<String, ConflictGroup>,
    /// Counts by kind and severity.
    pub tallies: [[Counts; 3]; 3],
    /// Counts by edge.
    pub edges: FxHashMap<String, Spot>,
    /// Counts by junction.
    pub junctions: FxHashMap<String, Spot>,
    /// The median of each measure, per run.
    pub medians: Vec<[Option<f64>; MEASURES.len()]>,
    /// The worst conflicts.
    pub worst: WorstOf,
    /// The most severe values, for the extrapolation to crashes.
    pub tails: Tails,
}

impl Collection {
    /// Reads the logs in and below these folders.
    ///
    /// # Errors
    /// An error that names the folder, or the file and its line: missing, not a log, empty, cut short, with other columns
    /// than the first log, or if no run has a result.
    pub fn read(named: &[PathBuf], by: By, worst: usize) -> Result<Self> {
        let mut found = Self {
            runs: Vec::new(),
            folders: Vec::new(),
            by_seed: FxHashMap::default(),
            left_out: Vec::new(),
            groups: FxHashMap::default(),
            tallies: Default::default(),
            edges: FxHashMap::default(),
            junctions: FxHashMap::default(),
            medians: Vec::new(),
            worst: WorstOf::new(worst),
            tails: Tails::default(),
        };
        let mut columns: Option<(PathBuf, Vec<String>)> = None;
        for folder in log_folders(named)? {
            let reader = ConflictReader::open(&folder)?;
            let header = reader.columns();
            if by == By::Type && !header.iter().any(|column| column == "ego_type") {
                let message = "the column \"ego_type\" is missing: logs of earlier versions do not have types";
                return Err(Error::line(reader.path(), 1, message));
            }
            match &columns {
                Some((first, known)) if *known != header => {
                    let message = format!("its columns are not those of {}", first.display());
                    return Err(Error::line(reader.path(), 1, message));
                }
                Some(_) => {}
                None => columns = Some((reader.path().to_owned(), header)),
            }
            let run = LoggedRun::read(&folder)?;
            if run.summary.steps == 0 {
                let why = "the run has no result: it was killed, or is still running".to_owned();
                found.left_out.push(LeftOutLog { folder, why });
                continue;
            }
            found.add_run(run, folder.into(), reader, by)?;
        }
        match found.left_out.first() {
            Some(first) if found.runs.is_empty() => Err(Error::content(&first.folder, first.why.clone())),
            _ => Ok(found),
        }
    }

    fn add_run(&mut self, run: LoggedRun, folder: Arc<Path>, reader: ConflictReader, by: By) -> Result<()> {
        let number = self.runs.len();
        let of_seed = self.by_seed.entry(run.seed.clone()).or_default();
        let before = of_seed.iter().copied().find(|known| same_run(&self.runs[*known], &run));
        of_seed.push(number);
        if let Some(before) = before {
            let why = format!("counted, but it repeats {}: same scenario and seed", self.folders[before].display());
            self.left_out.push(LeftOutLog { folder: folder.to_path_buf(), why });
        } else if !run.complete {
            let why = "counted in part: the run did not reach its end".to_owned();
            self.left_out.push(LeftOutLog { folder: folder.to_path_buf(), why });
        }
        let mut own = Columns::default();
        for conflict in reader {
            let conflict = conflict?;
            self.add(number, &folder, &conflict, by);
            for (column, value) in own.iter_mut().zip(measures(&conflict)) {
                column.extend(value);
            }
        }
        self.medians.push(own.map(|mut values| {
            values.sort_unstable_by(f64::total_cmp);
            quantile(&values, 0.5)
        }));
        self.runs.push(run);
        self.folders.push(folder);
        Ok(())
    }

    fn add(&mut self, run: usize, folder: &Arc<Path>, conflict: &LoggedConflict, by: By) {
        update(&mut self.groups, &by.group(conflict), |group| {
            group.counts.add(run);
            group.collisions += u64::from(conflict.collision);
            for (column, value) in group.columns.iter_mut().zip(measures(conflict)) {
                column.extend(value);
            }
        });
        let kind = rank(&Kind::ALL, conflict.kind);
        let severity = rank(&Severity::ALL, conflict.severity);
        self.tallies[kind][severity].add(run);
        for (spots, name) in [(&mut self.edges, conflict.edge()), (&mut self.junctions, conflict.junction())] {
            if !name.is_empty() {
                update(spots, name, |spot: &mut Spot| {
                    spot.counts.add(run);
                    spot.severities[severity] += 1;
                });
            }
        }
        self.worst.take(run, folder, conflict);
        self.tails.take(conflict);
    }

    /// Conflicts per run, of one kind or all, and of one severity or all.
    pub fn counts(&self, kind: Option<Kind>, severity: Option<Severity>) -> Vec<f64> {
        let mut sum = vec![0.0; self.runs.len()];
        for (this, tallies) in Kind::ALL.iter().zip(&self.tallies) {
            for (that, counts) in Severity::ALL.iter().zip(tallies) {
                if kind.is_none_or(|kind| kind == *this) && severity.is_none_or(|severity| severity == *that) {
                    sum.iter_mut().zip(counts.per_run(self.runs.len())).for_each(|(sum, count)| *sum += count);
                }
            }
        }
        sum
    }

    /// All values of a measure, in ascending order.
    pub fn sorted(&self, measure: usize) -> Vec<f64> {
        let all = self.groups.values().map(|group| group.columns[measure].len()).sum();
        let mut values = Vec::with_capacity(all);
        self.groups.values().for_each(|group| values.extend_from_slice(&group.columns[measure]));
        values.sort_unstable_by(f64::total_cmp);
        values
    }
}

fn measures(conflict: &LoggedConflict) -> [Option<f64>; MEASURES.len()] {
    [conflict.ttc, conflict.pet, Some(conflict.margin), Some(conflict.delta_v)]
}

fn rank<T: PartialEq>(all: &[T], one: T) -> usize {
    all.iter().position(|known| *known == one).unwrap_or_default()
}

/// Changes the entry of a name; copies the name only if it is new.
fn update<T: Default>(map: &mut FxHashMap<String, T>, name: &str, change: impl FnOnce(&mut T)) {
    if let Some(known) = map.get_mut(name) {
        change(known);
    } else {
        let mut new = T::default();
        change(&mut new);
        map.insert(name.to_owned(), new);
    }
}

/// Whether two runs repeat each other, so that they are not independent.
fn same_run(one: &LoggedRun, other: &LoggedRun) -> bool {
    let is_random = one.seed.is_none() && one.versions.sumo.is_some();
    !is_random
        && one.seed == other.seed
        && one.sumo_words == other.sumo_words
        && one.inputs == other.inputs
        && one.options == other.options
        && one.scenario == other.scenario
}
