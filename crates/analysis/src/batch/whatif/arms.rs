//! The arms of a conflict, and the runs in them.

use crate::batch::sweep::Task;
use closecall_run::run::roll_out::Outcome;

/// The arms: runs of a conflict that differ in the same way from the others.
pub(super) const BASELINE: &str = "baseline";
pub(super) const ERROR: &str = "error";
pub(super) const ANSWERED: &str = "answered";
pub(super) const FILMED: &str = "filmed";

/// A roll-out that has ended.
#[derive(Debug)]
pub(super) struct RolledOut {
    pub number: u32,
    pub task: Task,
    pub outcome: Outcome,
}

/// The name of a run, or its beginning.
pub(super) fn name_of(conflict: u64, arm: &str, number: &str) -> String {
    format!("conflict-{conflict}_{arm}-{number}")
}
