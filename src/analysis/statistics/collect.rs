//! One pass over the logs of a set of runs: counts per run, the values of each measure, the worst conflicts.
//!
//! Each conflict leaves four numbers (32 B), so 10⁷ conflicts fit in 1 GiB.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::chosen::{Chosen, LeftOutLog, choose};
use super::extremes::Tails;
use super::group::By;
use super::quantiles::quantile;
use super::weighted::WeightedEvents;
use super::worst::WorstOf;
use crate::analysis::filter::ConflictFilter;
use crate::analysis::logged::{ConflictReader, LoggedConflict, LoggedRun, LostRows, Progress, Reading, log_folders};
use crate::analysis::variants::{Variant, Variants};
use crate::detection::kind::{Kind, Severity};
use crate::{Error, Result};

/// The measures whose values are kept, by their names in every output; ΔV is the larger of the two.
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

    /// The counts of these runs, which are in ascending order.
    pub fn of(&self, runs: &[usize]) -> Vec<f64> {
        let mut counts = self.0.iter().peekable();
        let count = |run: &usize| {
            while counts.next_if(|(known, _)| (*known as usize) < *run).is_some() {}
            counts.peek().filter(|(known, _)| *known as usize == *run).map_or(0.0, |(_, count)| *count as f64)
        };
        runs.iter().map(count).collect()
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
    /// The conflicts with their crash probabilities.
    pub crashes: WeightedEvents,
}

/// The result of one pass over a set of runs.
#[derive(Debug)]
pub struct Collection {
    /// The record of each run.
    pub runs: Vec<LoggedRun>,
    /// The folder of each run.
    pub folders: Vec<Arc<Path>>,
    /// The variants of the runs.
    pub variants: Variants,
    /// Logs that were not counted, were counted in part, or seem to repeat another.
    pub left_out: Vec<LeftOutLog>,
    /// The logs that lack rows.
    pub lost: Vec<LostRows>,
    /// How many conflicts the logs have.
    pub read: u64,
    /// How many of them count.
    pub passed: u64,
    /// The conflicts of each variant, by group.
    pub groups: Vec<FxHashMap<String, ConflictGroup>>,
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
    /// Reads the logs in and below these folders. It reports to `progress` how many conflicts it has read.
    ///
    /// # Errors
    /// An error that names the folder, or the file and its line: missing, not a log, empty, cut short, with other columns
    /// than the first log, or if no run has a result.
    pub fn read(
        named: &[PathBuf],
        by: By,
        filter: &ConflictFilter,
        worst: usize,
        progress: &mut Progress,
    ) -> Result<Self> {
        let Chosen { mut runs, variants, left_out } = choose(&log_folders(named)?)?;
        runs.iter_mut().for_each(|(_, run)| filter.clip(run));
        let (folders, runs) = runs.into_iter().unzip::<_, _, Vec<Arc<Path>>, Vec<_>>();
        let mut found = Self {
            medians: Vec::with_capacity(runs.len()),
            groups: variants.all.iter().map(|_| FxHashMap::default()).collect(),
            runs,
            folders,
            variants,
            left_out,
            lost: Vec::new(),
            read: 0,
            passed: 0,
            tallies: Default::default(),
            edges: FxHashMap::default(),
            junctions: FxHashMap::default(),
            worst: WorstOf::new(worst),
            tails: Tails::default(),
        };
        let conflicts = found.runs.iter().map(LoggedRun::conflicts).sum();
        let mut variant_of = vec![0; found.runs.len()];
        for (variant, members) in found.variants.all.iter().enumerate() {
            members.runs.iter().for_each(|run| variant_of[*run] = variant);
        }
        let mut progress = Reading::new(conflicts, progress);
        let mut columns: Option<(PathBuf, Vec<String>)> = None;
        for (run, variant) in variant_of.into_iter().enumerate() {
            let reader = ConflictReader::open(&found.folders[run])?;
            let header = reader.columns();
            if let Some(needed) = by.needs().filter(|needed| !header.iter().any(|column| column == needed)) {
                let message = format!("the column \"{needed}\" is missing: logs of earlier versions do not have it");
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
            found.add_run((run, variant), reader, by, filter, &mut progress)?;
        }
        Ok(found)
    }

    fn add_run(
        &mut self,
        (run, variant): (usize, usize),
        mut reader: ConflictReader,
        by: By,
        filter: &ConflictFilter,
        progress: &mut Reading,
    ) -> Result<()> {
        let folder = self.folders[run].clone();
        let mut own = Columns::default();
        for conflict in &mut reader {
            let conflict = conflict?;
            progress.count();
            self.read += 1;
            if !filter.passes(&conflict) {
                continue;
            }
            self.passed += 1;
            self.add(run, variant, &folder, &conflict, by);
            for (column, value) in own.iter_mut().zip(measures(&conflict)) {
                column.extend(value);
            }
        }
        self.lost.extend(reader.lost());
        self.medians.push(own.map(|mut values| {
            values.sort_unstable_by(f64::total_cmp);
            quantile(&values, 0.5)
        }));
        Ok(())
    }

    fn add(&mut self, run: usize, variant: usize, folder: &Arc<Path>, conflict: &LoggedConflict, by: By) {
        update(&mut self.groups[variant], &by.group(conflict), |group| {
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
                    spot.crashes.add(run, conflict.crash_probability.unwrap_or_default());
                });
            }
        }
        self.worst.take(run, folder, conflict);
        self.tails.take(conflict);
    }

    /// What the filter left, in words; none without a filter.
    pub fn filtered(&self, filter: &ConflictFilter) -> Vec<String> {
        if filter.is_empty() {
            return Vec::new();
        }
        let counts = match (self.passed, self.read) {
            (0, 1..) => format!("none of {} conflicts passes {filter}", self.read),
            (passed, read) => format!("{passed} of {read} conflicts pass {filter}"),
        };
        let period = "the traffic of the period alone is not known: its rates are per hour only".to_owned();
        std::iter::once(counts).chain(filter.has_period().then_some(period)).collect()
    }

    /// Checks that the runs have one setting: a comparison tells two settings apart.
    ///
    /// # Errors
    /// [`Error::Value`] that names in what the runs in `folders` differ.
    pub fn check_alike(&self, folders: &[PathBuf]) -> Result<()> {
        if !self.variants.are_several() {
            return Ok(());
        }
        let named = folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(" ");
        let varied = self.variants.varied.join(", ");
        Err(Error::Value(format!("{named}: the runs differ in {varied}: for --against name those of one variant")))
    }

    /// The records of a variant's runs.
    pub fn members(&self, variant: &Variant) -> Vec<&LoggedRun> {
        variant.runs.iter().map(|run| &self.runs[*run]).collect()
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
        let groups = || self.groups.iter().flat_map(FxHashMap::values);
        let mut values = Vec::with_capacity(groups().map(|group| group.columns[measure].len()).sum());
        groups().for_each(|group| values.extend_from_slice(&group.columns[measure]));
        values.sort_unstable_by(f64::total_cmp);
        values
    }
}

fn measures(conflict: &LoggedConflict) -> [Option<f64>; MEASURES.len()] {
    [conflict.ttc, conflict.pet, Some(conflict.margin), Some(conflict.delta_v())]
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
