//! Python's `Table`: conflicts as Arrow columns, which pandas, Polars, DuckDB and PyArrow take without a copy.
//!
//! Arrow's own C interface carries them (`__arrow_c_stream__`), so that neither side needs the other's library: PyArrow and
//! libsumo cannot be loaded into one process.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use arrow_array::builder::{BooleanBuilder, Float64Builder, StringBuilder, UInt64Builder};
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, RecordBatch, RecordBatchIterator, StringArray, UInt64Array,
};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use closecall_analysis::logged::ConflictReader;
use closecall_run::output::schema::{Column, ColumnType, LoggedConflict, Presence, Value};
use numpy::PyArray1;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList, PyString};

use crate::error::exception;

/// Rows of a batch.
const BATCH: usize = 1 << 13;
/// Different texts of a column that are one object of Python each time that they occur.
const SHARED: usize = 1 << 12;
/// Rows that a notebook shows.
const SHOWN: usize = 10;
/// The columns that a notebook shows.
const TELLING: [&str; 10] = ["id", "time", "kind", "severity", "ego", "foe", "margin", "ttc", "pet", "lane"];

/// Conflicts as a table of Arrow columns: those of conflicts.csv (docs/log.md), null where a value is missing.
///
/// Whatever takes Arrow data takes it as it is: `polars.DataFrame(table)`, `pyarrow.table(table)`, `duckdb.sql("FROM table")`.
#[pyclass(frozen, module = "closecall", name = "Table")]
pub struct Table {
    schema: SchemaRef,
    batches: Vec<RecordBatch>,
    remarks: Vec<String>,
}

impl Table {
    /// The table of these conflicts with these columns.
    pub fn of<E>(
        columns: &[&'static Column],
        mut conflicts: impl Iterator<Item = Result<LoggedConflict, E>>,
        wrong: impl Fn(E) -> PyErr,
    ) -> PyResult<Self> {
        let fields = columns.iter().map(|column| {
            let unit = [("unit".to_owned(), column.unit().to_owned())].into_iter().filter(|(_, unit)| !unit.is_empty());
            Field::new(column.name, data_type(column.column_type), true)
                .with_metadata(unit.collect::<std::collections::HashMap<_, _>>())
        });
        let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
        let mut batches = Vec::new();
        loop {
            let rows = conflicts.by_ref().take(BATCH).collect::<Result<Vec<_>, E>>().map_err(&wrong)?;
            if rows.is_empty() {
                return Ok(Self { schema, batches, remarks: Vec::new() });
            }
            let arrays = columns.iter().map(|column| array(column, &rows)).collect();
            batches.push(RecordBatch::try_new(schema.clone(), arrays).map_err(failed)?);
        }
    }

    /// The same table, with what had to be assumed.
    pub fn with_remarks(self, remarks: Vec<String>) -> Self {
        Self { remarks, ..self }
    }

    fn rows(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }
}

#[pymethods]
impl Table {
    /// The names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// What `closecall.replay` had to assume of a recording, a line each, as the command says it; empty for a log.
    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.remarks.clone()
    }

    /// The columns by name: numbers as NumPy arrays, NaN where they are missing; texts and flags as lists, None where they are.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (place, field) in self.schema.fields().iter().enumerate() {
            let parts = self.batches.iter().map(|batch| batch.column(place));
            dict.set_item(field.name(), python(py, field.data_type(), parts)?)?;
        }
        Ok(dict)
    }

    /// A `pandas.DataFrame`; PyArrow is not needed. With all columns it takes 1.3 kB a conflict besides the table.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.getattr("DataFrame")?.call1((self.to_dict(py)?,))
    }

    /// A `polars.DataFrame`.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.getattr("DataFrame")?.call1((slf,))
    }

    /// The Arrow C stream of the columns; the schema that a caller may ask for is not regarded, as Arrow allows.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let batches = self.batches.clone().into_iter().map(Ok::<_, ArrowError>);
        let stream = FFI_ArrowArrayStream::new(Box::new(RecordBatchIterator::new(batches, self.schema.clone())));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    fn __len__(&self) -> usize {
        self.rows()
    }

    fn __repr__(&self) -> String {
        format!("Table({} conflicts, {} columns)", self.rows(), self.schema.fields().len())
    }

    /// The first rows for a notebook.
    fn _repr_html_(&self) -> String {
        let shown = TELLING.iter().filter_map(|name| Some((*name, self.schema.index_of(name).ok()?)));
        let shown = shown.collect::<Vec<_>>();
        let mut html = "<table><thead><tr>".to_owned();
        shown.iter().for_each(|(name, _)| _ = write!(html, "<th>{name}</th>"));
        html += "</tr></thead><tbody>";
        for row in 0..SHOWN.min(self.rows()) {
            html += "<tr>";
            for (_, place) in &shown {
                // The first batch has more rows than are shown.
                _ = write!(html, "<td>{}</td>", escaped(&cell(self.batches[0].column(*place), row)));
            }
            html += "</tr>";
        }
        _ = write!(html, "</tbody></table><p>{} conflicts, {} columns</p>", self.rows(), self.schema.fields().len());
        html
    }
}

fn data_type(column: ColumnType) -> DataType {
    match column {
        ColumnType::Count => DataType::UInt64,
        ColumnType::Text => DataType::Utf8,
        ColumnType::Number => DataType::Float64,
        ColumnType::Flag => DataType::Boolean,
    }
}

