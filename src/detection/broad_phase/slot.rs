//! Slots: where the search keeps what it knows of a road user.

/// The content of a slot of a [`Search`](super::Search).
pub trait Slot: Clone + Default + Send {
    /// The caller's item that has the slot in this step.
    fn item(&self) -> u32;

    /// Assigns the slot to another item.
    fn set_item(&mut self, item: u32);

    /// The road user whose item it was last, by a small number that does not change between steps.
    fn who(&self) -> u32;
}

/// A slot that holds its item only.
impl Slot for u32 {
    fn item(&self) -> u32 {
        *self
    }

    fn set_item(&mut self, item: u32) {
        *self = item;
    }

    fn who(&self) -> u32 {
        *self
    }
}
