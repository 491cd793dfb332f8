//! The step listener: a run that a Python script feeds from libsumo, traci or arrays.

use std::path::PathBuf;

use closecall::internals::output::{Context, LoggedConflict};
use closecall::internals::util::caught;
use closecall::{Ending, Net, Options, OutputFiles, RecordedRun, Run};
use pyo3::exceptions::{PyRuntimeError, PyRuntimeWarning, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::alarm::{self, Alarm, Listeners};
use crate::conflict::Conflict;
use crate::error::exception;
use crate::frames::Frames;
use crate::paint::Painter;
use crate::provenance;
use crate::pull::{self, Source};

/// Finds the conflicts of a simulation, or of plain frames, step by step.
///
/// Args:
///     source: the module libsumo, the module traci or a traci connection, with a simulation started; None if `step`
///         gets frames.
///     net: the net file; by default the simulation's own.
///     out: a folder for the log (conflicts.csv, run.json, and series.csv with `log_series=True`); by default
///         no log is written. An earlier log is kept in its folder `earlier`.
///     force: whether to replace an earlier log instead of keeping it.
///     paint: whether to colour the vehicles in conflict; by default only if libsumo runs sumo-gui.
///     on_conflict: called with each `Conflict` when it has closed and is settled: 1 s after the last step that meets the log's
///         condition, up to 5 s later where a PET is waited for.
///     on_alarm: called with an `Alarm` in the step in which a conflict opens.
///     **options: the long options of the command line, with underscores: `mu="at_rest"`, `epsilon=1.0`.
///
/// Raises:
///     ValueError: an option is unknown or out of its range, the net cannot be used, or the simulation is mesoscopic; the
///         message says which.
///     RuntimeError: no simulation is started.
///     OSError: a file or folder cannot be read or written.
#[pyclass(subclass, module = "closecall._closecall", name = "Checker")]
pub struct Checker {
    recorded: RecordedRun,
    feed: Feed,
    painter: Option<Painter>,
    listeners: Listeners,
    is_closed: bool,
}

/// Where the road users come from.
enum Feed {
    Simulation(Source),
    Frames(Box<Frames>),
}

#[pymethods]
impl Checker {
    #[new]
    #[pyo3(signature = (source=None, *, net=None, out=None, force=false, paint=None, on_conflict=None, on_alarm=None,
        **options))]
    #[allow(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        py: Python,
        source: Option<&Bound<PyAny>>,
        net: Option<PathBuf>,
        out: Option<PathBuf>,
        force: bool,
        paint: Option<bool>,
        on_conflict: Option<Py<PyAny>>,
        on_alarm: Option<Py<PyAny>>,
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
        let feed = match source {
            Some(source) => {
                pull::add_obstacles(source, &mut run, &options.obstacles)?;
                Feed::Simulation(Source::new(source, &mut run, &options)?)
            }
            None => Feed::Frames(Box::new(Frames::new(&options))),
        };
        let recorded = match out {
            Some(folder) => {
                let record = provenance::record_of_script(source, given, &run, &options)?;
                let files = OutputFiles { force, ..OutputFiles::default() };
                let recorded = RecordedRun::open(run, record, &folder, &files).map_err(exception)?;
                if let Some(line) = recorded.earlier_log() {
                    py.import("sys")?.getattr("stderr")?.call_method1("write", (format!("closecall: {line}\n"),))?;
                }
                recorded
            }
            None => RecordedRun::in_memory(run),
        };
        let painter = match (source, paint) {
            (Some(source), None) if has_gui(source) => Some(Painter::new(source)),
            (Some(source), Some(true)) => Some(Painter::new(source)),
            _ => None,
        };
        let listeners = Listeners::new(on_conflict, on_alarm);
        Ok(Self { recorded, feed, painter, listeners, is_closed: false })
    }

    /// Check one step. A simulation calls this itself if the checker is its step listener.
    ///
    /// Args:
    ///     time: simulated time in s; only with `states`.
    ///     states: without a simulation, a mapping of columns of equal length: `id`, `x`, `y` (front-bumper centre, m),
    ///         `heading` (rad, counter-clockwise from +x), `speed` (m/s) and, if known, `category` (`vehicle`, `bicycle`,
    ///         `person`, `obstacle`), `z`, `length`, `width` (m), `decel` (m/s²), `mass` (kg). A row whose position,
    ///         heading or speed is not finite is ignored.
    ///
    /// Returns:
    ///     Whether the listener wants the next step too: a simulation drops one that is closed. If the simulation's time
    ///     goes back (another one was started or loaded, or an earlier state), the checker closes itself with a warning.
    ///
    /// Raises:
    ///     ValueError: a column is missing, unknown or has another length, an id occurs twice, the time is before the last
    ///         one, dimensions, a place or a speed are impossible (docs/limits.md), or too many are in one place.
    ///     RuntimeError: the checker is closed and has no simulation, or closecall itself failed.
    #[pyo3(signature = (time=0.0, states=None))]
    fn step(&mut self, py: Python, time: f64, states: Option<&Bound<PyAny>>) -> PyResult<bool> {
        caught(|| self.check(py, time, states)).unwrap_or_else(|fault| {
            self.is_closed = true;
            self.recorded.abandon(fault.to_string());
            Err(exception(fault))
        })
    }

    /// End the run: close and write the open conflicts, and restore the colours of painted vehicles.
    fn close(&mut self, py: Python) -> PyResult<()> {
        self.end(py, None)
    }

    /// The same, with the error that ended the run early, if there was one.
    #[pyo3(name = "_end")]
    fn end(&mut self, py: Python, error: Option<String>) -> PyResult<()> {
        if std::mem::replace(&mut self.is_closed, true) {
            return Ok(());
        }
        self.recorded.close(Ending { error, ..Ending::default() }).map_err(exception)?;
        self.listeners.tell(py, &self.recorded.run)?;
        match &mut self.painter {
            Some(painter) => painter.clear(py),
            None => Ok(()),
        }
    }

    /// The conflicts that are open now, for a script that reacts while the simulation runs.
    #[getter]
    fn active(&self) -> Vec<Alarm> {
        alarm::active(&self.recorded.run)
    }

    /// All conflicts so far; the open ones as they are now.
    #[getter]
    fn conflicts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let run = &self.recorded.run;
        let context = |number| Context { number, net: run.net(), roster: &run.roster };
        let conflicts = run.conflicts();
        let logged = (1..).zip(&conflicts).map(|(number, conflict)| LoggedConflict::new(conflict, context(number)));
        PyList::new(py, logged.map(Conflict).collect::<Vec<_>>())
    }

    /// Counts by kind and severity, the amount of traffic and, once it is closed, the skipped tests; as in `run.json`.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&self.recorded.run.summary())
            .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        py.import("json")?.call_method1("loads", (text,))
    }
}

