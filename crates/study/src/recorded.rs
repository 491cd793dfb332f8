//! Recorded runs of scenarios, and the conflicts of their replay.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use rustc_hash::{FxHashMap, FxHashSet};

use super::driven::{IdPair, pair};
use super::measurement::{Measurement, Plan, Recorder};
use closecall::events::Conflict;
use closecall::options::Options;
use closecall::traffic::net::Net;
use closecall::util::units::{Metre, Second};
use closecall_run::input::replay::Replay;
use closecall_run::run::Run;
use closecall_run::{Error, Result};

/// Gaps that differ by less are equal: a recording has nine digits.
pub(super) const ROUNDING: Metre = 1e-6;

/// The attributes of fcd-output that closecall reads as numbers.
const NUMBERS: [&str; 9] = ["x", "y", "z", "angle", "speed", "pos", "acceleration", "posLat", "speedLat"];

/// The gap of every pair in conflict, by step.
pub(super) type GapsByStep = Vec<FxHashMap<IdPair, Metre>>;

/// A recorded run of a scenario.
pub(super) struct RecordedScenario {
    pub name: &'static str,
    pub recording: PathBuf,
    types: Vec<PathBuf>,
    net: Arc<Net>,
}

/// How long a replay took, how many rows it had, and its conflicts.
pub(super) struct Replayed {
    pub lasts: Second,
    pub rows: usize,
    pub conflicts: Vec<Conflict>,
}

impl RecordedScenario {
    /// Runs the scenario up to a time and records it.
    pub fn record(plan: &Plan, name: &'static str, scratch: &Path, end: Second, record: &mut Recorder) -> Result<Self> {
        let folder = plan.nets.join(name);
        let recording = scratch.join(format!("{name}.fcd.xml"));
        record(&folder.join(format!("{name}.sumocfg")), &recording, end)?;
        let file = |ending: &str| folder.join(format!("{name}.{ending}"));
        Ok(Self {
            name,
            types: vec![file("rou.xml")],
            net: Arc::new(closecall_run::net::read(&file("net.xml"))?),
            recording,
        })
    }

    /// Replays a recording of it; what is done after each step does not count.
    pub fn replay(&self, recording: &Path, options: &Options, after: &mut dyn FnMut(&Run)) -> Result<Replayed> {
        let started = Instant::now();
        let mut replay = Replay::open(recording, &self.types, Some(&self.net), options)?;
        let mut run = Run::new(&options.clone().into(), Some(self.net.clone()))?;
        run.set_fixed_routes(true);
        let mut rows = 0;
        let mut aside = 0.0;
        while replay.next(&mut run)?.is_some() {
            rows += run.frame.len();
            let paused = Instant::now();
            after(&run);
            aside += paused.elapsed().as_secs_f64();
        }
        let lasts = started.elapsed().as_secs_f64() - aside;
        Ok(Replayed { lasts, rows, conflicts: run.conflicts() })
    }
}

/// Records each scenario up to a time, and measures it; the folder is a temporary one.
pub(super) fn measure_each(
    plan: &Plan,
    nets: &[&'static str],
    end: Second,
    record: &mut Recorder,
    measure: impl Fn(RecordedScenario, &Path) -> Result<Vec<Measurement>>,
) -> Result<Vec<Measurement>> {
    let scratch = tempfile::tempdir().map_err(|source| Error::file(&std::env::temp_dir(), source))?;
    let mut rows = Vec::new();
    for net in nets {
        let scenario = RecordedScenario::record(plan, net, scratch.path(), end, record)?;
        rows.extend(measure(scenario, scratch.path())?);
    }
    Ok(rows)
}

/// The gap of every pair in conflict.
pub(super) fn conflicts(run: &Run) -> FxHashMap<IdPair, Metre> {
    run.in_conflict().map(|found| (pair(&run.roster, found.ego, found.foe), found.gap)).collect()
}

/// Where SUMO's collisions are that belong to a recording.
pub(super) fn collisions_file(recording: &Path) -> PathBuf {
    recording.with_extension("collisions.xml")
}

/// The share of these pairs that are not among the others.
pub(super) fn share_without(pairs: &FxHashSet<IdPair>, others: &FxHashSet<IdPair>) -> f64 {
    pairs.difference(others).count() as f64 / pairs.len().max(1) as f64
}

/// A recording with this number of decimals.
pub(super) fn with_decimals(text: &str, count: usize) -> String {
    with_numbers(text, &|value| format!("{value:.count$}"))
}

/// A recording in which every number is written in another way.
pub(super) fn with_numbers(text: &str, write: &dyn Fn(f64) -> String) -> String {
    let mut changed = String::with_capacity(text.len());
    let mut name = "";
    // Names and values take turns; the first piece is before any value.
    for (index, piece) in text.split('"').enumerate() {
        if index > 0 {
            changed.push('"');
        }
        let is_value = index % 2 == 1;
        match piece.parse() {
            Ok(value) if is_value && NUMBERS.contains(&name) => changed += &write(value),
            _ => changed += piece,
        }
        if !is_value {
            name = piece.trim_end_matches('=').rsplit(' ').next().unwrap_or_default();
        }
    }
    changed
}
