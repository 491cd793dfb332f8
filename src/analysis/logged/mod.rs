//! Logs read back: the folders, how each run was made, and its conflicts one by one.
//!
//! The one place that knows how a log is read; statistics, reports and comparisons take conflicts from here. A folder
//! is a log where it holds `conflicts.csv`, or `conflicts.parquet` as a sweep writes it; several may lie below one
//! folder, at any depth.

mod conflicts;
mod csv;
mod fields;
mod folders;
mod pack;
mod parquet;
mod reader;
mod run;

pub use conflicts::{LoggedConflict, LoggedSnapshot};
pub use folders::{SUMMARY, log_folders};
pub use pack::{Label, LabelValue, pack};
pub use parquet::{PARQUET, Packed};
pub use reader::ConflictReader;
pub use run::{LoggedRun, record};
