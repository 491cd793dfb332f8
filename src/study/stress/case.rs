//! One stress case: what it is about, and how it is checked.

use super::tally::{Group, Tally};
use crate::study::reference::chance::Chance;

/// One named case.
pub(super) struct Case {
    pub group: Group,
    pub name: &'static str,
    /// How many inputs of the others' one of this costs.
    pub cost: u64,
    pub check: fn(&mut Chance, &mut Tally),
}

impl Case {
    pub const fn new(group: Group, name: &'static str, check: fn(&mut Chance, &mut Tally)) -> Self {
        Self { group, name, cost: 1, check }
    }

    pub const fn costing(mut self, cost: u64) -> Self {
        self.cost = cost;
        self
    }
}