impl Checker {
    /// Checks one step.
    fn check(&mut self, py: Python, time: f64, states: Option<&Bound<PyAny>>) -> PyResult<bool> {
        let run = &mut self.recorded.run;
        match (&mut self.feed, states) {
            (Feed::Simulation(_), None) if self.is_closed => return Ok(false),
            (Feed::Simulation(source), None) => {
                let time = source.time(py)?;
                if let Some(last) = run.time().filter(|last| time < *last) {
                    // The vehicles that it painted are not in the new simulation.
                    self.painter = None;
                    self.close(py)?;
                    warn_of_another(py, last, time)?;
                    return Ok(false);
                }
                source.pull(py, run, time)?;
                source.update_paths(py, run)?;
                py.detach(|| run.finish_step(|_| ())).map_err(exception)?;
            }
            (Feed::Frames(_), Some(_)) if self.is_closed => {
                return Err(PyRuntimeError::new_err("the checker is closed"));
            }
            (Feed::Frames(frames), Some(states)) => {
                if let Some(last) = run.time().filter(|last| time < *last) {
                    return Err(PyValueError::new_err(format!("time is {time}, after {last}")));
                }
                frames.pull(run, time, states)?;
                py.detach(|| run.step(|_, _| Ok(()))).map_err(exception)?;
            }
            (Feed::Simulation(_), Some(_)) => {
                return Err(PyTypeError::new_err("a checker with a simulation takes no states: it reads them itself"));
            }
            (Feed::Frames(_), None) => {
                return Err(PyTypeError::new_err("a checker without a simulation needs states: step(time, states)"));
            }
        }
        if let Some(painter) = &mut self.painter {
            painter.paint(py, &self.recorded.run)?;
        }
        self.listeners.tell(py, &self.recorded.run)?;
        Ok(true)
    }
}

/// Says that a checker has stopped, as another simulation has taken the place of its own.
fn warn_of_another(py: Python, last: f64, time: f64) -> PyResult<()> {
    let message = format!(
        "this checker has stopped: the simulation's time went back from {last} to {time} s, as another one was started or \
         loaded, or an earlier state; make a new Checker for it"
    );
    py.import("warnings")?.call_method1("warn", (message, py.get_type::<PyRuntimeWarning>())).map(|_| ())
}

/// The options that Python keywords set.
pub fn options_from(keywords: Option<&Bound<PyDict>>) -> PyResult<Options> {
    let mut settings = Vec::new();
    for (name, value) in keywords.into_iter().flatten() {
        let text = if let Ok(flag) = value.extract::<bool>() {
            flag.to_string()
        } else if let Ok(items) = value.extract::<Vec<Bound<PyAny>>>() {
            items.iter().map(|item| item.to_string()).collect::<Vec<_>>().join(",")
        } else {
            value.to_string()
        };
        settings.push((name.to_string(), text));
    }
    Options::from_settings(settings.iter().map(|(name, value)| (name.as_str(), value.clone()))).map_err(exception)
}

/// Whether libsumo runs sumo-gui. traci is not asked, because a plain SUMO would print an error.
fn has_gui(source: &Bound<PyAny>) -> bool {
    pull::is_libsumo(source) && source.call_method0("hasGUI").is_ok_and(|has| has.is_truthy().unwrap_or(false))
}
