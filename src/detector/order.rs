//! The pairs that different threads have met, in the order of the frame's rows.

use super::worker::Worker;
use crate::encounter::Encounter;
use crate::table::fill;

/// Brings encounters into order where they are; keeps its memory.
#[derive(Default)]
pub(super) struct Order {
    starts: Vec<u32>,
    sorted: Vec<Place>,
}

/// Which rows met, the smaller first, and which of whose finds that is.
type Place = ((u32, u32), u32, u32);

fn rows(found: &Encounter) -> (u32, u32) {
    (found.ego_row.min(found.foe_row), found.ego_row.max(found.foe_row))
}

impl Order {
    /// Sorts what the workers have met, between rows below `count`.
    ///
    /// Counting sort by the smaller row of each pair; the few of one row are then sorted by the other.
    pub(super) fn sort(&mut self, count: usize, workers: &[Worker]) {
        let places = || {
            workers.iter().zip(0..).flat_map(|(worker, number)| {
                worker.found.encounters.iter().zip(0..).map(move |(found, index)| (rows(found), number, index))
            })
        };
        self.starts.clear();
        fill(&mut self.starts, count + 1, 0);
        for ((first, _), ..) in places() {
            self.starts[first as usize + 1] += 1;
        }
        for row in 0..count {
            self.starts[row + 1] += self.starts[row];
        }
        self.sorted.clear();
        fill(&mut self.sorted, self.starts[count] as usize, Place::default());
        for found in places() {
            let place = &mut self.starts[found.0.0 as usize];
            self.sorted[*place as usize] = found;
            *place += 1;
        }
        for of_one_row in self.sorted.chunk_by_mut(|a, b| a.0.0 == b.0.0) {
            of_one_row.sort_unstable();
        }
    }

    /// The sorted encounters of these workers.
    pub(super) fn sorted<'a>(&'a self, workers: &'a [Worker]) -> impl ExactSizeIterator<Item = &'a Encounter> {
        self.sorted.iter().map(|&(_, worker, index)| &workers[worker as usize].found.encounters[index as usize])
    }
}
