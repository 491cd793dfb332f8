//! Lines for a script's user, where Python's own messages go.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

/// Whether this process was told that its SUMO is read slowly: a script may make thousands of checkers.
static WAS_TOLD: AtomicBool = AtomicBool::new(false);
/// The old names of options that this process was told of.
static OLD_NAMES: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Writes a line; nowhere in a process that has no standard error.
pub fn line(py: Python, line: &str) -> PyResult<()> {
    let stderr = py.import("sys")?.getattr("stderr")?;
    if !stderr.is_none() {
        stderr.call_method1("write", (format!("closecall: {line}\n"),))?;
    }
    Ok(())
}

/// Writes the line on how SUMO is read, the first time in this process.
pub fn how_sumo_is_read(py: Python, remark: &str) -> PyResult<()> {
    if WAS_TOLD.swap(true, Ordering::Relaxed) { Ok(()) } else { line(py, remark) }
}

/// Writes the line on an option's old name, the first time in this process.
pub fn old_name(py: Python, remark: String) -> PyResult<()> {
    let is_new = OLD_NAMES.lock().unwrap_or_else(PoisonError::into_inner).insert(remark.clone());
    if is_new { line(py, &remark) } else { Ok(()) }
}
