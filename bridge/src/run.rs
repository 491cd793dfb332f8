//! `closecall run`: starts SUMO through libsumo, attaches the checker, and closes both.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use ::closecall_cli;
use closecall::detection::detector::LeftOut;
use closecall::geometry::Bounds;
use closecall_analysis::batch::sweep::Task;
use closecall_cli::{FilmRequest, ReportEnd, RunRequest, ShowRequest, Sumo, Workers};
use closecall_run::input::sumo_files;
use closecall_run::output::input_hash::Input;
use closecall_run::{Ending, Error, LogFolder, RecordedRun, Result, Run, RunRecord, Summary};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error::{exception, message};
use crate::interrupts::Interrupts;
use crate::session::Session;
use crate::start::{self, NetAhead};
use crate::step_times::StepTimes;
use crate::sumo::{self, Source};
use crate::{film, provenance, sweep};

/// The command `closecall`; returns its exit status.
#[pyfunction]
pub fn main(py: Python, args: Vec<OsString>) -> PyResult<u8> {
    let interrupts = Interrupts::new(py)?;
    let mut simulate = |request: &RunRequest, folder: LogFolder| simulate(py, request, folder, &interrupts);
    let mut show = |request: &ShowRequest| start::show(py, request);
    let mut make_film = |request: &FilmRequest| film::film(py, request);
    let mut save_configuration = |args: &[String], to: &Path| start::save_configuration(py, args, to);
    let mut convert_net = |net: &Path, within: &Bounds, to: &Path| start::convert_net(py, net, within, to);
    let mut interrupted = || interrupts.had_any();
    let mut distribute = |workers: &Workers, folder: &Path, tasks: &[&Task], outcome: &mut ReportEnd| {
        interrupts.report();
        sweep::distribute(py, workers, folder, tasks, outcome)
    };
    let sumo = Sumo {
        simulate: &mut simulate,
        show: &mut show,
        film: &mut make_film,
        save_configuration: &mut save_configuration,
        convert_net: &mut convert_net,
        distribute: &mut distribute,
        closecall: closecall(py)?,
        interrupted: &mut interrupted,
    };
    Ok(closecall_cli::main(args, Some(sumo)))
}

/// The scenario at a path, for the pytest plugin: its folder, the command line to run there, the SUMO options at its end,
/// and its first seed.
#[pyfunction]
pub fn scenario(path: PathBuf) -> PyResult<(OsString, Vec<OsString>, Vec<String>, u32)> {
    let scenario = closecall_cli::scenario(&path).map_err(exception)?;
    let seed = scenario.settings.seeds.first().copied().unwrap_or_default();
    Ok((scenario.folder.clone().into_os_string(), scenario.args(), scenario.settings.sumo_options, seed))
}

/// The command line that starts closecall in a separate process, which ends when its standard input closes.
fn closecall(py: Python) -> PyResult<Vec<OsString>> {
    py.import("closecall._start")?.call_method1("command", ("_child",))?.extract()
}

/// Runs the scenario to its end.
fn simulate(py: Python, request: &RunRequest, folder: LogFolder, interrupts: &Interrupts) -> Result<Summary> {
    let ahead = NetAhead::begin(request);
    let sumo = start::start(py, request)?;
    let result = attach(&sumo, request, folder, ahead, interrupts);
    if request.gui.is_some_and(|gui| !gui.quit_on_end) && result.is_ok() {
        start::wait_for_user(py);
    }
    start::close(py, request.gui.is_some());
    interrupts.end_the_process();
    result
}

