//! Conflicts of several runs, worst first; of many, only the worst are kept.

use std::cmp::Reverse;

use super::conflict_table::ConflictTable;
use closecall::detection::kind::{Kind, Severity};
use closecall_run::output::rank::Rank;
use closecall_run::output::schema::LoggedConflict;

/// The most conflicts that are kept for a report or a picture.
pub const MOST: usize = 300_000;
/// Conflicts beyond the most are sorted out in batches of this part of them: each takes over half a kilobyte.
const BATCH: usize = 16;

/// A conflict of a [`ConflictTable`], and the run that it is of. Sorted, they are in the order of the logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RunConflict {
    /// Place of the run among the logs.
    pub run: u32,
    /// The conflict's number in its log.
    pub id: u64,
    /// Its kind.
    pub kind: Kind,
    /// Its severity.
    pub severity: Severity,
    /// Its row in the table.
    pub row: u32,
}

impl RunConflict {
    /// What finds it among the logs.
    pub fn key(&self) -> (u32, u64) {
        (self.run, self.id)
    }
}

/// Sorted, the worst comes first; equal ones are in the order of the logs.
type Ranked = (Reverse<Rank>, RunConflict);

/// The worst conflicts: memory stays bounded however many there are.
#[derive(Debug)]
pub(crate) struct KeptConflicts {
    most: usize,
    kept: Vec<Ranked>,
    table: ConflictTable,
    /// Rows of the table whose conflicts are no longer kept.
    free: Vec<u32>,
    /// As many as are kept are worse than this.
    bound: Option<Ranked>,
    seen: u64,
}

impl KeptConflicts {
    /// Keeps this many at most.
    pub fn new(most: usize) -> Self {
        Self { most, kept: Vec::new(), table: ConflictTable::default(), free: Vec::new(), bound: None, seen: 0 }
    }

    /// Adds a conflict; copies it only if it may be kept.
    pub fn push(&mut self, run: u32, conflict: &LoggedConflict) {
        self.seen += 1;
        let LoggedConflict { id, kind, severity, .. } = *conflict;
        let row = self.free.last().copied().unwrap_or(self.kept.len() as u32);
        let ranked = (Reverse(conflict.into()), RunConflict { run, id, kind, severity, row });
        if self.bound.is_some_and(|bound| ranked >= bound) {
            return;
        }
        self.free.pop();
        self.table.set(row, conflict);
        self.kept.push(ranked);
        if self.kept.len() > self.most + self.most / BATCH {
            let (_, bound, _) = self.kept.select_nth_unstable(self.most);
            self.bound = Some(*bound);
            self.free.extend(self.kept.drain(self.most..).map(|(_, one)| one.row));
        }
    }

    /// How many conflicts were added.
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The conflicts that are kept, worst first, and the table that has their rows.
    pub(crate) fn into_sorted(mut self) -> (Vec<RunConflict>, ConflictTable) {
        self.kept.sort_unstable();
        self.kept.truncate(self.most);
        (self.kept.into_iter().map(|(_, one)| one).collect(), self.table)
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
            let (cause, t2) = (["", "stood"][number as usize % 2], ["", "2.5"][number as usize / 150]);
            let values = [("id", &*number.to_string()), ("ttc", &ttc), ("cause", cause), ("t2", t2), ("lon", "")];
            (number % 3, sample(&values).unwrap())
        });
        let mut all = conflicts.collect::<Vec<_>>();
        let mut kept = KeptConflicts::new(20);
        all.iter().for_each(|(run, conflict)| kept.push(*run, conflict));
        assert_eq!(kept.seen(), 200);
        all.sort_by_key(|(run, conflict)| (Reverse(Rank::from(conflict)), *run, conflict.id));
        let (kept, table) = kept.into_sorted();
        let kept = kept.iter().map(|one| (one.run, table.conflict(one.row).unwrap())).collect::<Vec<_>>();
        assert_eq!(kept, all[..20]);
    }
}
