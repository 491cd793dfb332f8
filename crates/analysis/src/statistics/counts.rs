//! Conflicts that are counted together: those of a group, those of a place.

use super::weighted::WeightedEvents;
use crate::logged::LoggedConflict;

/// The measures whose values are kept, by their names in every output; ΔV is the larger of the two.
pub(crate) const MEASURES: [&str; 4] = ["ttc", "pet", "margin", "delta_v"];

/// The values of the [`MEASURES`].
pub type Columns = [Vec<f64>; MEASURES.len()];

/// The number of conflicts per run, for the runs that had any, in the order of the runs.
#[derive(Clone, Debug, Default)]
pub struct Counts(Vec<(u32, u64)>);

impl Counts {
    /// Adds a conflict of a run; runs come in their order.
    pub fn add(&mut self, run: usize) {
        match self.0.last_mut() {
            Some((last, count)) if *last as usize == run => *count += 1,
            _ => self.0.push((run as u32, 1)),
        }
    }

    /// Adds the counts of later runs.
    pub fn append(&mut self, later: &mut Self) {
        self.0.append(&mut later.0);
    }

    /// The counts with one entry per run.
    pub(crate) fn per_run(&self, runs: usize) -> Vec<f64> {
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

impl ConflictGroup {
    /// Adds the conflicts of later runs.
    pub fn append(&mut self, mut later: Self) {
        self.counts.append(&mut later.counts);
        self.collisions += later.collisions;
        self.columns.iter_mut().zip(&mut later.columns).for_each(|(values, more)| values.append(more));
    }
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

impl Spot {
    /// Adds the conflicts of later runs.
    pub fn append(&mut self, mut later: Self) {
        self.counts.append(&mut later.counts);
        self.severities.iter_mut().zip(later.severities).for_each(|(count, more)| *count += more);
        self.crashes.append(later.crashes);
    }
}

/// The values of a conflict.
pub fn measures(conflict: &LoggedConflict) -> [Option<f64>; MEASURES.len()] {
    [conflict.ttc, conflict.pet, Some(conflict.margin), Some(conflict.delta_v())]
}
