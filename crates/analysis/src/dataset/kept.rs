//! Conflicts of several runs, worst first; of many, only the worst are kept.

use std::cmp::Ordering;

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

/// Worst first; equal ones in the order of the logs.
fn worst_first(a: &RunConflict, b: &RunConflict) -> Ordering {
    let rank = |kept: &RunConflict| Rank::from(&kept.conflict);
    rank(b).cmp(&rank(a)).then_with(|| (a.run, a.conflict.id).cmp(&(b.run, b.conflict.id)))
}

/// The [`MOST`] worst conflicts: memory stays bounded however many there are.
#[derive(Debug, Default)]
pub(crate) struct KeptConflicts {
    kept: Vec<RunConflict>,
    seen: u64,
}

impl KeptConflicts {
    /// Adds a conflict.
    pub fn push(&mut self, conflict: RunConflict) {
        self.seen += 1;
        self.kept.push(conflict);
        if self.kept.len() >= MOST + WAITING {
            self.kept.select_nth_unstable_by(MOST, worst_first);
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
