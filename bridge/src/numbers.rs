//! Arrays of numbers from Python: anything but real numbers is refused, not converted.

use numpy::{PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods, ndarray::ArrayD};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// NumPy's kinds of real numbers, and of objects that may be some.
const REAL: &[u8] = b"biufO";

/// A copy of the numbers, which nothing in Python can change any more.
pub fn numbers(name: &str, values: &Bound<PyAny>) -> PyResult<ArrayD<f64>> {
    let py = values.py();
    refuse_masked(name, values)?;
    let array = py.import("numpy")?.call_method1("asarray", (values,))?;
    let dtype = array.cast::<PyUntypedArray>()?.dtype();
    if !REAL.contains(&dtype.kind()) {
        return Err(PyValueError::new_err(format!("\"{name}\" is of {dtype}; it must be of real numbers")));
    }
    let copy = array.call_method1("astype", ("float64",))?;
    Ok(copy.cast::<PyArrayDyn<f64>>()?.readonly().as_array().to_owned())
}

/// Refuses a masked array: what stands under a mask is not a value.
pub fn refuse_masked(name: &str, values: &Bound<PyAny>) -> PyResult<()> {
    let is_masked = |class: Bound<PyAny>| class.getattr("__name__").is_ok_and(|name| name.to_string() == "MaskedArray");
    if values.get_type().mro().iter().any(is_masked) {
        return Err(PyValueError::new_err(format!("\"{name}\" is a masked array; leave out what has no value")));
    }
    Ok(())
}
