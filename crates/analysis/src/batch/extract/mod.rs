//! `closecall extract`: one conflict of a run as a standalone scenario: in SUMO (here), or as the log's clip in ASAM's formats
//! (`clip.rs`).
//!
//! The shortest scenario starts from a state that SUMO saves some seconds before. With all digits and random states, SUMO
//! mostly continues exactly, unless it reads route files, for which it draws random numbers again. A state does not hold
//! everything, so the conflict is checked in a run from it; if it differs, the scenario begins where the run did. The net stays
//! whole: SUMO draws drivers' random numbers by the places of lanes in the net, so a part of it would have other drivers.

mod clip;
pub(in crate::batch) mod configuration;
mod extracted;
mod readme;
pub(in crate::batch) mod source;
pub(in crate::batch) mod toml_options;

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::batch::regress::outcome::Outcome;
use crate::batch::regress::running::{Job, Runner};
use crate::batch::regress::scenario::{SETTINGS, Scenario};
use crate::logged::{ConflictReader, ConflictSelector, LoggedConflict, LoggedRun};
use crate::{Error, Result};
pub use clip::{ConvertNet, SCENARIO, extract_openscenario, extract_osi};
use closecall::util::units::{Metre, SAME_MOMENT, Second};
use closecall_run::output::input_hash::Input;
use closecall_run::util::decimal::Written;
use closecall_run::util::output_file;
use configuration::{CONFIGURATION, Configuration, STATE};
pub use extracted::Extracted;
use extracted::fill;
use readme::Readme;
use source::{Period, check_can_be_run};

/// Margins that differ by more than this are those of different conflicts. A log has six digits after the point.
const SAME_MARGIN: Metre = 1e-6;

/// SUMO's options for a state from which a run goes on exactly: all digits of numbers, persons, and random numbers.
pub(in crate::batch) const WHOLE_STATE: [&str; 5] =
    ["--save-state.precision", "17", "--save-state.rng", "--save-state.transportables", "--save-state.constraints"];

/// What a conflict is cut out with.
pub struct Tools<'a> {
    /// See [`SaveConfiguration`].
    pub save_configuration: &'a mut SaveConfiguration<'a>,
    /// The command line that starts closecall, without arguments, as for [`Runner`].
    pub closecall: Vec<OsString>,
    /// The long options that a `closecall.toml` may contain as keys.
    pub known: &'a [String],
    /// Whether the user wants to stop; called repeatedly.
    pub interrupted: &'a mut dyn FnMut() -> bool,
    /// Told repeatedly how many runs of how many have ended.
    pub progress: &'a mut dyn FnMut(u64, u64),
}

/// Saves SUMO's options, as these words and the configuration that they name set them, in a configuration of their own.
pub type SaveConfiguration<'a> = dyn FnMut(&[String], &Path) -> closecall_run::Result<()> + 'a;

/// Cuts a conflict of the log in a folder out, into the folder `out`, whole or not at all.
///
/// # Errors
/// [`Error::NoConflict`]; [`Error::content`] where SUMO cannot run it again, or it is another
/// one then, or `out` is not empty; [`closecall_run::Error::Stopped`] if the user interrupted it; those of reading and writing.
pub fn extract(folder: &Path, which: ConflictSelector, out: &Path, tools: &mut Tools) -> Result<Extracted> {
    let conflict = which.find(folder)?;
    let run = LoggedRun::read(folder)?;
    let seed = check_can_be_run(&run).map_err(|why| Error::content(folder, why))?;
    let remark =
        fill(out, |place, logs| Cut { conflict: &conflict, run: &run, seed, place, logs }.make(folder, tools))?;
    Ok(Extracted { conflict, remark })
}

/// A conflict that is being cut out.
struct Cut<'a> {
    conflict: &'a LoggedConflict,
    run: &'a LoggedRun,
    seed: u32,
    /// The folder of the scenario.
    place: &'a Path,
    /// A folder for logs.
    logs: &'a Path,
}

