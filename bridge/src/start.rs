//! Starts and closes SUMO; the net is read meanwhile.

use std::path::{Path, PathBuf};
use std::sync::mpsc::RecvTimeoutError;
use std::thread::JoinHandle;
use std::time::Duration;

use closecall::cli::RunRequest;
use closecall::internals::input as sumo_files;
use closecall::{Error, Net, Result};
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;

use crate::error::message;

/// A sumo-gui that does not close within this time never will.
const CLOSES_WITHIN: Duration = Duration::from_secs(10);

/// The net that the configuration names, and its path. Another thread reads it while SUMO starts.
pub struct NetAhead(JoinHandle<Option<(PathBuf, Result<Net>)>>);

impl NetAhead {
    /// Begins to read the net if the request allows a second thread.
    pub fn begin(request: &RunRequest) -> Option<Self> {
        let configuration = request.scenario.clone();
        let read = move || sumo_files::net_of(&configuration).map(|path| (path.clone(), Net::read(&path)));
        (usize::from(request.threads) > 1).then(|| Self(std::thread::spawn(read)))
    }

    /// The net at this path. It is read now if SUMO's options name another net than the configuration does.
    pub fn finish(ahead: Option<Self>, path: &Path) -> Result<Net> {
        match ahead.map(|Self(net)| net.join()) {
            Some(Ok(Some((read, net)))) if read == path => net,
            _ => Net::read(path),
        }
    }
}

/// Starts SUMO with the scenario, ready for its first step.
pub fn start<'py>(py: Python<'py>, request: &RunRequest) -> Result<Bound<'py, PyAny>> {
    let refused = |error: PyErr| {
        if error.is_instance_of::<PyImportError>(py) {
            Error::Value(format!("libsumo is not installed ({}): pip install libsumo", message(py, &error)))
        } else {
            let refusal = Error::Refused { path: request.scenario.clone(), message: message(py, &error) };
            sumo_files::fault(&request.scenario).unwrap_or(refusal)
        }
    };
    let starter = py.import("closecall._sumo").map_err(refused)?;
    if request.gui && starter.call_method0("has_display").is_ok_and(|has| !has.is_truthy().unwrap_or(true)) {
        let message = "sumo-gui needs a display: set DISPLAY, or run closecall under xvfb-run";
        return Err(Error::Value(message.to_owned()));
    }
    starter.call_method1("start", (request.sumo_words.clone(), request.gui)).map_err(refused)
}

/// Closes SUMO. Errors are ignored, because what matters is reported by now.
pub fn close(py: Python, gui: bool) {
    let (closed, waiting) = std::sync::mpsc::channel::<()>();
    let watch = gui.then(|| {
        std::thread::spawn(move || {
            if waiting.recv_timeout(CLOSES_WITHIN) == Err(RecvTimeoutError::Timeout) {
                eprintln!("closecall: sumo-gui does not close; the log is complete");
                std::process::exit(1);
            }
        })
    });
    let _ = py.import("closecall._sumo").and_then(|starter| starter.call_method1("close", (gui,)));
    drop(closed);
    if let Some(watch) = watch {
        let _ = watch.join();
    }
}
