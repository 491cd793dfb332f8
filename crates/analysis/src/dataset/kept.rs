//! Conflicts of several runs, worst first; of many, only the worst are kept.

use std::cmp::{Ordering, Reverse};

use closecall_run::output::rank::Rank;
use closecall_run::output::schema::LoggedConflict;

/// The most conflicts that are kept.
pub const MOST: usize = 300_000;
/// Conflicts beyond that are sorted out in batches of this size: each takes over a kilobyte.
const WAITING: usize = MOST / 8;

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

/// The [`MOST`] worst conflicts: memory stays bounded however many there are.
#[derive(Debug, Default)]
pub(crate) struct KeptConflicts {
    kept: Vec<RunConflict>,
    /// As many as are kept are worse than this.
    bound: Option<Key>,
    seen: u64,
}

impl KeptConflicts {
    /// Adds a conflict; copies it only if it may be kept.
    pub fn push(&mut self, run: u32, conflict: &LoggedConflict) {
        self.seen += 1;
        if self.bound.is_some_and(|bound| key(run, conflict) >= bound) {
            return;
        }
        self.kept.push(RunConflict { run, conflict: conflict.clone() });
        if self.kept.len() >= MOST + WAITING {
            let (_, bound, _) = self.kept.select_nth_unstable_by(MOST, worst_first);
            self.bound = Some(key(bound.run, &bound.conflict));
            self.kept.truncate(MOST);
        }
    }

    /// How many conflicts were added.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The conflicts that are kept, worst first.
    pub(crate) fn into_sorted(mut self) -> Vec<RunConflict> {
        self.kept.sort_unstable_by(worst_first);
        self.kept.truncate(MOST);
        self.kept
    }
}
