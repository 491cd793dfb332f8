//! The step listener: a run that a Python script feeds from libsumo, traci or arrays.

use std::path::{Path, PathBuf};

use closecall_run::output::schema::COLUMNS;
use closecall_run::util::panics::caught;
use closecall_run::{LogFolder, OutputFiles, RecordedRun, Run, RunOptions};
use pyo3::exceptions::{PyRuntimeError, PyRuntimeWarning, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::alarm::{self, Alarm, Listeners};
use crate::checker_state::{Feed, State};
use crate::conflict::{Conflict, logged};
use crate::error::exception;
use crate::exclusive::Exclusive;
use crate::frames::Frames;
use crate::paint::Painter;
use crate::rows::Rows;
use crate::sumo::{self, Identity, Source};
use crate::table::Table;
use crate::{provenance, say};

/// The closed conflicts that stay in memory where a log has all of them: about 10 MB.
const KEPT: usize = 10_000;
/// The folder beside which `out="auto"` makes a new one.
const AUTO: &str = "closecall-out";

/// Finds the conflicts of a simulation, or of plain frames, step by step.
///
/// Args:
///     source: the module libsumo, the module traci or a traci connection, with a simulation started; None if `step`
///         gets frames.
///     net: the net file; by default the simulation's own.
///     out: a folder for the log (conflicts.csv, run.json; series.csv with `log_series=True`, series.parquet with
///         `log_series="parquet"`); by default no log is written. An earlier log is moved to `earlier/` within it;
///         "auto" makes a new folder closecall-out-N.
///     force: whether to replace an earlier log instead of keeping it.
///     keep: how many closed conflicts stay in memory for `conflicts`, the latest; by default all, or 10,000 with `out`.
///     paint: whether to colour the vehicles in conflict; by default only if libsumo runs sumo-gui.
///     on_conflict: called with each `Conflict` when it has closed and is settled: 1 s after the last step that meets the log's
///         condition, some seconds later where a PET is waited for.
///     on_alarm: called with an `Alarm` in the step in which a conflict opens.
///     **options: the long options of the command line, with underscores: `mu="at_rest"`, `epsilon=1.0`.
///
/// Raises:
///     ValueError: an option is unknown or out of its range, the net cannot be used, or the simulation is mesoscopic; the
///         message says which.
///     RuntimeError: no simulation is started.
///     OSError: a file or folder cannot be read or written.
#[pyclass(subclass, frozen, module = "closecall._closecall", name = "Checker")]
pub struct Checker {
    state: Exclusive<State>,
    has_simulation: bool,
}

#[pymethods]
impl Checker {
    #[new]
    #[pyo3(signature = (source=None, *, net=None, out=None, force=false, paint=None, keep=None, on_conflict=None,
        on_alarm=None, **options))]
    #[expect(clippy::too_many_arguments, reason = "each is a keyword in Python")]
    fn new(
        py: Python,
        source: Option<&Bound<PyAny>>,
        net: Option<PathBuf>,
        out: Option<PathBuf>,
        force: bool,
        paint: Option<bool>,
        keep: Option<usize>,
        on_conflict: Option<Py<PyAny>>,
        on_alarm: Option<Py<PyAny>>,
        options: Option<&Bound<PyDict>>,
    ) -> PyResult<Self> {
        let options = options_from(options)?;
        options.model.check_future_is_unknown().map_err(exception)?;
        let given = net.clone();
        let net = match (net, source) {
            (Some(path), _) => Some(std::sync::Arc::new(closecall_run::net::read(&path).map_err(exception)?)),
            (None, Some(source)) => sumo::net_of(source)?,
            (None, None) => None,
        };
        let mut run = Run::new(&options, net).map_err(exception)?;
        run.keep_probabilities();
        let keep = keep.unwrap_or(if out.is_some() { KEPT } else { usize::MAX });
        // A listener gets each conflict before it is dropped.
        run.keep_closed_conflicts(if on_conflict.is_some() { usize::MAX } else { keep });
        let feed = match source {
            Some(source) => {
                sumo::add_obstacles(source, &mut run, &options.log.obstacles)?;
                let identity = Box::new(Identity::of(source)?);
                let mut source = Box::new(Source::new(source, &mut run, &options.model)?);
                if let Some(remark) = source.take_remark() {
                    say::how_sumo_is_read(py, &remark)?;
                }
                Feed::Simulation(source, identity)
            }
            None => Feed::Frames(Box::new(Frames::new(&options.model))),
        };
        let recorded = match out {
            Some(out) => {
                let record = provenance::record_of_script(source, given, &run, &options)?;
                let files = OutputFiles { force, ..OutputFiles::default() };
                let is_auto = out == Path::new("auto");
                let folder = if is_auto { LogFolder::claim_new(Path::new(AUTO)) } else { LogFolder::claim(&out) };
                let folder = folder.map_err(exception)?;
                let recorded = RecordedRun::open(run, record, folder, &files).map_err(exception)?;
                if let Some(line) = recorded.earlier_log() {
                    say::line(py, &line.text)?;
                }
                recorded
            }
            None => RecordedRun::in_memory(run),
        };
        let painter = match (source, paint) {
            (Some(source), None) if has_gui(source) => Some(Painter::new(source, false, false)?),
            (Some(source), Some(true)) => Some(Painter::new(source, false, false)?),
            _ => None,
        };
        let listeners = Listeners::new(on_conflict, on_alarm, keep);
        let state = State { recorded, feed, painter, listeners, is_closed: false, listens: false, has_listened: false };
        Ok(Self { state: Exclusive::new(state), has_simulation: source.is_some() })
    }

    /// Check one step. A simulation calls this itself if the checker is its step listener.
    ///
    /// A frame that is refused changes nothing. If the log cannot be written any more (a full disk), the checker warns
    /// once, says so in `log_error`, and goes on without writing.
    ///
    /// Args:
    ///     time: simulated time in s, later than the last; only with `states`.
    ///     states: without a simulation, a mapping of columns of equal length: `id`, `x`, `y` (front-bumper centre, m),
    ///         `heading` (rad, counter-clockwise from +x), `speed` (m/s) and, if known, `category` (`vehicle`, `bicycle`,
    ///         `person`, `obstacle`), `z`, `length`, `width` (m), `decel` (m/s²), `mass` (kg). A road user without a row is
    ///         not in the scene.
    ///
    /// Returns:
    ///     Whether the listener wants the next step too: a simulation drops closed listeners. If another simulation or state
    ///     was loaded meanwhile, the checker closes itself with a warning.
    ///
    /// Raises:
    ///     ValueError: a column is missing, unknown, has another length or no real numbers, an id occurs twice, the time is
    ///         not after the last one, dimensions, a place or a speed are impossible (docs/limits.md), or too many are in one
    ///         place, which ends the checker.
    ///     RuntimeError: the checker is closed and has no simulation, or closecall itself failed.
    #[pyo3(signature = (time=0.0, states=None))]
    fn step(&self, py: Python, time: f64, states: Option<&Bound<PyAny>>) -> PyResult<bool> {
        let rows = match (self.has_simulation, states) {
            (true, None) => None,
            (false, Some(states)) => Some(Rows::read(states)?),
            (true, Some(_)) => {
                let message = "a checker with a simulation takes no states: it reads them itself";
                return Err(PyTypeError::new_err(message));
            }
            (false, None) => {
                let message = "a checker without a simulation needs states: step(time, states)";
                return Err(PyTypeError::new_err(message));
            }
        };
        let stepped = self.state.with(py, |state| {
            caught(|| state.check(py, time, rows.as_ref())).unwrap_or_else(|fault| state.abandon(fault))
        })?;
        if let Some(warning) = stepped.warning {
            py.import("warnings")?.call_method1("warn", (warning, py.get_type::<PyRuntimeWarning>()))?;
        }
        self.tell(py)?;
        Ok(stepped.goes_on)
    }

    /// End the run: close and write the open conflicts, and restore the colours of painted vehicles.
    fn close(&self, py: Python) -> PyResult<()> {
        self.end(py, None)
    }

    /// The same, with the error that ended the run early, if there was one.
    #[pyo3(name = "_end")]
    fn end(&self, py: Python, error: Option<String>) -> PyResult<()> {
        self.state.with(py, |state| state.end(py, error))?;
        self.tell(py)
    }

    /// Whether a simulation calls each step from now on.
    #[pyo3(name = "_listen")]
    fn listen(&self, py: Python, listens: bool) -> PyResult<()> {
        self.state.with(py, |state| {
            (state.listens, state.has_listened) = (listens, false);
            Ok(())
        })
    }

    /// The simulated time of the last step, in s; None before the first.
    #[getter]
    fn time(&self, py: Python) -> PyResult<Option<f64>> {
        self.state.with(py, |state| Ok(state.recorded.run.time()))
    }

    /// The conflicts that are open now, for a script that reacts while the simulation runs; without those that are not
    /// traffic's, unless the option `artefacts` counts them.
    #[getter]
    fn active(&self, py: Python) -> PyResult<Vec<Alarm>> {
        self.state.with(py, |state| Ok(alarm::active(&state.recorded.run)))
    }

    /// The conflicts that are over but wait for the second road user to come and pass, for some seconds: `pet_at_least` tells
    /// how long ago the first left.
    #[getter]
    fn waiting(&self, py: Python) -> PyResult<Vec<Alarm>> {
        self.state.with(py, |state| Ok(alarm::waiting(&state.recorded.run)))
    }

    /// The conflicts so far; the latest `keep` of the closed ones, and the open ones as they are now. As in the log those with
    /// an `artefact` are among them, which `summary`, `active` and rewards do not count (docs/artefacts.md).
    #[getter]
    fn conflicts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let conflicts = self.state.with(py, |state| Ok(logged(&state.recorded.run)))?;
        PyList::new(py, conflicts.into_iter().map(Conflict))
    }

    /// The same conflicts as a `Table` of Arrow columns, for pandas, Polars, DuckDB or PyArrow.
    fn table(&self, py: Python) -> PyResult<Table> {
        self.state.with(py, |state| {
            let run = &state.recorded.run;
            let columns = COLUMNS.iter().filter(|column| column.is_in(run.measures())).collect::<Vec<_>>();
            Table::of(&columns, logged(run).into_iter().map(Ok), |error: PyErr| error)
        })
    }

    /// Counts by kind and severity, what was set aside, the amount of traffic and, once it is closed, the skipped tests; as in `run.json`.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let summary = self.state.with(py, |state| Ok(state.recorded.run.summary()))?;
        let text = serde_json::to_string(&summary).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        py.import("json")?.call_method1("loads", (text,))
    }

    /// What road users are read through: "direct", "libsumo", "python" or "traci" (docs/attach.md); None without a simulation.
    #[getter]
    fn getters(&self, py: Python) -> PyResult<Option<&'static str>> {
        self.state.with(py, |state| {
            Ok(match &state.feed {
                Feed::Simulation(source, _) => Some(source.getters()),
                Feed::Frames(_) => None,
            })
        })
    }

    /// Why the log is no longer written; None while it is, and without a log.
    #[getter]
    fn log_error(&self, py: Python) -> PyResult<Option<String>> {
        self.state.with(py, |state| Ok(state.recorded.run.log_error().map(str::to_owned)))
    }
}

