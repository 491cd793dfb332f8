//! The encounters of all threads, in the order of the frame's rows.

use super::worker::Worker;
use crate::detection::encounter::Encounter;

/// Rows counted together: this many rows rarely have more than a few encounters.
const ROWS_PER_BIN: u32 = 16;

/// Orders encounters without moving them; keeps its allocations.
#[derive(Default)]
pub(super) struct RowOrder {
    starts: Vec<u32>,
    sorted: Vec<SortKey>,
}

/// The two rows, the smaller first; the worker, and the index among its encounters.
type SortKey = ((u32, u32), u32, u32);

fn rows(found: &Encounter) -> (u32, u32) {
    (found.ego_row.min(found.foe_row), found.ego_row.max(found.foe_row))
}

impl RowOrder {
    /// Sorts the workers' encounters, between rows below `count`.
    ///
    /// Counting sort by the smaller row of each pair, [`ROWS_PER_BIN`] rows to a bin; each bin is then sorted by both rows.
    pub(super) fn sort(&mut self, count: usize, workers: &[Worker]) {
        let places = || {
            workers.iter().zip(0..).flat_map(|(worker, number)| {
                worker.found.encounters.iter().zip(0..).map(move |(found, index)| (rows(found), number, index))
            })
        };
        let start_of = |(first, _): (u32, u32)| (first / ROWS_PER_BIN) as usize;
        self.starts.clear();
        self.starts.resize(count / ROWS_PER_BIN as usize + 2, 0);
        for (rows, ..) in places() {
            self.starts[start_of(rows) + 1] += 1;
        }
        for start in 1..self.starts.len() {
            self.starts[start] += self.starts[start - 1];
        }
        self.sorted.clear();
        let found = self.starts.last().map_or(0, |end| *end as usize);
        self.sorted.resize(found, SortKey::default());
        for found in places() {
            let place = &mut self.starts[start_of(found.0)];
            self.sorted[*place as usize] = found;
            *place += 1;
        }
        for together in self.sorted.chunk_by_mut(|a, b| start_of(a.0) == start_of(b.0)) {
            together.sort_unstable();
        }
    }

    /// Keeps only the encounters for which `keep` returns true.
    pub(super) fn retain(&mut self, workers: &mut [Worker], mut keep: impl FnMut(&mut Encounter) -> bool) {
        self.sorted.retain(|&(_, worker, index)| keep(&mut workers[worker as usize].found.encounters[index as usize]));
    }

    /// The sorted encounters of these workers.
    pub(super) fn sorted<'a>(&'a self, workers: &'a [Worker]) -> impl ExactSizeIterator<Item = &'a Encounter> + Clone {
        self.sorted.iter().map(|&(_, worker, index)| &workers[worker as usize].found.encounters[index as usize])
    }
}
