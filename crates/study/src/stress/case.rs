//! A stress case: its group, its name, and its check.

use super::tally::{Group, Tally};
use crate::reference::chance::Chance;

/// A named case.
pub(super) struct Case {
    pub group: Group,
    pub name: &'static str,
    /// The cost of one input, relative to those of ordinary cases.
    pub cost: u64,
    pub check: fn(&mut Chance, &mut Tally),
}

impl Case {
    pub const fn new(group: Group, name: &'static str, check: fn(&mut Chance, &mut Tally)) -> Self {
        Self { group, name, cost: 1, check }
    }

    pub(crate) const fn costing(mut self, cost: u64) -> Self {
        self.cost = cost;
        self
    }
}
