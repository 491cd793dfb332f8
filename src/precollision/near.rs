//! Notes of pairs that are near each other: whose boxes meet is a matter of chance, which no processor could guess, so it is
//! not asked before there are many.

use super::Area;
use super::place::Place;

/// So many pairs are noted before their circles decide.
const NOTED: usize = 64;

/// Slots of two whose boxes meet.
pub(super) struct Near<'a> {
    areas: &'a [Area],
    pairs: [(u32, u32); NOTED],
    count: usize,
}

impl<'a> Near<'a> {
    pub(super) fn new(areas: &'a [Area]) -> Self {
        Self { areas, pairs: [(0, 0); NOTED], count: 0 }
    }

    /// Notes the others whose boxes meet that of `a`.
    #[inline(always)]
    pub(super) fn note<'b>(
        &mut self,
        a: &Place,
        others: impl Iterator<Item = &'b Place>,
        found: &mut impl FnMut(u32, u32),
    ) {
        let bounds = &self.areas[a.slot as usize].bounds;
        for b in others {
            if self.count == NOTED {
                self.decide(found);
            }
            self.pairs[self.count] = (a.slot, b.slot);
            self.count += usize::from(bounds.meet(&self.areas[b.slot as usize].bounds));
        }
    }

    /// Whether the circles of those noted meet too; forgets them.
    pub(super) fn decide(&mut self, found: &mut impl FnMut(u32, u32)) {
        for (a, b) in &self.pairs[..self.count] {
            if self.areas[*a as usize].circles_meet(&self.areas[*b as usize]) {
                found(*a, *b);
            }
        }
        self.count = 0;
    }
}
