//! The scenario of the roll-outs: the run's own, gathered in a folder, with a configuration for each conflict that begins before
//! it, or with the run.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::asked::Asked;
use crate::batch::extract::SaveConfiguration;
use crate::batch::extract::configuration::{self, Configuration};
use crate::batch::extract::source::{Period, check_can_be_run};
use crate::batch::extract::toml_options;
use crate::logged::{LoggedConflict, LoggedRun};
use crate::{Error, Result};
use closecall::options::DriverOptions;
use closecall::util::units::Second;
use closecall_run::util::{input_file, output_file};

/// States are saved so long before a conflict, in s. Where a road user waits at a junction, the first steps from a state may
/// differ, so that the best of several is taken.
const BEFORE: [Second; 3] = [5.0, 10.0, 15.0];

/// The scenario as a whole, for the run that saves the states.
const WHOLE: &str = "whole.sumocfg";
/// The options of closecall.
const SETTINGS: &str = "closecall.toml";
/// What the folder was made of.
const MADE_OF: &str = "made-of.json";

/// What the roll-outs are prepared with.
pub struct Tools<'a> {
    /// See [`SaveConfiguration`].
    pub save_configuration: &'a mut SaveConfiguration<'a>,
    /// The preset of the drivers, if another than the run's is wanted.
    pub preset: Option<&'static str>,
    /// Values of the drivers, if others than the run's are wanted.
    pub driver: Option<DriverOptions>,
}

/// A conflict and the parts of the run around it, each with a state of its own; a single one where no state is needed.
#[derive(Clone, Debug)]
pub(super) struct Subject {
    pub conflict: LoggedConflict,
    pub periods: Vec<Period>,
}

/// The folder of the scenario.
#[derive(Debug)]
pub(super) struct Scenario {
    folder: PathBuf,
    /// The run's seed.
    pub seed: u32,
    pub subjects: Vec<Subject>,
}

impl Scenario {
    /// Prepares the scenario of the run in `log` in a folder, unless it is there already.
    pub fn prepare(
        log: &Path,
        conflicts: Vec<LoggedConflict>,
        asked: &Asked,
        folder: PathBuf,
        tools: &mut Tools,
    ) -> Result<Self> {
        let run = LoggedRun::read(log)?;
        let seed = check_can_be_run(&run).map_err(|why| Error::content(log, why))?;
        // SUMO saves a state after a step.
        let warm_up = run.options.get("warmup").and_then(Value::as_f64).unwrap_or_default();
        let first = run.summary.begin - warm_up + run.step_length.unwrap_or(1.0);
        let subject = |conflict: LoggedConflict| {
            let around = |before| Period::around(&run, [conflict.begin, conflict.begin], [before, asked.horizon]);
            let before = if asked.is_exact { &BEFORE[..1] } else { &BEFORE };
            let periods = before.iter().copied().map(around);
            let mut periods =
                periods.map(|period| Period { from: period.from.max(first), ..period }).collect::<Vec<_>>();
            periods.dedup_by(|a, b| a.from.total_cmp(&b.from).is_eq());
            Subject { conflict, periods }
        };
        let scenario = Self { folder, seed, subjects: conflicts.into_iter().map(subject).collect() };
        let options = options(&run, tools);
        let inputs = run.inputs.iter().map(|input| &input.sha256).collect::<Vec<_>>();
        let periods = scenario.starts().map(|(subject, _, period)| (subject.conflict.id, period.from, period.end));
        let periods = periods.collect::<Vec<_>>();
        let made_of = json!({"words": run.sumo_words, "inputs": inputs, "options": options, "periods": periods,
            "exact": asked.is_exact});
        let made_of = made_of.to_string();
        let known = input_file::text(&scenario.folder.join(MADE_OF));
        if known.is_ok_and(|known| known == made_of) {
            return Ok(scenario);
        }
        scenario.fill(&run, &options, asked.is_exact, tools)?;
        output_file::write(&scenario.folder.join(MADE_OF), made_of.as_bytes())?;
        Ok(scenario)
    }

    /// Fills the folder anew.
    fn fill(&self, run: &LoggedRun, options: &Value, is_exact: bool, tools: &mut Tools) -> Result<()> {
        let place = &self.folder;
        let fault = |source| Error::file(place, source);
        if place.exists() {
            fs::remove_dir_all(place).map_err(fault)?;
        }
        fs::create_dir_all(place).map_err(fault)?;
        let saved = place.join("saved.sumocfg");
        (tools.save_configuration)(&run.sumo_words, &saved)?;
        let whole = Configuration::gather(&saved, place)?;
        fs::remove_file(&saved).map_err(|source| Error::file(&saved, source))?;
        let filter = run.options.get("filter").and_then(Value::as_str).map(Path::new);
        let filter = filter.map(|filter| configuration::copy(filter, place)).transpose()?;
        let filter = filter.map_or_else(String::new, |name| format!("filter = {}\n", Value::from(name)));
        output_file::write(&place.join(SETTINGS), toml_options::toml(options, &filter).as_bytes())?;
        let last = self.starts().map(|(_, _, period)| period.end).fold(0.0, f64::max);
        whole.clone().with("end", last).write(&place.join(WHOLE))?;
        // Two that touch go on: what counts as a contact is for closecall to say, and SUMO removes none.
        let exact = whole.without("collision.").with("collision.action", "none");
        let short = exact.clone().without("route-files").without("load-state");
        for (subject, start, period) in self.starts() {
            let name = self.state(period).file_name().unwrap_or_default().to_string_lossy().into_owned();
            let from_there = || short.clone().with("load-state", name).with("begin", period.from);
            let own = if is_exact { exact.clone() } else { from_there() };
            own.with("end", period.end).write(&self.configuration(subject, start))?;
        }
        Ok(())
    }

    /// All starts: the subject, the start's number there, its period.
    pub fn starts(&self) -> impl Iterator<Item = (&Subject, usize, &Period)> {
        self.subjects
            .iter()
            .flat_map(|subject| subject.periods.iter().enumerate().map(move |(start, period)| (subject, start, period)))
    }

    /// The configuration of the whole run.
    pub fn whole(&self) -> PathBuf {
        self.folder.join(WHOLE)
    }

    /// The options of closecall in all runs.
    pub fn settings(&self) -> PathBuf {
        self.folder.join(SETTINGS)
    }

    /// The configuration of one of a subject's starts.
    pub fn configuration(&self, subject: &Subject, start: usize) -> PathBuf {
        self.folder.join(format!("conflict-{}-{start}.sumocfg", subject.conflict.id))
    }

    /// SUMO's state at the begin of a period.
    pub fn state(&self, period: &Period) -> PathBuf {
        self.folder.join(format!("state-{}.xml", period.from))
    }
}

/// The run's options of closecall, with the drivers that are asked for.
fn options(run: &LoggedRun, tools: &Tools) -> Value {
    let mut options = run.options.clone();
    if let Some(options) = options.as_object_mut() {
        if let Some(preset) = tools.preset {
            options.insert("driver".to_owned(), preset.into());
        }
        if tools.preset.is_some() || tools.driver.is_some() {
            options.insert("driver_options".to_owned(), json!(tools.driver.clone().unwrap_or_default()));
        }
    }
    options
}
