//! closecall's errors as Python's own kinds of exception, and Python's as closecall's.

use closecall_run::Error as RunError;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// The exception for an error: an `OSError` for files, a `RuntimeError` if SUMO or closecall itself failed, otherwise a `ValueError`.
pub fn exception(error: impl Into<closecall_cli::Error>) -> PyErr {
    let error = match error.into() {
        closecall_cli::Error::Run(error) => error,
        other => return PyValueError::new_err(other.to_string()),
    };
    match error {
        RunError::File { path, source } => {
            let text = source.to_string();
            match source.raw_os_error() {
                // From the number Python derives the subclass, such as FileNotFoundError.
                Some(number) => PyOSError::new_err((number, text, path)),
                None => PyOSError::new_err(format!("{}: {text}", path.display())),
            }
        }
        error @ (RunError::Refused { .. } | RunError::Failed { .. } | RunError::Internal(_)) => {
            PyRuntimeError::new_err(error.to_string())
        }
        other => PyValueError::new_err(other.to_string()),
    }
}

/// The message of an exception, as one line.
pub fn message(py: Python, exception: &PyErr) -> String {
    exception.value(py).to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ")
}
