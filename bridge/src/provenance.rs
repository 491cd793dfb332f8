//! What a run was made from: SUMO's version and seed, and the files that it reads.

use std::path::{Path, PathBuf};

use closecall_run::RunOptions;
use closecall_run::output::input_hash::Input;
use closecall_run::output::record::Versions;
use closecall_run::{Run, RunRecord};
use pyo3::prelude::*;

use crate::error::exception;
use crate::sumo::option;

/// The input files that SUMO reports.
pub struct SumoFiles {
    pub net: Option<PathBuf>,
    /// Route and additional files.
    pub others: Vec<PathBuf>,
}

impl SumoFiles {
    /// The configuration and all of them.
    pub fn with(&self, scenario: &Path) -> Vec<PathBuf> {
        let mut all =
            [Some(scenario), self.net.as_deref()].into_iter().flatten().map(Path::to_owned).collect::<Vec<_>>();
        all.extend_from_slice(&self.others);
        // In a script without a configuration, the net is the scenario.
        all.dedup();
        all
    }
}

/// The files that a simulation reads.
pub fn files(sumo: &Bound<PyAny>) -> PyResult<SumoFiles> {
    let named = |name: &str| -> PyResult<Vec<PathBuf>> {
        let names = option(sumo, name)?;
        let names = names.split(',').map(str::trim).filter(|name| !name.is_empty());
        Ok(names.map(PathBuf::from).collect())
    };
    let net = named("net-file")?.into_iter().next();
    let mut others = named("route-files")?;
    others.extend(named("additional-files")?);
    let others = others.into_iter().filter(|path| path.is_file()).collect();
    Ok(SumoFiles { net, others })
}

/// The record of a run that begins, without its inputs and SUMO's command line. Nothing is simulated without `sumo`.
pub fn record(sumo: Option<&Bound<PyAny>>, scenario: PathBuf, run: &Run, options: &RunOptions) -> PyResult<RunRecord> {
    let version = |sumo: &Bound<PyAny>| sumo.call_method0("getVersion")?.get_item(1)?.extract::<String>();
    let seed = |sumo: &Bound<PyAny>| match option(sumo, "random").ok()?.as_str() {
        "true" => None,
        _ => option(sumo, "seed").ok(),
    };
    let step_length = |sumo: &Bound<PyAny>| sumo.getattr("simulation")?.call_method0("getDeltaT")?.extract::<f64>();
    Ok(RunRecord {
        versions: Versions::with_sumo(sumo.map(version).transpose()?),
        seed: sumo.and_then(seed),
        step_length: sumo.map(step_length).transpose()?,
        sublane: run.sublane(),
        aligned: run.aligns(),
        ..RunRecord::new(scenario, options.clone())
    })
}

/// The record for a simulation that a script has started, or for frames of its own on this net.
pub fn record_of_script(
    sumo: Option<&Bound<PyAny>>,
    net: Option<PathBuf>,
    run: &Run,
    options: &RunOptions,
) -> PyResult<RunRecord> {
    let (scenario, paths) = match sumo {
        Some(sumo) => {
            let files = files(sumo)?;
            let configuration = Some(option(sumo, "configuration-file")?).filter(|name| !name.is_empty());
            let scenario = configuration.map(PathBuf::from).or_else(|| files.net.clone()).unwrap_or_default();
            let paths = files.with(&scenario);
            (scenario, paths)
        }
        None => (net.clone().unwrap_or_default(), net.into_iter().collect()),
    };
    // The simulation of traci may run on another machine.
    let inputs = paths.iter().filter(|path| path.is_file()).map(|path| Input::of(path));
    let inputs = inputs.collect::<closecall_run::Result<_>>().map_err(exception)?;
    Ok(RunRecord { inputs, ..record(sumo, scenario, run, options)? })
}
