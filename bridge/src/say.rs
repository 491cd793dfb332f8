//! Lines for a script's user, where Python's own messages go.

use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::prelude::*;

/// Whether this process was told that its SUMO is read slowly: a script may make thousands of checkers.
static WAS_TOLD: AtomicBool = AtomicBool::new(false);

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