impl Cut<'_> {
    /// Fills the folder; returns what the user should know.
    fn make(&self, log: &Path, tools: &mut Tools) -> Result<Option<String>> {
        let Self { run, place, .. } = self;
        let saved = self.logs.join("saved.sumocfg");
        (tools.save_configuration)(&run.sumo_words, &saved)?;
        let period = Period::of(run, self.conflict.begin, self.conflict.end);
        let whole = Configuration::gather(&saved, place)?.with("end", period.end);
        let filter = self.copy_filter()?;
        let mut kept = whole.files();
        kept.extend(filter.clone());
        let all = 1 + u64::from(period.is_within);

        self.write_scenario(&whole, period.warm_up_of_run, filter.as_deref())?;
        let from = period.from.to_string();
        let save = ["--save-state.times", &*from, "--save-state.files", STATE].into_iter().chain(WHOLE_STATE);
        let save = save.filter(|_| period.is_within).map(str::to_owned).collect();
        self.look(save, tools, [0, all])?.map_err(|why| {
            let (id, changed) = (self.conflict.id, self.changed());
            Error::content(log, format!("conflict {id} does not come back when SUMO runs again: {why}{changed}"))
        })?;
        let mut remark = None;
        let mut approved = self.logs.join("0");
        let sumo = run.versions.sumo.as_deref().unwrap_or_default();
        let mut args = Readme { conflict: self.conflict, scenario: run.name(), sumo, until: period.end, from: None };
        if period.is_within {
            let short = whole.clone().without("route-files").without("load-state");
            let short = short.with("load-state", STATE).with("begin", period.from);
            self.write_scenario(&short, period.warm_up, filter.as_deref())?;
            match self.look(Vec::new(), tools, [1, all])? {
                Ok(()) => {
                    args.from = Some(period.from);
                    approved = self.logs.join("1");
                    kept = short.files();
                    kept.extend(filter);
                    kept.push(STATE.to_owned());
                }
                Err(why) => {
                    self.write_scenario(&whole, period.warm_up_of_run, filter.as_deref())?;
                    remark = Some(format!(
                        "the scenario begins where the run did, since SUMO's saved state is not exact here: {why}"
                    ));
                }
            }
        }
        for (name, text) in [("README.md", args.readme()), ("test_conflict.py", args.test(CONFIGURATION))] {
            output_file::write(&place.join(name), text.as_bytes())?;
            kept.push(name.to_owned());
        }
        kept.extend([CONFIGURATION, SETTINGS].map(str::to_owned));
        self.remove_others(&kept)?;
        // What the run has just found is the baseline, so that `closecall regress` works in the folder at once.
        Outcome::collect(place, &[(self.seed, approved)])?.write(&place.join("expected"))?;
        Ok(remark)
    }

    /// Copies the selection of edges that the run had, if it had one.
    fn copy_filter(&self) -> Result<Option<String>> {
        let filter = self.run.options.get("filter").and_then(Value::as_str).map(Path::new);
        filter.map(|filter| configuration::copy(filter, self.place)).transpose()
    }

    fn write_scenario(&self, configuration: &Configuration, warm_up: Second, filter: Option<&str>) -> Result<()> {
        configuration.write(&self.place.join(CONFIGURATION))?;
        let mut first = String::new();
        if warm_up > 0.0 {
            first += &format!("warmup = {warm_up:?}\n");
        }
        if let Some(filter) = filter {
            first += &format!("filter = {}\n", Value::from(filter));
        }
        let text = toml_options::toml(&self.run.options, &first);
        let text = format!("{text}\n[regress]\nsumocfg = \"{CONFIGURATION}\"\nseeds = [{}]\n", self.seed);
        Ok(output_file::write(&self.place.join(SETTINGS), text.trim_start().as_bytes())?)
    }

    /// Runs the scenario and looks for the conflict; what is wrong is what the scenario lacks. `done` runs of `all` have ended.
    fn look(&self, sumo_options: Vec<String>, tools: &mut Tools, [done, all]: [u64; 2]) -> Result<Found> {
        let mut scenario = Scenario::at(&self.place.join(CONFIGURATION), tools.known)?;
        scenario.settings.sumo_options = sumo_options;
        let log = self.logs.join(done.to_string());
        let mut runner = Runner {
            closecall: tools.closecall.clone(),
            workers: 1,
            out: None,
            interrupted: tools.interrupted,
            progress: &mut |more, _| (tools.progress)(done + more, all),
        };
        let ends = runner.run(&[Job { scenario: &scenario, number: 0, seed: self.seed, log: log.clone() }])?;
        match ends.into_iter().next() {
            Some(Err(why)) => Ok(Err(why)),
            _ => self.found_in(&log),
        }
    }

    /// Whether the conflict is in a log, and else which is there instead.
    fn found_in(&self, log: &Path) -> Result<Found> {
        let wanted = self.conflict;
        let mut nearest = None::<LoggedConflict>;
        for conflict in ConflictReader::open(log)? {
            let conflict = conflict?;
            if (&conflict.ego, &conflict.foe) != (&wanted.ego, &wanted.foe) {
                continue;
            }
            let off = |other: &LoggedConflict| {
                ((other.time - wanted.time).abs(), (other.margin - wanted.margin).abs(), other.kind != wanted.kind)
            };
            let (time, margin, is_other) = off(&conflict);
            if time < SAME_MOMENT && margin <= SAME_MARGIN && !is_other {
                return Ok(Ok(()));
            }
            if nearest.as_ref().is_none_or(|nearest| off(&conflict) < off(nearest)) {
                nearest = Some(conflict);
            }
        }
        let LoggedConflict { kind, time, margin, ego, foe, .. } = wanted;
        Ok(Err(nearest.map_or_else(
            || format!("\"{ego}\" and \"{foe}\" are in no conflict"),
            |other| {
                let [was, is] = [(kind, time, margin), (&other.kind, &other.time, &other.margin)]
                    .map(|(kind, time, margin)| (kind.name(), Written(*time), Written(*margin)))
                    .map(|(kind, time, margin)| format!("{kind} at {time} s with a margin of {margin} m"));
                format!("it is {is}, not {was}")
            },
        )))
    }

    /// What is no longer as it was in the run, to follow a reason.
    fn changed(&self) -> String {
        let is_other = |input: &&Input| Input::of(&input.path).is_ok_and(|now| now.sha256 != input.sha256);
        let other = self.run.inputs.iter().find(is_other);
        other.map_or_else(String::new, |input| format!("; {} was changed since", input.path.display()))
    }

    /// Removes what the runs wrote into the folder, such as the outputs of detectors.
    fn remove_others(&self, kept: &[String]) -> Result<()> {
        let fault = |source| Error::file(self.place, source);
        for entry in fs::read_dir(self.place).map_err(fault)? {
            let path = entry.map_err(fault)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if !kept.contains(&name) && path.is_file() {
                fs::remove_file(&path).map_err(|source| Error::file(&path, source))?;
            }
        }
        Ok(())
    }
}

/// Whether the conflict came back; if not, what happened instead.
type Found = std::result::Result<(), String>;
