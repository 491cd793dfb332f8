//! Logs read back: the folders, how each run was made, and its conflicts one by one.
//!
//! The one place that knows how a log is read; statistics, reports and comparisons take conflicts from here. A folder
//! is a log where it holds `conflicts.csv`; several may lie below one folder, at any depth, as a sweep writes them.

mod conflicts;
mod folders;
mod run;

pub use conflicts::{ConflictReader, LoggedConflict};
pub use folders::log_folders;
pub use run::{LoggedRun, LoggedSummary, LoggedVersions};
