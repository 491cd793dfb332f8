//! Conflicts of several runs, worst first; of many, only the worst are kept.

use std::cmp::{Ordering, Reverse};

use closecall_run::output::rank::Rank;
use closecall_run::output::schema::LoggedConflict;

/// The most conflicts that are kept for a report or a picture.
pub const MOST: usize = 300_000;
/// Conflicts beyond the most are sorted out in batches of this part of them: each takes over a kilobyte.
const BATCH: usize = 8;

/// A conflict, and the run that it is of.
#[derive(Clone, Debug)]
pub(crate) struct RunConflict {
    /// Place of the run among the logs.
    pub run: u32,
    /// The conflict, with its snapshots.
    pub conflict: LoggedConflict,
}

/// What conflicts are sorted by, worst first; equal ones in the order of the logs.
type Key = (Reverse<Rank>, u32, u64);

fn key(run: u32, conflict: &LoggedConflict) -> Key {
    (Reverse(conflict.into()), run, conflict.id)
}

fn worst_first(a: &RunConflict, b: &RunConflict) -> Ordering {
    key(a.run, &a.conflict).cmp(&key(b.run, &b.conflict))
}

/// The worst conflicts: memory stays bounded however many there are.
#[derive(Debug)]
pub(crate) struct KeptConflicts {
    most: usize,
    kept: Vec<RunConflict>,
    /// As many as are kept are worse than this.
    bound: Option<Key>,
    seen: u64,
}

impl KeptConflicts {
    /// Keeps this many at most.
    pub fn new(most: usize) -> Self {
        Self { most, kept: Vec::new(), bound: None, seen: 0 }
    }

    /// Adds a conflict; copies it only if it may be kept.
    pub fn push(&mut self, run: u32, conflict: &LoggedConflict) {
        self.seen += 1;
        if self.bound.is_some_and(|bound| key(run, conflict) >= bound) {
            return;
        }
        self.kept.push(RunConflict { run, conflict: conflict.clone() });
        if self.kept.len() > self.most + self.most / BATCH {
            let (_, bound, _) = self.kept.select_nth_unstable_by(self.most, worst_first);
            self.bound = Some(key(bound.run, &bound.conflict));
            self.kept.truncate(self.most);
        }
    }

    /// How many conflicts were added.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The conflicts that are kept, worst first.
    pub(crate) fn into_sorted(mut self) -> Vec<RunConflict> {
        self.kept.sort_unstable_by(worst_first);
        self.kept.truncate(self.most);
        self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall_run::output::sample_conflict::sample;

    #[test]
    fn the_worst_are_kept_in_whatever_order_they_come() {
        let conflicts = (0..200_u32).map(|number| {
            let ttc = f64::from(number.wrapping_mul(73) % 200 / 3).to_string();
            let conflict = sample(&[("id", &number.to_string()), ("ttc", &ttc)]).unwrap();
            RunConflict { run: number % 3, conflict }
        });
        let mut all = conflicts.collect::<Vec<_>>();
        let mut kept = KeptConflicts::new(20);
        all.iter().for_each(|one| kept.push(one.run, &one.conflict));
        assert_eq!(kept.seen(), 200);
        all.sort_by(worst_first);
        let of = |found: &[RunConflict]| found.iter().map(|one| one.conflict.id).collect::<Vec<_>>();
        assert_eq!(of(&kept.into_sorted()), of(&all[..20]));
    }
}
