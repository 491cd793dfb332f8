//! What a run was made from: SUMO's version and seed, the files that it reads.

use std::path::{Path, PathBuf};

use closecall::inputs::Input;
use closecall::options::Options;
use closecall::record::{RunRecord, Versions};
use closecall::run::Run;
use closecall::summary::Summary;
use pyo3::prelude::*;

use crate::error::exception;
use crate::pull::option;

/// The files that a simulation reads.
pub struct Files {
    pub net: Option<PathBuf>,
    pub all: Vec<PathBuf>,
    pub checked: Vec<PathBuf>,
}

/// The files that SUMO names itself, and its configuration.
pub fn files(sumo: &Bound<PyAny>, scenario: &Path) -> PyResult<Files> {
    let named = |name: &str| -> PyResult<Vec<PathBuf>> {
        let names = option(sumo, name)?;
        let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
        Ok(names.map(PathBuf::from).collect())
    };
    let net = named("net-file")?.into_iter().next();
    let (routes, additional) = (named("route-files")?, named("additional-files")?);
    let checked = routes.into_iter().chain(additional).filter(|path| path.is_file()).collect::<Vec<_>>();
    let all = [Some(scenario.to_owned()), net.clone()].into_iter().flatten().chain(checked.clone()).collect();
    Ok(Files { net, all, checked })
}

/// The record of a run that begins, its inputs and SUMO's words left empty; without `sumo`, nothing is simulated.
pub fn record(sumo: Option<&Bound<PyAny>>, scenario: PathBuf, run: &Run, options: &Options) -> PyResult<RunRecord> {
    let version = |sumo: &Bound<PyAny>| sumo.call_method0("getVersion")?.get_item(1)?.extract::<String>();
    let step_length = |sumo: &Bound<PyAny>| sumo.getattr("simulation")?.call_method0("getDeltaT")?.extract::<f64>();
    Ok(RunRecord {
        versions: Versions::with_sumo(sumo.map(version).transpose()?),
        scenario,
        seed: sumo.and_then(|sumo| option(sumo, "seed").ok()),
        step_length: sumo.map(step_length).transpose()?,
        sublane: run.sublane(),
        options: options.clone(),
        sumo_words: Vec::new(),
        inputs: Vec::new(),
        complete: false,
        error: None,
        summary: Summary::default(),
    })
}

/// The same of a simulation that a script has started, or of its own frames on this net.
pub fn record_of_script(
    sumo: Option<&Bound<PyAny>>,
    net: Option<PathBuf>,
    run: &Run,
    options: &Options,
) -> PyResult<RunRecord> {
    let configuration =
        sumo.map(|sumo| option(sumo, "configuration-file")).transpose()?.filter(|name| !name.is_empty());
    let named = sumo.map(|sumo| option(sumo, "net-file")).transpose()?.filter(|name| !name.is_empty());
    let scenario = configuration.or(named).map(PathBuf::from).or_else(|| net.clone()).unwrap_or_default();
    let mut paths = match sumo {
        Some(sumo) => files(sumo, &scenario)?.all,
        None => net.into_iter().collect(),
    };
    paths.dedup();
    // traci's simulation may run elsewhere.
    let inputs = paths.iter().filter(|path| path.is_file()).map(|path| Input::of(path));
    let inputs = inputs.collect::<closecall::Result<_>>().map_err(exception)?;
    Ok(RunRecord { inputs, ..record(sumo, scenario, run, options)? })
}