/// Checks the simulation that has been started.
fn attach(
    sumo: &Bound<PyAny>,
    request: &RunRequest,
    folder: LogFolder,
    ahead: Option<NetAhead>,
    interrupts: &Interrupts,
) -> Result<Summary> {
    let refused = |error| refused(sumo.py(), request, &error);
    let files = provenance::files(sumo).map_err(refused)?;
    for path in &files.others {
        sumo_files::check_xml(path)?;
    }
    let net = files.net.as_deref().map(|path| NetAhead::finish(ahead, path)).transpose()?.map(Arc::new);
    let mut run = Run::new(&request.options, net)?;
    let source = connect(sumo, request, &mut run).map_err(refused)?;
    let record = RunRecord {
        sumo_words: request.sumo_words.clone(),
        inputs: files.with(&request.scenario).iter().map(|path| Input::of(path)).collect::<Result<_>>()?,
        ..provenance::record(Some(sumo), request.scenario.clone(), &run, &request.options).map_err(refused)?
    };
    if record.seed.is_none() && request.sumo_words.iter().any(|word| word == "--seed") {
        let message = "SUMO's option random is on, so that a seed has no effect: remove one of the two";
        return Err(Error::content(&request.scenario, message));
    }
    if !request.quiet {
        run.opening_remarks(record.step_length).iter().for_each(|remark| eprintln!("closecall: {remark}"));
    }
    let mut session = Session::new(sumo, request, source, record.step_length).map_err(refused)?;
    interrupts.report();
    let recorded = RecordedRun::open(run, record, folder, &request.outputs)?;
    let (recorded, outcome) = session.run_to_end(Box::new(recorded));
    let outcome = outcome.and_then(|()| session.write_roll_out());
    close(*recorded, request, outcome, &session.spent())
}

/// Sets the run up as the request and the simulation need it; returns the source of its road users.
fn connect(sumo: &Bound<PyAny>, request: &RunRequest, run: &mut Run) -> PyResult<Source> {
    run.set_threads(usize::from(request.threads).saturating_sub(1));
    run.drop_closed_conflicts();
    sumo::add_obstacles(sumo, run, &request.options.log.obstacles)?;
    // In sumo-gui the user may do anything, even add a rerouter.
    if request.gui.is_none() && has_no_rerouters(sumo)? {
        run.set_fixed_routes(true);
    }
    let mut source = Source::new(sumo, run, &request.options.model)?;
    if request.gui.is_none() {
        source.set_exclusive();
    }
    Ok(source)
}

/// Closes the log, or removes it if the scenario could not be used.
fn close(mut recorded: RecordedRun, request: &RunRequest, outcome: Result<()>, spent: &StepTimes) -> Result<Summary> {
    let [vehicles, persons] = recorded.run.entered();
    let is_empty = outcome.is_ok() && vehicles + persons == 0;
    let unusable = match &outcome {
        Ok(()) if is_empty => Some("the scenario is empty: no road user ever enters it"),
        Err(Error::Value(message)) => Some(&**message),
        _ => None,
    };
    if let Some(message) = unusable {
        recorded.discard();
        return Err(Error::content(&request.scenario, message));
    }
    let closed = recorded.close(Ending {
        error: outcome.as_ref().err().map(ToString::to_string),
        left_out: left_out(request, persons),
        spent: spent.seconds(),
        ..Ending::default()
    });
    outcome.and(closed)
}

/// The error for an exception before the first step.
fn refused(py: Python, request: &RunRequest, error: &PyErr) -> Error {
    let message = message(py, error);
    // The bridge's own refusals are ValueErrors, everything else comes from SUMO.
    if error.is_instance_of::<PyValueError>(py) {
        Error::content(&request.scenario, message)
    } else {
        Error::Refused { path: request.scenario.clone(), message }
    }
}

fn has_no_rerouters(sumo: &Bound<PyAny>) -> PyResult<bool> {
    sumo.getattr("rerouter")?.call_method0("getIDList")?.is_empty()
}

/// The work that the bridge could skip.
fn left_out(request: &RunRequest, persons: u64) -> Vec<LeftOut> {
    let mut left_out = Vec::new();
    if request.gui.is_none() {
        left_out.push(LeftOut::altogether("painting", "no sumo-gui"));
    }
    if persons == 0 {
        left_out.push(LeftOut::altogether("person tests", "none enters the scene"));
    }
    left_out
}
