//! What is learnt of a part of the areas while they are laid, and sorted: how large, how far away, whether round.

use super::strips::is_far;
use crate::geometry::{Bounds, Vector};
use crate::util::units::Metre;

/// What is known of a part of the places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Sum of the sizes.
    pub sum: Metre,
    /// Largest length along x, and largest height.
    pub largest: Vector,
    /// Whether one is too far away for a strip.
    pub far: bool,
    /// Whether one is smaller than its box.
    pub round: bool,
    pub sorted: bool,
    /// How often two changed places while they were sorted.
    pub moved: usize,
}

impl Extent {
    pub const EMPTY: Self =
        Self { sum: 0.0, largest: Vector::new(0.0, 0.0), far: false, round: false, sorted: true, moved: 0 };

    /// Takes a box in; of one too far away only that is known.
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
