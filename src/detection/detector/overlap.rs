//! How deep two road users overlap, and from what depth on that is a collision.

use super::step::StepInputs;
use crate::detection::narrow_phase::{Participant, side};
use crate::util::units::Metre;

/// How deep a pair overlaps now, and whether that is a collision. Up to the contact tolerance it is a graze: both are then
/// taken to be smaller, so that only what brings them deeper into each other counts.
#[derive(Clone, Copy, Default)]
pub(super) struct Overlap {
    pub depth: Metre,
    pub collision: bool,
    /// How much smaller both are taken to be on every side.
    pub shrinks: Metre,
}

/// How much smaller both of a pair are taken to be on every side, so that an overlap of this depth parts: an obstacle does
/// not shrink.
pub(super) fn shrinks(tolerance: Metre, second: &Participant) -> Metre {
    if second.shape.is_empty() { tolerance / 2.0 } else { tolerance }
}

impl StepInputs<'_> {
    /// How deep a pair overlaps now.
    pub(super) fn overlap(&self, slots: [u32; 2], [first, second]: &[Participant; 2]) -> Overlap {
        if !side::touch_now(first, second) {
            return Overlap::default();
        }
        let depth = side::overlap_now(first, second);
        let tolerance = self.tolerance(slots, [0.0; 2]);
        Overlap { depth, collision: depth > tolerance || tolerance == 0.0, shrinks: shrinks(tolerance, second) }
    }

    /// How deep two may overlap without colliding: where the lanes under them, and so far ahead, overlap as drawn, by more.
    pub(super) fn tolerance(&self, slots: [u32; 2], ahead: [Metre; 2]) -> Metre {
        match self.options.contact_tolerance {
            0.0 => 0.0,
            tolerance => tolerance + self.drawn_overlap(slots, ahead),
        }
    }

    /// By how much the lanes under two vehicles, and so far ahead, overlap as drawn.
    fn drawn_overlap(&self, slots: [u32; 2], ahead: [Metre; 2]) -> Metre {
        if self.overlaps.is_empty() {
            return 0.0;
        }
        let lanes = [0, 1].map(|one| {
            let user = self.user(slots[one]);
            let path = self.paths.of(user.index).filter(|path| !path.track.is_empty());
            path.map(|path| path.lanes_between(self.paths.of_net(), -self.profile(user).length, ahead[one]))
                .unwrap_or_default()
        });
        let widths = slots.map(|slot| self.profile(self.user(slot)).width);
        self.overlaps.drawn_overlap_of([&lanes[0], &lanes[1]], widths)
    }
}
