//! Python's `Conflict`: an attribute for each column of the log.

use std::path::PathBuf;

use closecall_analysis::logged::ConflictReader;
use closecall_run::Run;
use closecall_run::output::schema::{COLUMNS, Column, Context, LoggedConflict, Presence, Value};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyTuple};

use crate::error::exception;

/// One conflict: a pair of road users and a run of steps in which they were closer than they can safely be.
///
/// Its attributes are the columns of conflicts.csv (docs/log.md). None where a measure does not exist.
#[pyclass(frozen, module = "closecall", name = "Conflict", eq, hash)]
#[derive(PartialEq)]
pub struct Conflict(pub LoggedConflict);

impl std::hash::Hash for Conflict {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        let LoggedConflict { ego, foe, begin, .. } = &self.0;
        (ego, foe, begin.to_bits()).hash(state);
    }
}

#[pymethods]
impl Conflict {
    fn __repr__(&self) -> String {
        let LoggedConflict { ego, foe, kind, severity, time, margin, .. } = &self.0;
        let kind = kind.name();
        let severity = severity.name();
        format!("Conflict(ego={ego:?}, foe={foe:?}, kind={kind}, severity={severity}, time={time}, margin={margin:.3})")
    }

    /// The columns that have a value, one a line, with their units.
    fn __str__(&self) -> String {
        let mut buffer = String::new();
        let lines = self.told(&mut buffer, |text, name, value, unit| {
            text.push_str(&format!("\n  {name:25} {value}{}{unit}", if unit.is_empty() { "" } else { " " }));
        });
        format!("{}{lines}", self.__repr__())
    }

    /// The same as a table for a notebook.
    fn _repr_html_(&self) -> String {
        let escaped = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let rows = self.told(&mut String::new(), |text, name, value, unit| {
            text.push_str(&format!("<tr><th>{name}</th><td>{}</td><td>{unit}</td></tr>", escaped(value)));
        });
        format!("<table>{rows}</table>")
    }
}

impl Conflict {
    /// Gives the class its attributes, one property per column.
    pub fn add_attributes(py: Python) -> PyResult<()> {
        let class = py.get_type::<Self>();
        let property = py.import("builtins")?.getattr("property")?;
        for column in &COLUMNS {
            let getter = PyCFunction::new_closure(py, None, None, |arguments, _: Option<&Bound<PyDict>>| {
                Self::attribute(arguments, column)
            })?;
            let keywords = PyDict::new(py);
            keywords.set_item("doc", documentation(column))?;
            class.setattr(column.name, property.call((getter,), Some(&keywords))?)?;
        }
        Ok(())
    }

    /// Writes the columns that have a value, but for what only drawings need.
    fn told(&self, buffer: &mut String, write: impl Fn(&mut String, &str, &str, &str)) -> String {
        let mut text = String::new();
        for column in COLUMNS.iter().filter(|column| column.presence != Presence::Snapshot) {
            match (column.get)(&self.0).text(buffer) {
                "" => {}
                value => write(&mut text, column.name, value, column.unit()),
            }
        }
        text
    }

    fn attribute(arguments: &Bound<PyTuple>, column: &Column) -> PyResult<Py<PyAny>> {
        let conflict = arguments.get_item(0)?.cast_into::<Self>()?;
        let py = arguments.py();
        match (column.get)(&conflict.get().0) {
            Value::Count(count) => count.into_py_any(py),
            Value::Number(number) => number.into_py_any(py),
            Value::Flag(flag) => flag.into_py_any(py),
            Value::Text("") | Value::Missing => Ok(py.None()),
            Value::Text(text) => text.into_py_any(py),
        }
    }
}

fn documentation(column: &Column) -> String {
    let meaning = column.meaning.trim();
    match column.unit() {
        "" => meaning.to_owned(),
        unit => format!("{meaning}, in {unit}"),
    }
}

/// The conflicts of a log folder, in the order of the file.
///
/// Raises:
///     OSError: the log is missing or cannot be read.
///     ValueError: it is not a log.
#[pyfunction]
pub fn read_log(py: Python, folder: PathBuf) -> PyResult<Vec<Conflict>> {
    let read = || -> closecall_analysis::Result<Vec<_>> {
        ConflictReader::open(&folder)?.with_snapshots().map(|conflict| conflict.map(Conflict)).collect()
    };
    py.detach(read).map_err(exception)
}
/// The conflicts of a run as a log has them.
pub fn logged(run: &Run) -> Vec<LoggedConflict> {
    let context = |number| Context { number, net: run.net(), roster: &run.roster };
    let conflicts = run.conflicts();
    let numbered = (run.first_number()..).zip(&conflicts);
    numbered.map(|(number, conflict)| LoggedConflict::new(conflict, context(number))).collect()
}
