//! Films of clips: pictures go to Python packages that few users need, and so are not part of closecall.

use closecall_cli::FilmRequest;
use closecall_run::{Error, Result};
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::message;

/// The film's file.
pub fn film(py: Python, request: &FilmRequest) -> Result<Vec<u8>> {
    let FilmRequest { pictures, rate, format, font } = request;
    let make = || -> PyResult<Vec<u8>> {
        let maker = py.import("closecall._film")?;
        maker.call_method1("film", (pictures, rate, format, PyBytes::new(py, font)))?.extract()
    };
    make().map_err(|error| {
        let why = message(py, &error);
        Error::Value(if error.is_instance_of::<PyImportError>(py) {
            format!("a film needs packages that are not installed ({why}): pip install 'closecall[video]'; a .svg needs none")
        } else {
            format!("the film cannot be made: {why}")
        })
    })
}
