//! Starts and closes SUMO; the net is read meanwhile.

use std::path::{Path, PathBuf};
use std::sync::mpsc::RecvTimeoutError;
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use closecall::Net;
use closecall::geometry::Bounds;
use closecall_cli::{RunRequest, ShowRequest};
use closecall_run::input::sumo_files;
use closecall_run::{Error, Result};
use pyo3::exceptions::{PyImportError, PyModuleNotFoundError};
use pyo3::prelude::*;

use crate::error::message;
use crate::paint::colours;

/// A sumo-gui that does not close within this time never will.
const CLOSES_WITHIN: Duration = Duration::from_secs(10);

/// The net that the configuration names, and its path. Another thread reads it while SUMO starts.
pub struct NetAhead(JoinHandle<Option<(PathBuf, Result<Net>)>>);

impl NetAhead {
    /// Begins to read the net if the request allows a second thread, and the system gives one.
    pub fn begin(request: &RunRequest) -> Option<Self> {
        let configuration = request.scenario.clone();
        let read =
            move || sumo_files::net_of(&configuration).map(|path| (path.clone(), closecall_run::net::read(&path)));
        if request.threads > 1 { Builder::new().spawn(read).ok().map(Self) } else { None }
    }

    /// The net at this path. It is read now if SUMO's options name another net than the configuration does.
    pub fn finish(ahead: Option<Self>, path: &Path) -> Result<Net> {
        match ahead.map(|Self(net)| net.join()) {
            Some(Ok(Some((read, net)))) if read == path => net,
            _ => closecall_run::net::read(path),
        }
    }
}

/// Starts SUMO with the scenario, ready for its first step.
pub fn start<'py>(py: Python<'py>, request: &RunRequest) -> Result<Bound<'py, PyAny>> {
    let refused = |error| refused(py, &request.scenario, &error);
    let starter = py.import("closecall._sumo").map_err(refused)?;
    if request.gui.is_some() {
        check_display(&starter)?;
    }
    starter.call_method1("start", (request.sumo_words.clone(), request.gui.is_some())).map_err(refused)
}

/// The error where SUMO does not start.
fn refused(py: Python, scenario: &Path, error: &PyErr) -> Error {
    if error.is_instance_of::<PyImportError>(py) {
        not_loaded(py, error, "libsumo")
    } else {
        let refusal = Error::Refused { path: scenario.to_owned(), message: message(py, error) };
        sumo_files::fault(scenario).unwrap_or(refusal)
    }
}

/// The error where libsumo cannot be imported: these packages are missing, or libraries of the system that it needs, even
/// without a window.
fn not_loaded(py: Python, error: &PyErr, packages: &str) -> Error {
    let message = message(py, error);
    Error::Value(if error.is_instance_of::<PyModuleNotFoundError>(py) {
        format!("libsumo is not installed ({message}): pip install {packages}")
    } else {
        format!(
            "libsumo cannot be loaded ({message}): it needs libraries of the system; on Debian and Ubuntu: apt install \
             libgl1 libxext6 libxrender1 libatomic1"
        )
    })
}

/// Saves the options that SUMO has with these words; nothing is simulated.
pub fn save_configuration(py: Python, args: &[String], to: &Path) -> Result<()> {
    let configuration = args.iter().position(|word| word == "-c").and_then(|place| args.get(place + 1));
    let scenario = PathBuf::from(configuration.unwrap_or(&String::new()));
    let refused = |error| refused(py, &scenario, &error);
    let starter = py.import("closecall._sumo").map_err(refused)?;
    let args = [args, &["--save-configuration".to_owned(), to.display().to_string()]].concat();
    let started = starter.call_method1("start", (args, false)).map_err(refused);
    close(py, false);
    started.map(drop)
}

/// Writes the part of a net that is within bounds as OpenDRIVE.
pub fn convert_net(py: Python, net: &Path, within: &Bounds, to: &Path) -> Result<()> {
    let refused = |error| Error::content(net, message(py, &error));
    let starter = py.import("closecall._sumo").map_err(refused)?;
    let corners = [within.low.x, within.low.y, within.high.x, within.high.y];
    starter.call_method1("convert_net", (net, corners, to)).map(drop).map_err(refused)
}

/// Checks that sumo-gui can be shown: without a display it ends the whole process without a message.
pub fn check_display(starter: &Bound<PyModule>) -> Result<()> {
    if starter.call_method0("has_display").is_ok_and(|has| !has.is_truthy().unwrap_or(true)) {
        let message = "sumo-gui needs a display: set DISPLAY, or run closecall under xvfb-run (apt install xvfb); closecall \
                       clip draws a conflict without one";
        return Err(Error::Value(message.to_owned()));
    }
    Ok(())
}

/// Shows a clip in sumo-gui until the user has seen enough of it.
pub fn show(py: Python, request: &ShowRequest) -> Result<()> {
    let failed = |error: PyErr| {
        if error.is_instance_of::<PyImportError>(py) {
            return not_loaded(py, &error, "libsumo eclipse-sumo");
        }
        Error::Value(format!("sumo-gui: {}", message(py, &error)))
    };
    check_display(&py.import("closecall._sumo").map_err(failed)?)?;
    let ShowRequest { scene, label, quit_on_end } = request;
    let player = py.import("closecall._show").map_err(failed)?;
    let shown = colours(py).and_then(|colours| player.call_method1("show", (scene, colours, label, quit_on_end)));
    close(py, true);
    shown.map(drop).map_err(failed)
}

/// Leaves the window as it is until the user presses Enter; at once without a terminal.
pub fn wait_for_user(py: Python) {
    // What is to be reported is reported by now.
    let _ = py.import("closecall._sumo").and_then(|starter| starter.call_method0("wait_for_user"));
}

/// Closes SUMO. Errors are ignored, because what matters is reported by now.
pub fn close(py: Python, gui: bool) {
    let (closed, waiting) = std::sync::mpsc::channel::<()>();
    let watch = move || {
        if waiting.recv_timeout(CLOSES_WITHIN) == Err(RecvTimeoutError::Timeout) {
            eprintln!("closecall: sumo-gui does not close; the log is complete");
            std::process::exit(1);
        }
    };
    // Where the system gives no thread, it is waited for however long it takes.
    let watch = if gui { Builder::new().spawn(watch).ok() } else { None };
    let _ = py.import("closecall._sumo").and_then(|starter| starter.call_method1("close", (gui,)));
    drop(closed);
    if let Some(watch) = watch {
        let _ = watch.join();
    }
}
