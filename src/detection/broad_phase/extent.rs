//! Sums and maxima over one thread's share of the areas: how large they are, how far away, whether round.

use crate::geometry::{Bounds, Vector};
use crate::util::units::Metre;

/// A box further from the origin than this, along x or y, has no strip, in m; nothing on earth is.
pub(super) const FURTHEST: Metre = 3.3e7;

/// Sums and maxima over a share of the areas.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Sum of the sizes.
    pub sum: Metre,
    /// Largest length along x, and largest height.
    pub largest: Vector,
    /// Whether a box is too far away for a strip.
    pub far: bool,
    /// Whether an area is smaller than its box.
    pub round: bool,
    pub sorted: bool,
    /// Swaps while they were sorted.
    pub moved: usize,
}

impl Extent {
    pub const EMPTY: Self =
        Self { sum: 0.0, largest: Vector::new(0.0, 0.0), far: false, round: false, sorted: true, moved: 0 };

    /// Adds a box. One too far away only sets `far`.
    #[inline(always)]
    pub fn include(&mut self, laid: &Bounds) {
        if is_far(laid) {
            self.far = true;
            return;
        }
        let size = laid.size();
        self.sum += size.max().clamp(0.0, 1e3);
        self.largest = self.largest.sup(&size);
    }

    pub fn join(self, other: &Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            largest: self.largest.sup(&other.largest),
            far: self.far || other.far,
            round: self.round || other.round,
            sorted: self.sorted && other.sorted,
            moved: self.moved + other.moved,
        }
    }
}

/// Whether a side is too far from the origin for a strip.
#[inline]
pub(super) fn is_far(Bounds { low, high }: &Bounds) -> bool {
    [low.x, low.y, high.x, high.y].iter().any(|side| side.abs() >= FURTHEST)
}
