//! The step listener: a run that is fed from libsumo, traci or arrays in somebody's own script.

use std::path::PathBuf;

use closecall::options::Options;
use closecall::output::log::Log;
use closecall::output::record::RunRecord;
use closecall::output::schema::{Context, LoggedConflict};
use closecall::run::Run;
use closecall::traffic::net::Net;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::conflict::Conflict;
use crate::error::exception;
use crate::frames::Frames;
use crate::paint::Painter;
use crate::provenance;
use crate::pull::{self, Source};

/// Finds the conflicts of a simulation, or of plain frames, step by step.
///
/// Args:
///     source: the module libsumo, the module traci or a traci connection, with a simulation started; None where
///         frames are given to `step`.
///     net: the net file; by default the simulation's own.
///     out: a folder for the log (conflicts.csv, run.json, and encounters.csv with `log_encounters=True`); by default
///         none.
///     paint: whether to colour the vehicles in conflict; by default where libsumo runs sumo-gui.
///     **options: what the command line has as long options, with underscores: `mu="at-rest"`, `epsilon=1.0`.
///
/// Raises:
///     ValueError: an unknown option or one out of its range, a net that cannot be used, a mesoscopic simulation; the
///         message says which.
///     RuntimeError: no simulation is started.
///     OSError: a file or folder that cannot be read or written.
#[pyclass(subclass, module = "closecall._closecall", name = "Checker")]
pub struct Checker {
    run: Run,
    input: Input,
    painter: Option<Painter>,
    /// Of the log, where there is one.
    record: Option<Box<RunRecord>>,
    is_closed: bool,
}

enum Input {
    Simulation(Source),
    Frames(Box<Frames>),
}

#[pymethods]
impl Checker {
    #[new]
    #[pyo3(signature = (source=None, *, net=None, out=None, paint=None, **options))]
    fn new(
        source: Option<&Bound<PyAny>>,
        net: Option<PathBuf>,
        out: Option<PathBuf>,
        paint: Option<bool>,
        options: Option<&Bound<PyDict>>,
    ) -> PyResult<Self> {
        let options = options_from(options)?;
        let given = net.clone();
        let net = match (net, source) {
            (Some(path), _) => Some(std::sync::Arc::new(Net::read(&path).map_err(exception)?)),
            (None, Some(source)) => pull::net_of(source)?,
            (None, None) => None,
        };
        let mut run = Run::new(&options, net).map_err(exception)?;
        let input = match source {
            Some(source) => {
                pull::add_obstacles(source, &mut run, &options.obstacles)?;
                Input::Simulation(Source::new(source, &mut run, &options)?)
            }
            None => Input::Frames(Box::new(Frames::new(&options))),
        };
        let mut record = None;
        if let Some(folder) = out {
            let begun = provenance::record_of_script(source, given, &run, &options)?;
            let log = Log::create(&folder, options.log_encounters).map_err(exception)?;
            log.write_record(&begun).map_err(exception)?;
            run.log_to(log, true);
            record = Some(Box::new(begun));
        }
        let painter = match (source, paint) {
            (Some(source), None) if has_gui(source) => Some(Painter::new(source)),
            (Some(source), Some(true)) => Some(Painter::new(source)),
            _ => None,
        };
        Ok(Self { run, input, painter, record, is_closed: false })
    }

