//! From libsumo or traci into a [`closecall::run::Run`]: who is in the scene, and where.

#[cfg(compiled_getters)]
mod compiled;
mod getters;
mod libsumo;
mod reading;
mod sumo;
mod traci;

use closecall::options::Options;
use closecall::run::Run;
use closecall::util::units::Second;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use self::libsumo::Libsumo;
use self::traci::Traci;

pub use sumo::{add_obstacles, net_of, option};

/// Where road users come from.
pub enum Source {
    /// libsumo, in this process: through its getters.
    Libsumo(Box<Libsumo>),
    /// traci, over its socket: through subscriptions.
    Traci(Box<Traci>),
}

impl Source {
    /// The source that a Python object is: the module libsumo, the module traci or one of traci's connections; the
    /// run is told what the simulation says of itself. A mesoscopic one is refused: all of a queue are in one place there.
    pub fn new(source: &Bound<PyAny>, run: &mut Run, options: &Options) -> PyResult<Self> {
        if option(source, "mesosim")? == "true" {
            let message = "mesosim: the mesoscopic model says of a queue where it is, not of each road user in it; \
                           closecall needs the microscopic one";
            return Err(PyValueError::new_err(message));
        }
        if option(source, "lateral-resolution")?.parse::<f64>().is_ok_and(|width| width > 0.0) {
            run.set_sublane(true);
        }
        Ok(if is_libsumo(source) {
            Self::Libsumo(Box::new(Libsumo::new(source, options)?))
        } else {
            Self::Traci(Box::new(Traci::new(source, options)?))
        })
    }

    /// Says that nobody but the caller makes steps, none of them is missed, and nobody takes road users out of the
    /// simulation but SUMO itself.
    pub fn set_exclusive(&mut self) {
        match self {
            Self::Libsumo(source) => source.set_exclusive(),
            Self::Traci(_) => {}
        }
    }

    /// The time of the states of now, as SUMO's own outputs have it.
    pub fn time(&self, py: Python) -> PyResult<Second> {
        match self {
            Self::Libsumo(source) => source.time(py),
            Self::Traci(source) => source.time(py),
        }
    }

    /// Begins a step of the run with every road user's state of now, whose time this is.
    pub fn pull(&mut self, py: Python, run: &mut Run, time: Second) -> PyResult<()> {
        match self {
            Self::Libsumo(source) => source.pull(py, run, time),
            Self::Traci(source) => source.pull(py, run, time),
        }
    }

    /// Tells the run where the road users of these rows are on the net.
    pub fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        match self {
            Self::Libsumo(source) => source.place(py, run, rows),
            Self::Traci(source) => source.place(py, run, rows),
        }
    }
}

/// Whether a source is the module libsumo.
pub fn is_libsumo(source: &Bound<PyAny>) -> bool {
    source.getattr("__name__").is_ok_and(|name| name.to_string() == "libsumo")
}