/// A column of these rows.
fn array(column: &Column, rows: &[LoggedConflict]) -> ArrayRef {
    let values = rows.iter().map(column.get);
    match column.column_type {
        ColumnType::Count => {
            let mut builder = UInt64Builder::with_capacity(rows.len());
            values.for_each(|value| {
                builder.append_option(if let Value::Count(count) = value { Some(count) } else { None })
            });
            Arc::new(builder.finish())
        }
        ColumnType::Number => {
            let mut builder = Float64Builder::with_capacity(rows.len());
            values.for_each(|value| builder.append_option(if let Value::Number(it) = value { Some(it) } else { None }));
            Arc::new(builder.finish())
        }
        ColumnType::Flag => {
            let mut builder = BooleanBuilder::with_capacity(rows.len());
            values
                .for_each(|value| builder.append_option(if let Value::Flag(flag) = value { Some(flag) } else { None }));
            Arc::new(builder.finish())
        }
        ColumnType::Text => {
            let mut builder = StringBuilder::new();
            values.for_each(|value| {
                builder.append_option(if let Value::Text(text) = value {
                    Some(text).filter(|it| !it.is_empty())
                } else {
                    None
                });
            });
            Arc::new(builder.finish())
        }
    }
}

/// A column as NumPy and Python have it.
fn python<'py, 'a>(
    py: Python<'py>,
    data_type: &DataType,
    parts: impl Iterator<Item = &'a ArrayRef>,
) -> PyResult<Bound<'py, PyAny>> {
    let parts = parts.map(|part| part.as_any());
    Ok(match data_type {
        DataType::Float64 => {
            let numbers = parts.filter_map(|part| part.downcast_ref::<Float64Array>()).flatten();
            PyArray1::from_iter(py, numbers.map(|number| number.unwrap_or(f64::NAN))).into_any()
        }
        DataType::UInt64 => {
            let counts = parts.filter_map(|part| part.downcast_ref::<UInt64Array>()).flatten();
            PyArray1::from_iter(py, counts.map(Option::unwrap_or_default)).into_any()
        }
        DataType::Boolean => {
            let flags = parts.filter_map(|part| part.downcast_ref::<BooleanArray>()).flatten();
            PyList::new(py, flags.collect::<Vec<_>>())?.into_any()
        }
        _ => {
            let texts = parts.filter_map(|part| part.downcast_ref::<StringArray>()).flatten();
            shared_texts(py, texts)?.into_any()
        }
    })
}

/// Texts as a list, None where they are missing: equal ones are one object of Python, as most columns repeat a few words. Of
/// a column of ids, only the first [`SHARED`] are kept for that.
fn shared_texts<'py, 'a>(
    py: Python<'py>,
    texts: impl Iterator<Item = Option<&'a str>>,
) -> PyResult<Bound<'py, PyList>> {
    let mut known = HashMap::<&str, Bound<PyString>>::new();
    let object = |text: Option<&'a str>| {
        let text = text?;
        if let Some(object) = known.get(text) {
            return Some(object.clone());
        }
        let object = PyString::new(py, text);
        if known.len() < SHARED {
            known.insert(text, object.clone());
        }
        Some(object)
    };
    PyList::new(py, texts.map(object).collect::<Vec<_>>())
}

/// A value as a notebook shows it; empty where it is missing.
fn cell(array: &ArrayRef, row: usize) -> String {
    if array.is_null(row) {
        return String::new();
    }
    let any = array.as_any();
    let number = any.downcast_ref::<Float64Array>().map(|numbers| format!("{:.2}", numbers.value(row)));
    let count = || any.downcast_ref::<UInt64Array>().map(|counts| counts.value(row).to_string());
    let text = || any.downcast_ref::<StringArray>().map(|texts| texts.value(row).to_owned());
    number.or_else(count).or_else(text).unwrap_or_default()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn failed(error: ArrowError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

/// The conflicts of a log folder as a table, in the order of the file.
///
/// Args:
///     folder: the log's folder.
///     columns: the names of the columns that are wanted; by default all. The table is in memory: 0.5 kB a conflict
///         with all columns, 8 bytes for each column of numbers.
///
/// Raises:
///     OSError: the log is missing or cannot be read.
///     ValueError: it is not a log, or has no such column.
#[pyfunction]
#[pyo3(signature = (folder, *, columns=None))]
pub fn read(py: Python, folder: PathBuf, columns: Option<Vec<String>>) -> PyResult<Table> {
    py.detach(|| {
        let mut conflicts = ConflictReader::open(&folder).map_err(exception)?;
        let mut wanted = conflicts.columns_of_schema();
        if let Some(names) = columns {
            let of = |name: String| {
                let column = wanted.iter().find(|column| column.name == name).copied();
                column.ok_or_else(|| PyValueError::new_err(format!("columns: the log has no \"{name}\"")))
            };
            wanted = names.into_iter().map(of).collect::<PyResult<Vec<_>>>()?;
        }
        if wanted.iter().any(|column| column.presence == Presence::Snapshot) {
            conflicts = conflicts.with_snapshots();
        }
        let interrupted = || Python::attach(|py| py.check_signals());
        let rows = conflicts.map(|row| row.map_err(exception)).enumerate();
        let rows = rows.map(|(number, row)| if number % BATCH == 0 { interrupted().and(row) } else { row });
        Table::of(&wanted, rows, |error: PyErr| error)
    })
}
