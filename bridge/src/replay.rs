//! `closecall.replay`: a recording, or a data frame of trajectories, checked in memory.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader};
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatchReader};
use arrow_schema::DataType;
use clap::ValueEnum;
use closecall::internals::input::{NOISE, RecordingFormat, TrackOptions, TrackOrigin, USUAL_NOISE, open_tracks};
use closecall::internals::output::COLUMNS;
use closecall::internals::util::Stop;
use closecall::{Error, Net, Options, Replay, Run};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyCapsuleMethods, PyDict};

use crate::checker::options_from;
use crate::conflict::logged;
use crate::error::exception;
use crate::interruptible::interruptibly;
use crate::table::Table;

/// The method of Arrow's C stream.
const STREAM: &str = "__arrow_c_stream__";

/// The conflicts of a recording, or of a data frame of trajectories, as a table.
///
/// Args:
///     data: the path of a recording, or anything with Arrow's C stream: a frame of Polars or pandas, a table of PyArrow.
///     columns: which columns are what, in which unit: {"id": "trackId", "time": "t[ms]", "x": "xCenter", ...}, or the text of the
///         command line's --columns (docs/formats.md).
///     format: the format of a recording, as on the command line; by default as its first bytes and columns tell.
///     frame_rate: frames per second, where the time is a number of frames.
///     origin: what x and y are: "centre" or "front".
///     smooth: the standard deviation in m of the noise in places, which are smoothed then; True is 0.1. By default nothing is
///         smoothed.
///     net: the net file; without one, paths follow no lanes.
///     route_files: route and additional files that define the types and routes of SUMO's recordings.
///     **options: the long options of the command line, with underscores: `path="arc"`, `log="ttc < 3"`.
///
/// Raises:
///     ValueError: the data cannot be used; the message names row and column.
///     OSError: a file cannot be read.
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
    let check = move |path: PathBuf| {
        interruptibly(py, move |stop| check(&path, &tracks, net.as_deref(), &route_files, &options, stop))
    };
    if let Ok(path) = data.extract::<PathBuf>() {
        return check(path)?.map_err(exception).and_then(|run| table(&run));
    }
    let file = written(py, data)?;
    let run = check(file.path().to_owned())?.map_err(|error| match error {
        // The first row of the file is that of the names.
        Error::Line { line, message, .. } if line > 1 => PyValueError::new_err(format!("row {}: {message}", line - 1)),
        Error::Line { message, .. } | Error::Content { message, .. } => PyValueError::new_err(message),
        error => exception(error),
    })?;
    table(&run)
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

/// Checks a recording.
fn check(
    path: &Path,
    tracks: &TrackOptions,
    net: Option<&Path>,
    route_files: &[PathBuf],
    options: &Options,
    stop: &Stop,
) -> closecall::Result<Run> {
    let net = net.map(Net::read).transpose()?.map(std::sync::Arc::new);
    let opened = open_tracks(path, tracks, net.as_deref())?;
    let demand = route_files.iter().cloned().chain(opened.types()).collect::<Vec<_>>();
    let mut replay = Replay::open(opened.recording(), &demand, net.as_deref(), options)?;
    let mut run = Run::new(options, net)?;
    run.set_fixed_routes(true);
    run.set_averaged_over(if opened.has_speeds_of_moments() { 0.0 } else { replay.averaged_over() });
    while replay.next(&mut run)?.is_some() {
        if stop.load(Ordering::Relaxed) {
            return Err(Error::Stopped);
        }
    }
    run.finish()?;
    Ok(run)
}

fn table(run: &Run) -> PyResult<Table> {
    let columns = COLUMNS.iter().filter(|column| column.is_in(run.measures())).collect::<Vec<_>>();
    Table::of(&columns, logged(run).into_iter().map(Ok), |error: PyErr| error)
}

/// A data frame as a CSV file, which is gone when it is dropped.
fn written(py: Python, data: &Bound<PyAny>) -> PyResult<tempfile::NamedTempFile> {
    let file = tempfile::Builder::new().prefix("closecall-").suffix(".csv").tempfile()?;
    // pandas has the method, but needs PyArrow for it.
    let stream = data.call_method0(STREAM);
    match (stream, data.hasattr("to_csv")?) {
        (Ok(capsule), _) => write(py, &capsule.cast_into::<PyCapsule>()?, &file)?,
        (Err(_), true) => {
            let keywords = PyDict::new(py);
            keywords.set_item("index", false)?;
            data.call_method("to_csv", (file.path(),), Some(&keywords))?;
        }
        (Err(error), false) if data.hasattr(STREAM)? => return Err(error),
        (Err(_), false) => {
            let what = data.get_type().name()?;
            return Err(PyTypeError::new_err(format!("{what} is neither a path nor a data frame with {STREAM}")));
        }
    }
    Ok(file)
}

#[expect(unsafe_code, reason = "Arrow's C interface is a pointer, which its name vouches for")]
fn write(py: Python, capsule: &Bound<PyCapsule>, file: &tempfile::NamedTempFile) -> PyResult<()> {
    let failed = |error: arrow_schema::ArrowError| PyValueError::new_err(error.to_string());
    let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?.cast::<FFI_ArrowArrayStream>();
    // SAFETY: a capsule of this name holds such a stream, and the reader takes it over, as Arrow's interface says.
    let reader = unsafe { RecordBatchStreamReader::from_raw(pointer.as_ptr()) }.map_err(failed)?;
    let mut out = std::io::BufWriter::new(file);
    let names = reader.schema().fields().iter().map(|field| quoted(field.name())).collect::<Vec<_>>();
    writeln!(out, "{}", names.join(","))?;
    for batch in reader {
        py.check_signals()?;
        let batch = batch.map_err(failed)?;
        for row in 0..batch.num_rows() {
            for (place, column) in batch.columns().iter().enumerate() {
                let comma = if place > 0 { "," } else { "" };
                write!(out, "{comma}{}", cell(column, row))?;
            }
            writeln!(out)?;
        }
    }
    out.flush()?;
    Ok(())
}

/// The text of a value; empty where it is missing, or neither text nor number.
fn cell(column: &ArrayRef, row: usize) -> String {
    if column.is_null(row) {
        return String::new();
    }
    match column.data_type() {
        DataType::Float64 => column.as_primitive::<Float64Type>().value(row).to_string(),
        DataType::Float32 => column.as_primitive::<Float32Type>().value(row).to_string(),
        DataType::Int64 => column.as_primitive::<Int64Type>().value(row).to_string(),
        DataType::Int32 => column.as_primitive::<Int32Type>().value(row).to_string(),
        DataType::Int16 => column.as_primitive::<Int16Type>().value(row).to_string(),
        DataType::Int8 => column.as_primitive::<Int8Type>().value(row).to_string(),
        DataType::UInt64 => column.as_primitive::<UInt64Type>().value(row).to_string(),
        DataType::UInt32 => column.as_primitive::<UInt32Type>().value(row).to_string(),
        DataType::UInt16 => column.as_primitive::<UInt16Type>().value(row).to_string(),
        DataType::UInt8 => column.as_primitive::<UInt8Type>().value(row).to_string(),
        DataType::Utf8 => quoted(column.as_string::<i32>().value(row)),
        DataType::LargeUtf8 => quoted(column.as_string::<i64>().value(row)),
        DataType::Utf8View => quoted(column.as_string_view().value(row)),
        DataType::Dictionary(..) => {
            let values = column.as_any_dictionary();
            let key = values.normalized_keys().get(row).copied().unwrap_or_default();
            cell(values.values(), key)
        }
        _ => String::new(),
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', ';', '\t', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
