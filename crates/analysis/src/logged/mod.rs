//! Logs read back: the folders, how each run was made, and its conflicts one by one.
//!
//! Statistics, reports and Python take conflicts from here. A folder is a log if it holds `conflicts.csv`, or
//! `conflicts.parquet` as a sweep writes it. Several logs may be below one folder, at any depth.

mod conflict_selector;
mod conflicts_csv;
mod folders;
mod group_column;
mod pack;
mod packed;
mod parquet;
mod plausible;
mod reader;
mod reading;
mod run;

pub use conflict_selector::{ConflictSelector, with_ids, worst};
pub use folders::{PARQUET, SUMMARY, check_keeps_logs, log_folders};
pub use pack::{Label, LabelValue, pack, pack_in_place};
pub use packed::{Packed, RunTime};
pub use reader::{ConflictReader, LostRows, check_none_lost};
pub use reading::{Progress, Reading};
pub use run::{LoggedRun, record};

pub use closecall_run::output::schema::LoggedConflict;