impl Checker {
    /// Tells the script what is new; its functions may use the checker.
    fn tell(&self, py: Python) -> PyResult<()> {
        let news = self.state.with(py, |state| state.listeners.news(py, &mut state.recorded.run))?;
        news.into_iter().try_for_each(|(listener, what)| listener.call1(py, (what,)).map(drop))
    }
}

/// The options that Python keywords set.
pub fn options_from(keywords: Option<&Bound<PyDict>>) -> PyResult<RunOptions> {
    let mut settings = Vec::new();
    for (name, value) in keywords.into_iter().flatten() {
        if let Some(remark) = RunOptions::old_name(&name.to_string()) {
            say::old_name(name.py(), remark)?;
        }
        let text = if let Ok(flag) = value.extract::<bool>() {
            flag.to_string()
        } else if let Ok(items) = value.extract::<Vec<Bound<PyAny>>>() {
            items.iter().map(|item| item.to_string()).collect::<Vec<_>>().join(",")
        } else {
            value.to_string()
        };
        settings.push((name.to_string(), text));
    }
    RunOptions::from_settings(settings.iter().map(|(name, value)| (name.as_str(), value.clone()))).map_err(exception)
}

/// Whether libsumo runs sumo-gui. traci is not asked, because a plain SUMO would print an error.
fn has_gui(source: &Bound<PyAny>) -> bool {
    sumo::is_libsumo(source) && source.call_method0("hasGUI").is_ok_and(|has| has.is_truthy().unwrap_or(false))
}
