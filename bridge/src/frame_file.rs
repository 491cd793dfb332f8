//! A data frame of trajectories as a CSV file, which is then read like any recording. Only the columns that are read are
//! written.

use std::io::{BufWriter, Write};

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{
    Decimal32Type, Decimal64Type, Decimal128Type, Decimal256Type, Float16Type, Float32Type, Float64Type, Int8Type,
    Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatchReader};
use arrow_schema::{ArrowError, DataType, Schema};
use closecall_run::input::tracks::{TrackOptions, columns_read};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyCapsuleMethods, PyDict};
use tempfile::NamedTempFile;

use crate::error::exception;

/// The method of Arrow's C stream.
const STREAM: &str = "__arrow_c_stream__";

/// A data frame as a CSV file, which is gone when it is dropped.
pub fn written(py: Python, data: &Bound<PyAny>, tracks: &TrackOptions) -> PyResult<NamedTempFile> {
    let file = tempfile::Builder::new().prefix("closecall-").suffix(".csv").tempfile()?;
    // pandas has the method, but needs PyArrow for it.
    let stream = data.call_method0(STREAM);
    match (stream, data.hasattr("to_csv")?) {
        (Ok(stream), _) => write(data, stream, &file, tracks)?,
        (Err(_), true) => {
            let keywords = PyDict::new(py);
            keywords.set_item("index", false)?;
            data.call_method("to_csv", (file.path(),), Some(&keywords))?;
        }
        (Err(error), false) if data.hasattr(STREAM)? => return Err(error),
        (Err(_), false) => {
            let what = data.get_type().name()?;
            return Err(PyTypeError::new_err(format!("{what} is neither a path nor a data frame with {STREAM}")));
        }
    }
    Ok(file)
}

/// Writes the columns that are read. Columns of only nulls are skipped: Polars does not export them as Arrow specifies.
fn write(data: &Bound<PyAny>, stream: Bound<PyAny>, file: &NamedTempFile, tracks: &TrackOptions) -> PyResult<()> {
    let mut reader = reader_of(&stream)?;
    let schema = reader.schema();
    let names = schema.fields().iter().map(|field| field.name().clone()).collect::<Vec<_>>();
    let read = columns_read(&names, tracks).map_err(exception)?;
    check_types(&schema, &read)?;
    let is_null = |place: usize| *schema.field(place).data_type() == DataType::Null;
    // Where each column is in a batch.
    let mut places = read.iter().map(|place| Some(*place)).collect::<Vec<_>>();
    if (0..names.len()).any(is_null) && data.hasattr("select")? {
        let kept = read.iter().copied().filter(|place| !is_null(*place)).collect::<Vec<_>>();
        let kept_names = kept.iter().map(|place| names[*place].as_str()).collect::<Vec<_>>();
        reader = reader_of(&data.call_method1("select", (kept_names,))?.call_method0(STREAM)?)?;
        places = read.iter().map(|place| kept.iter().position(|kept| kept == place)).collect();
    }
    let mut out = BufWriter::new(file);
    writeln!(out, "{}", read.iter().map(|place| quoted(&names[*place])).collect::<Vec<_>>().join(","))?;
    for batch in reader {
        data.py().check_signals()?;
        let batch = batch.map_err(failed)?;
        let columns = places.iter().map(|place| place.map(|place| Texts::of(batch.column(place)))).collect::<Vec<_>>();
        for row in 0..batch.num_rows() {
            for (place, column) in columns.iter().enumerate() {
                let comma = if place > 0 { "," } else { "" };
                write!(out, "{comma}{}", column.as_ref().map_or(String::new(), |column| column.text(row)))?;
            }
            writeln!(out)?;
        }
    }
    out.flush()?;
    Ok(())
}