    /// Check one step; a simulation calls this itself where the checker is its step listener.
    ///
    /// Args:
    ///     time: simulated time in s; only with `states`.
    ///     states: where there is no simulation, a mapping of columns of equal length: `id`, `x`, `y` (front-bumper
    ///         centre, m), `heading` (rad, counter-clockwise from +x), `speed` (m/s) and where they are known `z`,
    ///         `length`, `width` (m), `decel` (m/s²), `mass` (kg). A row whose place, heading or speed is not
    ///         finite is no road user.
    ///
    /// Returns:
    ///     Whether the listener wants the next step too: a simulation drops one that is closed. Where its time goes
    ///     back (another one was started or loaded, or a state of before), the checker closes itself.
    ///
    /// Raises:
    ///     ValueError: a column is missing or of another length, an id is there twice, the time is before the last,
    ///         dimensions are impossible.
    ///     RuntimeError: the checker is closed, and it is not a simulation that calls.
    #[pyo3(signature = (time=0.0, states=None))]
    fn step(&mut self, py: Python, time: f64, states: Option<&Bound<PyAny>>) -> PyResult<bool> {
        match (&mut self.input, states) {
            (Input::Simulation(_), None) if self.is_closed => return Ok(false),
            (Input::Simulation(source), None) => {
                let time = source.time(py)?;
                if self.run.time().is_some_and(|last| time < last) {
                    // Whom it painted is not in that simulation.
                    self.painter = None;
                    self.close(py)?;
                    return Ok(false);
                }
                source.pull(py, &mut self.run, time)?;
                let rows = py.detach(|| self.run.track_paths().to_vec());
                source.place(py, &mut self.run, &rows)?;
            }
            (Input::Frames(_), Some(_)) if self.is_closed => {
                return Err(PyRuntimeError::new_err("the checker is closed"));
            }
            (Input::Frames(frames), Some(states)) => {
                if let Some(last) = self.run.time().filter(|last| time < *last) {
                    return Err(PyValueError::new_err(format!("time is {time}, after {last}")));
                }
                frames.pull(&mut self.run, time, states)?;
                py.detach(|| self.run.track_paths().len());
            }
            (Input::Simulation(_), Some(_)) => {
                return Err(PyTypeError::new_err("a checker with a simulation takes no states: it asks for them"));
            }
            (Input::Frames(_), None) => {
                return Err(PyTypeError::new_err("a checker without a simulation needs states: step(time, states)"));
            }
        }
        py.detach(|| self.run.finish_step()).map_err(exception)?;
        if let Some(painter) = &mut self.painter {
            painter.paint(py, &self.run)?;
        }
        Ok(true)
    }

    /// End the run: what is still open is closed and written, painted vehicles get their colours back.
    fn close(&mut self, py: Python) -> PyResult<()> {
        self.end(py, None)
    }

    /// The same; with what ended the run before its time, if something did.
    #[pyo3(name = "_end")]
    fn end(&mut self, py: Python, error: Option<String>) -> PyResult<()> {
        if std::mem::replace(&mut self.is_closed, true) {
            return Ok(());
        }
        let summary = self.run.finish(Vec::new()).map_err(exception)?;
        if let (Some(log), Some(record)) = (self.run.take_log(), self.record.take()) {
            log.write_record(&RunRecord { summary, complete: error.is_none(), error, ..*record }).map_err(exception)?;
        }
        match &mut self.painter {
            Some(painter) => painter.clear(py),
            None => Ok(()),
        }
    }

    /// All conflicts so far, those that still go on as they are now.
    #[getter]
    fn conflicts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let context = |number| Context { number, net: self.run.net(), roster: &self.run.roster };
        let conflicts = self.run.conflicts();
        let logged = (1..).zip(&conflicts).map(|(number, conflict)| LoggedConflict::new(conflict, context(number)));
        PyList::new(py, logged.map(Conflict).collect::<Vec<_>>())
    }

    /// Counts by kind and severity, the traffic that was checked, and, once it is closed, what was left out, as in `run.json`.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text =
            serde_json::to_string(&self.run.summary()).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        py.import("json")?.call_method1("loads", (text,))
    }
}

/// Options from Python keywords.
pub fn options_from(keywords: Option<&Bound<PyDict>>) -> PyResult<Options> {
    let mut settings = Vec::new();
    for (name, value) in keywords.into_iter().flatten() {
        let text = if let Ok(flag) = value.extract::<bool>() {
            flag.to_string()
        } else if let Ok(items) = value.cast::<PyList>() {
            items.iter().map(|item| item.to_string()).collect::<Vec<_>>().join(",")
        } else {
            value.to_string()
        };
        settings.push((name.to_string(), text));
    }
    Options::from_settings(settings.iter().map(|(name, value)| (name.as_str(), value.clone()))).map_err(exception)
}

/// Whether libsumo runs sumo-gui. traci is not asked: a plain SUMO would print an error.
fn has_gui(source: &Bound<PyAny>) -> bool {
    pull::is_libsumo(source) && source.call_method0("hasGUI").is_ok_and(|has| has.is_truthy().unwrap_or(false))
}
