//! From libsumo or traci into a [`closecall::run::Run`]: who is in the scene, and where.

mod libsumo;
mod sumo;
mod traci;

use closecall::options::Options;
use closecall::run::Run;
use pyo3::prelude::*;

pub use sumo::{add_obstacles, net_of, option};

use self::libsumo::Libsumo;
use self::traci::Traci;

/// Where road users come from.
pub enum Source {
    /// libsumo, in this process: through its compiled getters.
    Libsumo(Box<Libsumo>),
    /// traci, over its socket: through subscriptions.
    Traci(Box<Traci>),
}

impl Source {
    /// The source that a Python object is: the module libsumo, the module traci or one of traci's connections.
    pub fn new(source: &Bound<PyAny>, options: &Options, with_heights: bool) -> PyResult<Self> {
        let is_libsumo = source.getattr("__name__").is_ok_and(|name| name.to_string() == "libsumo");
        Ok(if is_libsumo {
            Self::Libsumo(Box::new(Libsumo::new(source, options, with_heights)?))
        } else {
            Self::Traci(Box::new(Traci::new(source, options, with_heights)?))
        })
    }

    /// Asks for all vehicle types that SUMO knows so far, so that an impossible one is told of before the first step.
    pub fn check_types(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        match self {
            Self::Libsumo(source) => source.types().check(py, run),
            Self::Traci(source) => source.types().check(py, run),
        }
    }

    /// Begins a step of the run with every road user's state of now.
    pub fn pull(&mut self, py: Python, run: &mut Run) -> PyResult<()> {
        match self {
            Self::Libsumo(source) => source.pull(py, run),
            Self::Traci(source) => source.pull(py, run),
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
