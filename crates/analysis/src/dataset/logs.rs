//! The records of logs.

use std::path::Path;

use crate::logged::{self, LoggedRun, PARQUET};
use crate::{Error, Result};
use closecall_run::output::log::RUN;

/// A log's `run.json`; null where there is none.
pub fn record(log: &Path) -> Result<serde_json::Value> {
    if !log.join(RUN).is_file() && !log.join(PARQUET).is_file() {
        return Ok(serde_json::Value::Null);
    }
    let (path, text) = logged::record(log)?;
    serde_json::from_str(&text).map_err(|error| Error::content(&path, format!("it is not JSON: {error}")))
}

/// How a run was made; none where its record is not that of a log.
pub fn run(record: &serde_json::Value) -> Option<LoggedRun> {
    serde_json::from_value(record.clone()).ok()
}
