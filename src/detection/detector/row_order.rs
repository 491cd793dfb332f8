//! The pairs that different threads have met, in the order of the frame's rows.

use super::worker::Worker;
use crate::detection::encounter::Encounter;

/// Counted together: so many rows have hardly more than a few encounters.
const TOGETHER: u32 = 16;

/// Brings encounters into order where they are; keeps its memory.
#[derive(Default)]
pub(super) struct Order {
    starts: Vec<u32>,
    sorted: Vec<RowPlace>,
}

/// Which rows met, the smaller first, and which of whose finds that is.
type RowPlace = ((u32, u32), u32, u32);

fn rows(found: &Encounter) -> (u32, u32) {
    (found.ego_row.min(found.foe_row), found.ego_row.max(found.foe_row))
}

impl Order {
    /// Sorts what the workers have met, between rows below `count`.
    ///
    /// Counting sort by the smaller row of each pair, some rows together; the few of these are then sorted by both.
    pub(super) fn sort(&mut self, count: usize, workers: &[Worker]) {
        let places = || {
            workers.iter().zip(0..).flat_map(|(worker, number)| {
                worker.found.encounters.iter().zip(0..).map(move |(found, index)| (rows(found), number, index))
            })
        };
        let start_of = |(first, _): (u32, u32)| (first / TOGETHER) as usize;
        self.starts.clear();
        self.starts.resize(count / TOGETHER as usize + 2, 0);
        for (rows, ..) in places() {
            self.starts[start_of(rows) + 1] += 1;
        }
        for start in 1..self.starts.len() {
            self.starts[start] += self.starts[start - 1];
        }
        self.sorted.clear();
        let found = self.starts.last().map_or(0, |end| *end as usize);
        self.sorted.resize(found, RowPlace::default());
        for found in places() {
            let place = &mut self.starts[start_of(found.0)];
            self.sorted[*place as usize] = found;
            *place += 1;
        }
        for together in self.sorted.chunk_by_mut(|a, b| start_of(a.0) == start_of(b.0)) {
            together.sort_unstable();
        }
    }

    /// Forgets those that are not to be kept.
    pub(super) fn retain(&mut self, workers: &mut [Worker], mut keep: impl FnMut(&mut Encounter) -> bool) {
        self.sorted.retain(|&(_, worker, index)| keep(&mut workers[worker as usize].found.encounters[index as usize]));
    }

    /// The sorted encounters of these workers.
    pub(super) fn sorted<'a>(&'a self, workers: &'a [Worker]) -> impl ExactSizeIterator<Item = &'a Encounter> + Clone {
        self.sorted.iter().map(|&(_, worker, index)| &workers[worker as usize].found.encounters[index as usize])
    }
}
