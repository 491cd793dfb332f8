//! Slots: where in the search's memory somebody is.

/// What stands in a slot of a [`Search`](super::Search).
pub trait Slot: Clone + Default + Send {
    /// Which of the caller's items has the slot, in this step.
    fn item(&self) -> u32;

    /// Gives the slot to another.
    fn give(&mut self, item: u32);

    /// Whose item it was last, by a small number that stays the same from step to step.
    fn who(&self) -> u32;
}

/// The item is all that is known.
impl Slot for u32 {
    fn item(&self) -> u32 {
        *self
    }

    fn give(&mut self, item: u32) {
        *self = item;
    }

    fn who(&self) -> u32 {
        *self
    }
}
