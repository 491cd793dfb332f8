//! A buffer of candidate pairs. Whether two boxes overlap is unpredictable, so candidate pairs are buffered without a
//! branch.

use super::place::StripEntry;
use crate::geometry::Bounds;

/// Capacity in pairs.
const CAPACITY: usize = 64;

/// Slots of pairs whose boxes meet.
pub(super) struct PairBuffer<'a> {
    boxes: &'a [Bounds],
    pairs: [(u32, u32); CAPACITY],
    count: usize,
}

impl<'a> PairBuffer<'a> {
    pub(super) fn new(boxes: &'a [Bounds]) -> Self {
        Self { boxes, pairs: [(0, 0); CAPACITY], count: 0 }
    }

    /// Adds the pairs of `a` and the others whose boxes meet its own.
    #[inline(always)]
    pub(super) fn push<'b>(
        &mut self,
        a: &StripEntry,
        others: impl Iterator<Item = &'b StripEntry>,
        found: &mut impl FnMut(u32, u32),
    ) {
        let laid = self.boxes[a.slot as usize];
        for b in others {
            if self.count == CAPACITY {
                self.flush(found);
            }
            self.pairs[self.count] = (a.slot, b.slot);
            self.count += usize::from(laid.meet(&self.boxes[b.slot as usize]));
        }
    }

    /// Passes all pairs on and empties the buffer.
    pub(super) fn flush(&mut self, found: &mut impl FnMut(u32, u32)) {
        self.pairs[..self.count].iter().for_each(|(a, b)| found(*a, *b));
        self.count = 0;
    }
}
