//! `closecall.replay`: a recording, or a data frame of trajectories, checked in memory.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use closecall::util::remark::Remark;
use closecall_run::RunOptions;
use closecall_run::input::tracks::{
    NOISE, RecordingFormat, TrackOptions, TrackOrigin, USUAL_NOISE, open as open_tracks,
};
use closecall_run::output::schema::COLUMNS;
use closecall_run::{Error, Replay, Run};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::checker::options_from;
use crate::conflict::logged;
use crate::error::exception;
use crate::frame_file::written;
use crate::say;
use crate::table::Table;

/// How often Ctrl-C is looked for.
const ASKED: Duration = Duration::from_millis(50);

/// The conflicts of a recording, or of a data frame of trajectories, as a table.
///
/// Args:
///     data: the path of a recording, a list of paths of tables that are one recording, or anything with Arrow's C stream: a frame of
///         Polars or pandas, a table of PyArrow.
///     columns: which columns are what, in which unit: {"id": "trackId", "time": "t[ms]", "x": "xCenter", ...}, or the text of the
///         command line's --columns (docs/formats.md).
///     format: the format of a recording, as on the command line; by default detected from the file. frame_rate: frames per
///     second, where the time is a number of frames. origin: what x and y are: "centre" or "front". smooth: the standard
///     deviation in m of the noise in places, which are smoothed then; True is 0.1. By default nothing is
///         smoothed.
///     net: the net file; without one, paths follow no lanes.
///     route_files: route and additional files that define the types and routes of SUMO's recordings.
///     **options: the long options of the command line, with underscores: `path="arc"`, `log="ttc < 3"`.
///
/// The table's `remarks` are the lines that the command says. Those about what is in the data, such as rows that are left out, are also
/// written to sys.stderr; those about columns that are not there at all, and about the length of steps, are not.
///
/// Raises:
///     ValueError: the data cannot be used; the message names row and column.
///     OSError: a file cannot be read.
///     KeyboardInterrupt: Ctrl-C.
#[pyfunction]
#[pyo3(signature = (data, columns=None, *, format=None, frame_rate=None, origin=None, smooth=None, net=None, route_files=Vec::new(), **options))]
#[expect(clippy::too_many_arguments, reason = "each is a keyword in Python")]
pub fn replay(
    py: Python,
    data: &Bound<PyAny>,
    columns: Option<&Bound<PyAny>>,
    format: Option<&str>,
    frame_rate: Option<f64>,
    origin: Option<&str>,
    smooth: Option<&Bound<PyAny>>,
    net: Option<PathBuf>,
    route_files: Vec<PathBuf>,
    options: Option<&Bound<PyDict>>,
) -> PyResult<Table> {
    let options = options_from(options)?;
    let mut tracks = TrackOptions { columns: text_of(columns)?, frame_rate, ..TrackOptions::default() };
    tracks.format =
        format.map(|name| RecordingFormat::from_str(name, true)).transpose().map_err(PyValueError::new_err)?;
    tracks.origin = origin.map(|name| TrackOrigin::from_str(name, true)).transpose().map_err(PyValueError::new_err)?;
    tracks.smooth = smooth.map(noise_of).transpose()?.flatten();
    let replay = |paths: &[PathBuf]| checked(py, paths, &tracks, net.as_deref(), &route_files, &options);
    if let Ok(path) = data.extract::<PathBuf>() {
        return replay(&[path])?.map_err(exception);
    }
    // A data frame can be iterated over too.
    if data.is_instance_of::<PyList>() || data.is_instance_of::<PyTuple>() {
        return replay(&data.extract::<Vec<PathBuf>>()?)?.map_err(exception);
    }
    let file = written(py, data, &tracks)?;
    replay(&[file.path().to_owned()])?.map_err(|error| match error {
        // The first row of the file is that of the names.
        Error::Line { line, message, .. } if line > 1 => PyValueError::new_err(format!("row {}: {message}", line - 1)),
        Error::Line { message, .. } | Error::Content { message, .. } => PyValueError::new_err(message),
        error => exception(error),
    })
}