#[expect(unsafe_code, reason = "Arrow's C interface is a pointer, which its name vouches for")]
fn reader_of(stream: &Bound<PyAny>) -> PyResult<RecordBatchStreamReader> {
    let pointer = stream.cast::<PyCapsule>()?.pointer_checked(Some(c"arrow_array_stream"))?;
    // SAFETY: a capsule of this name holds such a stream, and the reader takes it over, as Arrow's interface says.
    unsafe { RecordBatchStreamReader::from_raw(pointer.cast::<FFI_ArrowArrayStream>().as_ptr()) }.map_err(failed)
}

fn failed(error: ArrowError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Checks that the columns that are read hold texts or numbers.
fn check_types(schema: &Schema, read: &[usize]) -> PyResult<()> {
    for field in read.iter().map(|place| schema.field(*place)) {
        if !is_readable(field.data_type()) {
            let (name, what) = (field.name(), field.data_type());
            let message = format!("column {name} holds values of type {what}; texts or numbers are needed");
            return Err(PyValueError::new_err(message));
        }
    }
    Ok(())
}

fn is_readable(data_type: &DataType) -> bool {
    match data_type {
        DataType::Dictionary(_, values) => is_readable(values),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View | DataType::Null => true,
        data_type => data_type.is_numeric(),
    }
}

/// The texts of a column of a batch.
struct Texts<'a> {
    values: &'a ArrayRef,
    /// Of a dictionary: which of the values a row has.
    keys: Option<Vec<usize>>,
    column: &'a ArrayRef,
}

impl<'a> Texts<'a> {
    fn of(column: &'a ArrayRef) -> Self {
        match column.as_any_dictionary_opt() {
            Some(dictionary) => Self { values: dictionary.values(), keys: Some(dictionary.normalized_keys()), column },
            None => Self { values: column, keys: None, column },
        }
    }

    /// The text in a row; empty where the value is missing.
    fn text(&self, row: usize) -> String {
        match &self.keys {
            _ if self.column.is_null(row) => String::new(),
            Some(keys) => keys.get(row).map_or(String::new(), |key| cell(self.values, *key)),
            None => cell(self.values, row),
        }
    }
}

/// The text of a value; empty where it is missing.
fn cell(column: &ArrayRef, row: usize) -> String {
    if column.is_null(row) {
        return String::new();
    }
    match column.data_type() {
        DataType::Float64 => column.as_primitive::<Float64Type>().value(row).to_string(),
        DataType::Float32 => column.as_primitive::<Float32Type>().value(row).to_string(),
        DataType::Float16 => column.as_primitive::<Float16Type>().value(row).to_string(),
        DataType::Int64 => column.as_primitive::<Int64Type>().value(row).to_string(),
        DataType::Int32 => column.as_primitive::<Int32Type>().value(row).to_string(),
        DataType::Int16 => column.as_primitive::<Int16Type>().value(row).to_string(),
        DataType::Int8 => column.as_primitive::<Int8Type>().value(row).to_string(),
        DataType::UInt64 => column.as_primitive::<UInt64Type>().value(row).to_string(),
        DataType::UInt32 => column.as_primitive::<UInt32Type>().value(row).to_string(),
        DataType::UInt16 => column.as_primitive::<UInt16Type>().value(row).to_string(),
        DataType::UInt8 => column.as_primitive::<UInt8Type>().value(row).to_string(),
        DataType::Decimal32(..) => column.as_primitive::<Decimal32Type>().value_as_string(row),
        DataType::Decimal64(..) => column.as_primitive::<Decimal64Type>().value_as_string(row),
        DataType::Decimal128(..) => column.as_primitive::<Decimal128Type>().value_as_string(row),
        DataType::Decimal256(..) => column.as_primitive::<Decimal256Type>().value_as_string(row),
        DataType::Utf8 => quoted(column.as_string::<i32>().value(row)),
        DataType::LargeUtf8 => quoted(column.as_string::<i64>().value(row)),
        DataType::Utf8View => quoted(column.as_string_view().value(row)),
        // Its type was checked: it is that of nulls.
        _ => String::new(),
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', ';', '\t', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
