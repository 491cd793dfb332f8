//! The step listener: a run that is fed from libsumo, traci or arrays in somebody's own script.

use std::path::PathBuf;

use closecall::log::Log;
use closecall::net::Net;
use closecall::options::Options;
use closecall::run::Run;
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::exception;
use crate::frames::Frames;
use crate::paint::Painter;
use crate::pull::{self, Source};

/// Python's `Checker`; what the package offers is derived from it.
#[pyclass(subclass, module = "closecall._closecall", name = "Checker")]
pub struct Checker {
    run: Run,
    input: Input,
    painter: Option<Painter>,
    is_closed: bool,
}

enum Input {
    Simulation(Source),
    Frames(Frames),
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
        let net = match (net, source) {
            (Some(path), _) => Some(std::sync::Arc::new(Net::read(&path).map_err(exception)?)),
            (None, Some(source)) => pull::net_of(source)?,
            (None, None) => None,
        };
        let with_heights = net.as_ref().is_none_or(|net| net.has_levels);
        let mut run = Run::new(&options, net).map_err(exception)?;
        if let Some(folder) = out {
            run.log_to(Log::create(&folder, options.log_encounters).map_err(exception)?, true);
        }
        let input = match source {
            Some(source) => {
                pull::add_obstacles(source, &mut run, &options.obstacles)?;
                Input::Simulation(Source::new(source, &options, with_heights)?)
            }
            None => Input::Frames(Frames::new(&options)),
        };
        let painter = match (source, paint) {
            (Some(source), None) if has_gui(source) => Some(Painter::new(source)),
            (Some(source), Some(true)) => Some(Painter::new(source)),
            _ => None,
        };
        Ok(Self { run, input, painter, is_closed: false })
    }

    #[pyo3(signature = (time=0.0, states=None))]
    fn step(&mut self, py: Python, time: f64, states: Option<&Bound<PyAny>>) -> PyResult<bool> {
        if self.is_closed {
            return Err(PyRuntimeError::new_err("the checker is closed"));
        }
        match (&mut self.input, states) {
            (Input::Simulation(source), None) => {
                source.pull(py, &mut self.run)?;
                let rows = py.detach(|| self.run.approach().to_vec());
                source.place(py, &mut self.run, &rows)?;
            }
            (Input::Frames(frames), Some(states)) => {
                frames.pull(&mut self.run, time, states)?;
                py.detach(|| self.run.approach().len());
            }
            (Input::Simulation(_), Some(_)) => {
                return Err(PyTypeError::new_err("a checker with a simulation takes no states: it asks for them"));
            }
            (Input::Frames(_), None) => {
                return Err(PyTypeError::new_err("a checker without a simulation needs states: step(time, states)"));
            }
        }
        py.detach(|| self.run.finish_step().map(|_| ())).map_err(exception)?;
        if let Some(painter) = &mut self.painter {
            painter.paint(py, &self.run)?;
        }
        Ok(true)
    }

    fn close(&mut self, py: Python) -> PyResult<()> {
        if std::mem::replace(&mut self.is_closed, true) {
            return Ok(());
        }
        self.run.finish(Vec::new()).map_err(exception)?;
        self.run.take_log();
        match &mut self.painter {
            Some(painter) => painter.clear(py),
            None => Ok(()),
        }
    }

    #[getter]
    fn conflicts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let conflicts = self.run.conflicts();
        PyList::new(py, conflicts.into_iter().map(|conflict| Conflict::new(conflict, self.run.net())))
    }

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

fn has_gui(source: &Bound<PyAny>) -> bool {
    source.call_method0("hasGUI").is_ok_and(|has| has.is_truthy().unwrap_or(false))
}

/// One conflict, as Python sees it.
#[pyclass(frozen, get_all, module = "closecall", name = "Conflict")]
pub struct Conflict {
    ego: String,
    foe: String,
    kind: &'static str,
    severity: &'static str,
    begin: f64,
    end: f64,
    time: f64,
    gap: f64,
    mu: f64,
    margin: f64,
    clearance: f64,
    ttc: Option<f64>,
    drac: Option<f64>,
    pet: Option<f64>,
    delta_v: f64,
    ego_speed: f64,
    foe_speed: f64,
    angle: f64,
    x: f64,
    y: f64,
    lane: Option<String>,
    collision: bool,
}

impl Conflict {
    fn new(from: closecall::conflict::Conflict, net: Option<&Net>) -> Self {
        Self {
            ego: from.ego.to_string(),
            foe: from.foe.to_string(),
            kind: from.kind.name(),
            severity: from.severity.name(),
            begin: from.begin,
            end: from.end,
            time: from.time,
            gap: from.gap,
            mu: from.mu,
            margin: from.margin,
            clearance: from.clearance,
            ttc: from.ttc,
            drac: from.drac,
            pet: from.pet,
            delta_v: from.delta_v,
            ego_speed: from.ego_speed,
            foe_speed: from.foe_speed,
            angle: from.angle,
            x: from.x,
            y: from.y,
            lane: from.lane.and_then(|lane| net.map(|net| net.lane_id(lane).to_owned())),
            collision: from.collision,
        }
    }
}

#[pymethods]
impl Conflict {
    fn __repr__(&self) -> String {
        let Self { ego, foe, kind, severity, time, margin, .. } = self;
        format!("Conflict(ego={ego:?}, foe={foe:?}, kind={kind}, severity={severity}, time={time}, margin={margin:.3})")
    }
}
