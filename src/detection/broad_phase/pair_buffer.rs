//! Notes of pairs that are near each other: whose boxes meet is a matter of chance, and a processor that had to guess it would
//! guess wrong for each road user. So nothing depends on it before there are many.

use super::place::Place;
use crate::geometry::Bounds;

/// So many pairs are noted before they are told.
const NOTED: usize = 64;

/// Slots of two whose boxes meet.
pub(super) struct Near<'a> {
    boxes: &'a [Bounds],
    pairs: [(u32, u32); NOTED],
    count: usize,
}

impl<'a> Near<'a> {
    pub(super) fn new(boxes: &'a [Bounds]) -> Self {
        Self { boxes, pairs: [(0, 0); NOTED], count: 0 }
    }

    /// Notes the others whose boxes meet that of `a`.
    #[inline(always)]
    pub(super) fn note<'b>(
        &mut self,
        a: &Place,
        others: impl Iterator<Item = &'b Place>,
        found: &mut impl FnMut(u32, u32),
    ) {
        let laid = self.boxes[a.slot as usize];
        for b in others {
            if self.count == NOTED {
                self.tell(found);
            }
            self.pairs[self.count] = (a.slot, b.slot);
            self.count += usize::from(laid.meet(&self.boxes[b.slot as usize]));
        }
    }

    /// Tells those noted, and forgets them.
    pub(super) fn tell(&mut self, found: &mut impl FnMut(u32, u32)) {
        self.pairs[..self.count].iter().for_each(|(a, b)| found(*a, *b));
        self.count = 0;
    }
}
