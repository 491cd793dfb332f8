//! One pass over the logs of a set of runs: counts per run, the values of each measure, the worst conflicts.
//!
//! As many runs are read at the same time as the machine has processors. Each conflict leaves four numbers (32 B), so 10⁷
//! conflicts fit in 1 GiB.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::chosen::{Chosen, LeftOutLog, choose};
use super::counts::{ConflictGroup, Counts, MEASURES, Spot};
use super::extremes::Tails;
use super::group::By;
use super::of_run::OfRun;
use super::together::in_order;
use super::weighted::WeightedEvents;
use super::worst::WorstOf;
use crate::filter::{ConflictFilter, set_aside_in_words};
use crate::logged::{ConflictReader, LoggedRun, LostRows, Progress, Reading, log_folders};
use crate::variants::{Variant, Variants};
use crate::{Error, Result};
use closecall::detection::kind::{Kind, Severity};
use closecall_run::output::summary::SetAside;

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
    /// The others, which are none of traffic's.
    pub set_aside: SetAside,
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
    /// All conflicts with their crash probabilities.
    pub risk: WeightedEvents,
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
            risk: WeightedEvents::default(),
            medians: Vec::with_capacity(runs.len()),
            groups: variants.all.iter().map(|_| FxHashMap::default()).collect(),
            runs,
            folders,
            variants,
            left_out,
            lost: Vec::new(),
            read: 0,
            set_aside: SetAside::new(),
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
        let runs = std::mem::take(&mut found.runs);
        let folders = found.folders.clone();
        let read = |run: usize, progress: &mut dyn FnMut(u64)| {
            let log = ConflictReader::of(&folders[run], Some(&runs[run]))?;
            OfRun::read((run, &folders[run], log), by, filter, worst, progress)
        };
        let take = |run: usize, of_run: Result<OfRun>| {
            let of_run = of_run?;
            match &columns {
                Some((first, known)) if *known != of_run.columns => {
                    let message = format!("its columns are not those of {}", first.display());
                    return Err(Error::line(&of_run.path, 1, message));
                }
                Some(_) => {}
                None => columns = Some((of_run.path.clone(), of_run.columns.clone())),
            }
            found.append(variant_of[run], of_run);
            Ok(())
        };
        in_order(folders.len(), read, take, |more| progress.count(more))?;
        found.runs = runs;
        found.worst.complete()?;
        Ok(found)
    }

    /// Adds the conflicts of the next run.
    fn append(&mut self, variant: usize, of_run: OfRun) {
        self.read += of_run.read;
        for (artefact, count) in of_run.set_aside {
            *self.set_aside.entry(artefact).or_default() += count;
        }
        self.passed += of_run.passed;
        self.lost.extend(of_run.lost);
        self.risk.append(of_run.risk);
        self.medians.push(of_run.medians);
        for (name, group) in of_run.groups {
            self.groups[variant].entry(name).or_default().append(group);
        }
        for (counts, mut of_run) in self.tallies.iter_mut().flatten().zip(of_run.tallies.into_iter().flatten()) {
            counts.append(&mut of_run);
        }
        for (spots, of_run) in [(&mut self.edges, of_run.edges), (&mut self.junctions, of_run.junctions)] {
            of_run.into_iter().for_each(|(name, spot)| spots.entry(name).or_default().append(spot));
        }
        self.worst.append(of_run.worst);
        self.tails.append(of_run.tails);
    }

    /// What was set aside, what the filter left, and which names are old, in words.
    pub(crate) fn filtered(&self, filter: &ConflictFilter) -> Vec<String> {
        let are_old = self.runs.iter().any(|run| run.has_old_names);
        let old = are_old.then(|| "logs of earlier versions call the risk index expected_crashes".to_owned());
        let set_aside = set_aside_in_words(&self.set_aside).into_iter().chain(old);
        if filter.is_empty() {
            return set_aside.collect();
        }
        let counts = match (self.passed, self.read) {
            (0, 1..) => format!("none of {} conflicts passes {filter}", self.read),
            (passed, read) => format!("{passed} of {read} conflicts pass {filter}"),
        };
        let period = "the traffic of the period alone is not known: its rates are per hour only".to_owned();
        set_aside.chain([counts]).chain(filter.has_period().then_some(period)).collect()
    }

    /// Checks that the runs have one setting: a comparison tells two settings apart.
    ///
    /// # Errors
    /// [`Error::SeveralVariants`] that names in what the runs in `folders` differ.
    pub(crate) fn check_alike(&self, folders: &[PathBuf]) -> Result<()> {
        if !self.variants.are_several() {
            return Ok(());
        }
        let named = folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(" ");
        let varied = self.variants.varied.join(", ");
        Err(Error::SeveralVariants(named, varied))
    }

    /// The records of a variant's runs.
    pub(crate) fn members(&self, variant: &Variant) -> Vec<&LoggedRun> {
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

/// The groups of which rates are compared: all, each kind, each severity.
pub(super) fn groups() -> impl Iterator<Item = (&'static str, Option<Kind>, Option<Severity>)> {
    let kinds = Kind::ALL.into_iter().map(|kind| (kind.name(), Some(kind), None));
    let severities = Severity::ALL.into_iter().map(|severity| (severity.name(), None, Some(severity)));
    std::iter::once(("all", None, None)).chain(kinds).chain(severities)
}
