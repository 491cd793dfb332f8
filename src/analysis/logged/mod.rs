//! Logs read back: the folders, how each run was made, and its conflicts one by one.
//!
//! Statistics, reports and Python take conflicts from here. A folder is a log if it holds `conflicts.csv`, or
//! `conflicts.parquet` as a sweep writes it. Several logs may be below one folder, at any depth.

mod conflicts;
mod csv;
mod folders;
mod pack;
mod parquet;
mod reader;
mod run;

pub use folders::{SUMMARY, log_folders};
pub use pack::{Label, LabelValue, pack};
pub use parquet::{PARQUET, Packed};
pub use reader::ConflictReader;
pub use run::{LoggedRun, LoggedSummary, LoggedVersions, record};

pub use crate::output::schema::LoggedConflict;
