//! `closecall sweep`: hands the tasks to Dask and reports their results.

use std::path::{Path, PathBuf};

use closecall_analysis::batch::sweep::Task;
use closecall_analysis::logged::RunTime;
use closecall_cli::{ReportEnd, Workers};
use closecall_run::{Error, Result};
use pyo3::exceptions::{PyImportError, PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;

use crate::error::{exception, message};

/// Adds the log of a task's run to the sweep's data set. The run took `wall` s, and `cpu` s of all processors together.
#[pyfunction]
pub fn finish_run(py: Python, task: &str, log: PathBuf, wall: f64, cpu: f64) -> PyResult<()> {
    let task: Task = serde_json::from_str(task).map_err(|error| PyValueError::new_err(error.to_string()))?;
    py.detach(|| task.finish(&log, RunTime { wall, cpu })).map_err(exception)
}

/// Has `closecall.sweep` do the tasks.
pub fn distribute(
    py: Python,
    workers: &Workers,
    folder: &Path,
    tasks: &[&Task],
    report_end: &mut ReportEnd,
) -> Result<()> {
    let failed = |error: PyErr| {
        if error.is_instance_of::<PyKeyboardInterrupt>(py) {
            Error::Stopped
        } else if error.is_instance_of::<PyImportError>(py) {
            let why = message(py, &error);
            Error::Value(format!("Dask is not installed ({why}): pip install 'closecall[sweep]'"))
        } else {
            Error::Value(message(py, &error))
        }
    };
    let packed = |task: &&Task| -> Result<_> {
        let json = serde_json::to_string(task).map_err(|error| Error::Value(error.to_string()))?;
        Ok((task.name.clone(), task.args.clone(), json))
    };
    let tasks = tasks.iter().map(packed).collect::<Result<Vec<_>>>()?;
    let (workers, scheduler) = match workers {
        Workers::Local(workers) => (*workers, None),
        Workers::Scheduler(address) => (0, Some(address)),
    };
    let results = py.import("closecall.sweep").map_err(failed)?;
    let results = results.call_method1("results", (tasks, folder, workers, scheduler)).map_err(failed)?;
    for result in results.try_iter().map_err(failed)? {
        let result = result.and_then(|result| result.extract::<(String, Option<String>)>());
        let (name, error) = result.map_err(failed)?;
        report_end(&name, error.as_deref());
    }
    Ok(())
}
