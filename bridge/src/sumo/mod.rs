//! Reads road users from libsumo or traci into a [`Run`].

#[cfg(compiled_getters)]
mod compiled;
#[cfg(not(compiled_getters))]
#[path = "not_compiled.rs"]
mod compiled;
mod getters;
mod identity;
mod libsumo;
mod libsumo_domain;
mod reading;
mod simulation;
mod steer;
mod traci;
mod wire;

use closecall::Options;
use closecall::util::units::Second;
use closecall_run::Run;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use self::getters::Through;
use self::libsumo::Libsumo;
use self::traci::Traci;

pub use identity::Identity;
use simulation::is_ballistic;
pub use simulation::{add_obstacles, net_of, option};
pub use steer::Steering;

/// A simulation that is being read.
pub enum Source {
    /// libsumo, in this process: through its getters.
    Libsumo(Box<Libsumo>),
    /// traci, over its socket: through messages of many requests.
    Traci(Box<Traci>),
}

impl Source {
    /// The source for a Python object: the module libsumo, the module traci or a traci connection. Sets the run up for the
    /// simulation's lateral model. A mesoscopic simulation is refused, because it does not locate single vehicles.
    pub fn new(source: &Bound<PyAny>, run: &mut Run, options: &Options) -> PyResult<Self> {
        if option(source, "mesosim")? == "true" {
            let message = "mesosim: the mesoscopic model locates queues, not the road users in them; \
                           closecall needs the microscopic one";
            return Err(PyValueError::new_err(message));
        }
        if option(source, "lateral-resolution")?.parse::<f64>().is_ok_and(|width| width > 0.0) {
            run.set_sublane(true);
        }
        run.set_averaged_over(if is_ballistic(source)? { 0.0 } else { 1.0 });
        Ok(if is_libsumo(source) {
            Self::Libsumo(Box::new(Libsumo::new(source, options)?))
        } else {
            Self::Traci(Box::new(Traci::new(source, options)?))
        })
    }

    /// States that only the caller makes steps and reads each of them, and that only SUMO itself removes road users.
    pub fn set_exclusive(&mut self) {
        match self {
            Self::Libsumo(source) => source.set_exclusive(),
            Self::Traci(_) => {}
        }
    }

    /// States that SUMO's lists of a step do not name all road users that entered, left or parked since the last one.
    pub fn look_up_all(&mut self) {
        match self {
            Self::Libsumo(source) => source.look_up_all(),
            Self::Traci(source) => source.look_up_all(),
        }
    }

    /// What road users are read through, as in docs/attach.md.
    pub fn getters(&self) -> &'static str {
        match self {
            Self::Libsumo(source) => match source.through() {
                Through::Direct => "direct",
                Through::Libsumo => "libsumo",
                Through::Python => "python",
            },
            Self::Traci(_) => "traci",
        }
    }

    /// Why road users are read more slowly than is to be expected; only the first time.
    pub fn take_remark(&mut self) -> Option<String> {
        match self {
            Self::Libsumo(source) => source.take_remark(),
            Self::Traci(_) => None,
        }
    }

    /// The time of the current states, as in SUMO's own outputs.
    pub fn time(&self, py: Python) -> PyResult<Second> {
        match self {
            Self::Libsumo(source) => source.time(py),
            Self::Traci(source) => source.time(py),
        }
    }

    /// Begins a step of the run with the current states of all road users, whose time is `time`.
    pub fn pull(&mut self, py: Python, run: &mut Run, time: Second) -> PyResult<()> {
        match self {
            Self::Libsumo(source) => source.pull(py, run, time),
            Self::Traci(source) => source.pull(py, run, time),
        }
    }

    /// Updates the run's paths and sets the placements that it asks for.
    pub fn update_paths(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        py.detach(|| run.update_paths(|run, rows| Python::attach(|py| self.place(py, run, rows))))
    }

    /// Sets the placements of these rows.
    fn place(&mut self, py: Python, run: &mut Run, rows: &[u32]) -> PyResult<()> {
        match self {
            Self::Libsumo(source) => source.place(py, run, rows),
            Self::Traci(source) => source.place(py, run, rows),
        }
    }
}

/// Whether a source is libsumo: the module itself, or traci where `LIBSUMO_AS_TRACI` fills it with libsumo's functions.
pub fn is_libsumo(source: &Bound<PyAny>) -> bool {
    source.call_method0("isLibsumo").is_ok_and(|is| is.is_truthy().unwrap_or(false))
}