/// The noise that is to be smoothed; none for False.
fn noise_of(smooth: &Bound<PyAny>) -> PyResult<Option<f64>> {
    if let Ok(wanted) = smooth.extract::<bool>() {
        return Ok(wanted.then_some(USUAL_NOISE));
    }
    let noise = smooth.extract::<f64>()?;
    NOISE.check("smooth", noise).map(Some).map_err(PyValueError::new_err)
}

/// The text of `--columns`.
fn text_of(columns: Option<&Bound<PyAny>>) -> PyResult<String> {
    let Some(columns) = columns else { return Ok(String::new()) };
    let Ok(pairs) = columns.cast::<PyDict>() else { return columns.extract() };
    let pairs = pairs.iter().map(|(name, column)| Ok(format!("{name}={column}"))).collect::<PyResult<Vec<_>>>();
    Ok(pairs?.join(","))
}

/// Checks a recording, says what was assumed, and gives its conflicts.
fn checked(
    py: Python,
    paths: &[PathBuf],
    tracks: &TrackOptions,
    net: Option<&Path>,
    route_files: &[PathBuf],
    options: &RunOptions,
) -> PyResult<closecall_run::Result<Table>> {
    let mut interrupt = None;
    let mut last = Instant::now();
    let mut stopped = || {
        // Looking for it takes Python's lock.
        if last.elapsed() < ASKED {
            return false;
        }
        last = Instant::now();
        let signals = Python::attach(|py| py.check_signals());
        signals.map_err(|error| interrupt = Some(error)).is_err()
    };
    let run = py.detach(|| check(paths, tracks, net, route_files, options, &mut stopped));
    match (interrupt, run) {
        (Some(interrupt), _) => Err(interrupt),
        (None, Err(error)) => Ok(Err(error)),
        (None, Ok(Checked { run, doubtful, remarks })) => {
            doubtful.iter().try_for_each(|remark| say::line(py, remark))?;
            Ok(Ok(table(&run)?.with_remarks(remarks)))
        }
    }
}

/// A recording that was checked.
struct Checked {
    run: Run,
    /// What had to be assumed because of what is in the recording.
    doubtful: Vec<String>,
    /// All that the command says.
    remarks: Vec<String>,
}

/// Checks a recording.
fn check(
    paths: &[PathBuf],
    tracks: &TrackOptions,
    net: Option<&Path>,
    route_files: &[PathBuf],
    options: &RunOptions,
    stopped: &mut dyn FnMut() -> bool,
) -> closecall_run::Result<Checked> {
    let net = net.map(closecall_run::net::read).transpose()?.map(std::sync::Arc::new);
    let opened = open_tracks(paths, tracks, net.as_deref(), stopped)?;
    let demand = route_files.iter().cloned().chain(opened.types()).collect::<Vec<_>>();
    let mut replay = Replay::open_unless(opened.recording(), &demand, net.as_deref(), &options.model, stopped)?;
    let mut run = Run::new(options, net)?;
    run.set_fixed_routes(true);
    let opening = run.opening_remarks(Some(replay.step_length()));
    run.set_tracked(opened.is_tracked());
    run.set_averaged_over(if opened.has_speeds_of_moments() { 0.0 } else { replay.averaged_over() });
    while replay.next(&mut run)?.is_some() {
        if stopped() {
            return Err(Error::Stopped);
        }
    }
    run.finish()?;
    let text = |remark: Remark| remark.text;
    let at_end = replay.remarks().into_iter().map(text).collect::<Vec<_>>();
    let remarks = opened.remarks().into_iter().chain(opening).map(text).chain(at_end.iter().cloned()).collect();
    let doubtful = [opened.doubtful(), &at_end].concat();
    Ok(Checked { run, doubtful, remarks })
}

fn table(run: &Run) -> PyResult<Table> {
    let columns = COLUMNS.iter().filter(|column| column.is_in(run.measures())).collect::<Vec<_>>();
    Table::of(&columns, logged(run).into_iter().map(Ok), |error: PyErr| error)
}
