//! What the conflicts of one run add to the statistics of a set.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::counts::{ConflictGroup, Counts, MEASURES, Spot, measures};
use super::extremes::Tails;
use super::group::By;
use super::quantiles::quantile;
use super::worst::WorstOf;
use crate::analysis::filter::ConflictFilter;
use crate::analysis::logged::{ConflictReader, LoggedConflict, LostRows};
use crate::detection::kind::{Kind, Severity};
use crate::{Error, Result};

/// After this many conflicts the reader reports how far it is.
const EVERY: u64 = 4096;

/// What one run adds.
#[derive(Debug)]
pub struct OfRun {
    /// The file and its columns.
    pub path: PathBuf,
    /// The columns of the file.
    pub columns: Vec<String>,
    /// What is wrong with its rows as a whole.
    pub lost: Option<LostRows>,
    /// How many conflicts the log has.
    pub read: u64,
    /// How many of them count.
    pub passed: u64,
    /// The conflicts by group.
    pub groups: FxHashMap<String, ConflictGroup>,
    /// Counts by kind and severity.
    pub tallies: [[Counts; 3]; 3],
    /// Conflicts by edge.
    pub edges: FxHashMap<String, Spot>,
    /// Conflicts by junction.
    pub junctions: FxHashMap<String, Spot>,
    /// The median of each measure.
    pub medians: [Option<f64>; MEASURES.len()],
    /// The worst conflicts.
    pub worst: WorstOf,
    /// The most severe values.
    pub tails: Tails,
}

impl OfRun {
    /// Reads the log of the run with this number in a folder; reports to `progress` how many conflicts more it has read.
    ///
    /// # Errors
    /// An error that names the file and its line: missing, not a log, empty, cut short, without a column that `by` needs.
    pub fn read(
        (run, folder): (usize, &Arc<Path>),
        by: By,
        filter: &ConflictFilter,
        worst: usize,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Self> {
        let mut reader = ConflictReader::open(folder)?;
        let columns = reader.columns();
        if let Some(needed) = by.needs().filter(|needed| !columns.iter().any(|column| column == needed)) {
            let message = format!("the column \"{needed}\" is missing: logs of earlier versions do not have it");
            return Err(Error::line(reader.path(), 1, message));
        }
        let mut found = Self {
            path: reader.path().to_owned(),
            columns,
            lost: None,
            read: 0,
            passed: 0,
            groups: FxHashMap::default(),
            tallies: Default::default(),
            edges: FxHashMap::default(),
            junctions: FxHashMap::default(),
            medians: Default::default(),
            worst: WorstOf::new(worst),
            tails: Tails::default(),
        };
        for conflict in &mut reader {
            let conflict = conflict?;
            found.read += 1;
            if found.read.is_multiple_of(EVERY) {
                progress(EVERY);
            }
            if filter.passes(&conflict) {
                found.add((run, folder), &conflict, by);
            }
        }
        progress(found.read % EVERY);
        found.lost = reader.lost();
        found.medians = std::array::from_fn(|measure| {
            let values = found.groups.values().flat_map(|group| &group.columns[measure]);
            let mut values = values.copied().collect::<Vec<_>>();
            values.sort_unstable_by(f64::total_cmp);
            quantile(&values, 0.5)
        });
        Ok(found)
    }

    fn add(&mut self, (run, folder): (usize, &Arc<Path>), conflict: &LoggedConflict, by: By) {
        self.passed += 1;
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
                    spot.crashes.add(run, conflict.crash_probability.unwrap_or_default());
                });
            }
        }
        self.worst.take(run, folder, conflict);
        self.tails.take(conflict);
    }
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
