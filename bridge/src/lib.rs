//! The Python module `closecall._closecall` and the list of what it exports.
//!
//! The bridge moves data and decides nothing: [`sumo`] reads road users from libsumo or traci, the crate `closecall` finds
//! the conflicts, [`paint`] shows them in sumo-gui.

mod alarm;
mod checker;
mod checker_state;
mod conflict;
mod error;
mod exclusive;
mod film;
mod frame_file;
mod frames;
mod functions;
mod interrupts;
mod numbers;
mod paint;
mod provenance;
mod replay;
mod rows;
mod run;
mod say;
mod session;
mod start;
mod step_times;
mod sumo;
mod sweep;
mod table;

use pyo3::prelude::*;

/// What `import closecall` loads from Rust.
#[pymodule]
mod _closecall {
    #[pymodule_export]
    use super::alarm::Alarm;
    #[pymodule_export]
    use super::checker::Checker;
    #[pymodule_export]
    use super::conflict::{Conflict, read_log};
    #[pymodule_export]
    use super::functions::{distance, mu, touches};
    #[pymodule_export]
    use super::replay::replay;
    #[pymodule_export]
    use super::run::{main, scenario};
    #[pymodule_export]
    use super::sweep::finish_run;
    #[pymodule_export]
    use super::table::{Table, read};

    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        closecall_cli::keep_panics_quiet();
        Conflict::add_attributes(module.py())?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
