//! The columns of a plain frame, read from Python as a whole before any of it is used.

use closecall::State;
use numpy::ndarray::Ix1;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;

use crate::numbers::{numbers, refuse_masked};

/// The columns of a frame.
const COLUMNS: [&str; 11] = ["id", "x", "y", "heading", "speed", "z", "length", "width", "decel", "mass", "category"];

/// What a road user is, as the column `category` says.
#[derive(Clone, Copy)]
pub enum Sort {
    Vehicle,
    Bicycle,
    Person,
    Obstacle,
}

const SORTS: [(&str, Sort); 4] =
    [("vehicle", Sort::Vehicle), ("bicycle", Sort::Bicycle), ("person", Sort::Person), ("obstacle", Sort::Obstacle)];

/// The rows of a frame.
pub struct Rows {
    pub ids: Vec<PyBackedStr>,
    pub sorts: Vec<Sort>,
    pub states: Vec<State>,
    /// None where the frame lacks the column.
    pub length: Option<Vec<f64>>,
    pub width: Option<Vec<f64>>,
    pub decel: Option<Vec<f64>>,
    pub mass: Option<Vec<f64>>,
}

impl Rows {
    /// Reads a mapping of columns of equal length. What the mapping raises comes out as it is.
    pub fn read(states: &Bound<PyAny>) -> PyResult<Self> {
        let mut columns = Columns { names: names(states)?, states: states.clone(), length: 0, read: Vec::new() };
        let ids = texts(&columns.get("id")?)?;
        columns.length = ids.len();
        let [x, y, heading, speed] =
            [columns.numbers("x")?, columns.numbers("y")?, columns.numbers("heading")?, columns.numbers("speed")?];
        let z = columns.optional("z")?;
        let [length, width] = [columns.optional("length")?, columns.optional("width")?];
        let [decel, mass] = [columns.optional("decel")?, columns.optional("mass")?];
        let sorts = if columns.has("category")? {
            let sorts = sorts(&columns.get("category")?)?;
            columns.check("category", sorts.len())?;
            sorts
        } else {
            vec![Sort::Vehicle; ids.len()]
        };
        columns.check_unchanged()?;
        let state = |row: usize| State {
            x: x[row],
            y: y[row],
            z: z.as_ref().map_or(0.0, |z| z[row]),
            heading: heading[row],
            speed: speed[row],
        };
        let states = (0..ids.len()).map(state).collect();
        Ok(Self { ids, sorts, states, length, width, decel, mass })
    }
}

/// The columns while they are read.
struct Columns<'py> {
    states: Bound<'py, PyAny>,
    /// None where the mapping does not tell.
    names: Option<Vec<PyBackedStr>>,
    length: usize,
    read: Vec<(&'static str, Bound<'py, PyAny>)>,
}

impl<'py> Columns<'py> {
    fn has(&self, name: &str) -> PyResult<bool> {
        match &self.names {
            Some(names) => Ok(names.iter().any(|known| **known == *name)),
            None => self.states.contains(name),
        }
    }

    fn get(&mut self, name: &'static str) -> PyResult<Bound<'py, PyAny>> {
        let missing = || PyValueError::new_err(format!("column \"{name}\" is missing"));
        if self.names.is_some() && !self.has(name)? {
            return Err(missing());
        }
        let column = self.states.get_item(name).map_err(|error| {
            let is_missing = self.names.is_none() && error.is_instance_of::<PyKeyError>(self.states.py());
            if is_missing { missing() } else { error }
        })?;
        refuse_masked(name, &column)?;
        self.read.push((name, column.clone()));
        Ok(column)
    }

    fn numbers(&mut self, name: &'static str) -> PyResult<Vec<f64>> {
        let column = self.get(name)?;
        let values = numbers(name, &column)?;
        let dimensions = values.ndim();
        let message = |_| PyValueError::new_err(format!("\"{name}\" has {dimensions} dimensions, a column has 1"));
        let values = values.into_dimensionality::<Ix1>().map_err(message)?;
        self.check(name, values.len())?;
        Ok(values.to_vec())
    }

    fn optional(&mut self, name: &'static str) -> PyResult<Option<Vec<f64>>> {
        self.has(name)?.then(|| self.numbers(name)).transpose()
    }

    fn check(&self, name: &str, length: usize) -> PyResult<()> {
        let message = || format!("\"{name}\" has {length} values, \"id\" has {}", self.length);
        if length == self.length { Ok(()) } else { Err(PyValueError::new_err(message())) }
    }

    /// Refuses columns whose length has changed since they were read.
    fn check_unchanged(&self) -> PyResult<()> {
        let changed = self.read.iter().find(|(_, column)| column.len().is_ok_and(|length| length != self.length));
        let message =
            |name: &str| PyValueError::new_err(format!("\"{name}\" changed its length while the frame was read"));
        changed.map_or(Ok(()), |(name, _)| Err(message(name)))
    }
}

/// The values of a column as texts, which stay in Python's memory.
fn texts(column: &Bound<PyAny>) -> PyResult<Vec<PyBackedStr>> {
    column.try_iter()?.map(|text| text?.str()?.try_into()).collect()
}

fn sorts(column: &Bound<PyAny>) -> PyResult<Vec<Sort>> {
    let sort = |text: &PyBackedStr| {
        let known = SORTS.iter().find(|(name, _)| **text == **name).map(|(_, sort)| *sort);
        let message = || format!("category is \"{text}\": vehicle, bicycle, person or obstacle");
        known.ok_or_else(|| PyValueError::new_err(message()))
    };
    texts(column)?.iter().map(sort).collect()
}

/// The names of the columns, if the mapping has them; an unknown name is refused, as it is most likely misspelt.
fn names(states: &Bound<PyAny>) -> PyResult<Option<Vec<PyBackedStr>>> {
    // A mapping and a table of pandas have keys, a table of Polars has columns, an array of NumPy's structures neither.
    let names = match (states.getattr_opt("keys")?, states.getattr_opt("columns")?, states.getattr_opt("dtype")?) {
        (Some(keys), ..) => keys.call0()?,
        (None, Some(columns), _) => columns,
        (None, None, Some(dtype)) if !dtype.getattr("names")?.is_none() => dtype.getattr("names")?,
        _ => return Ok(None),
    };
    let names = texts(&names)?;
    for name in &names {
        if !COLUMNS.contains(&&**name) {
            let alike = |known: &&str| strsim::jaro_winkler(known, name);
            let nearest = COLUMNS.iter().max_by(|a, b| alike(a).total_cmp(&alike(b)));
            let message = format!("unknown column \"{name}\"; did you mean \"{}\"?", nearest.unwrap_or(&"id"));
            return Err(PyValueError::new_err(message));
        }
    }
    Ok(Some(names))
}
