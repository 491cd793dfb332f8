//! The scenario of the roll-outs: the run's own, gathered in a folder, with a configuration that begins before each conflict.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::batch::extract::SaveConfiguration;
use crate::batch::extract::configuration::{self, Configuration};
use crate::batch::extract::source::{Period, check_can_be_run};
use crate::batch::extract::toml_options;
use crate::logged::{LoggedConflict, LoggedRun};
use crate::{Error, Result};
use closecall::options::DriverOptions;
use closecall::util::units::Second;
use closecall_run::util::{input_file, output_file};

/// A state is saved this long before its conflict, in s: the two have then been there for some steps, and SUMO's state has had
/// little time to drift.
const BEFORE: Second = 5.0;

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

/// A conflict and the part of the run around it.
#[derive(Clone, Debug)]
pub(super) struct Subject {
    pub conflict: LoggedConflict,
    pub period: Period,
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
        horizon: Second,
        folder: PathBuf,
        tools: &mut Tools,
    ) -> Result<Self> {
        let run = LoggedRun::read(log)?;
        let seed = check_can_be_run(&run).map_err(|why| Error::content(log, why))?;
        // SUMO saves a state after a step.
        let warm_up = run.options.get("warmup").and_then(Value::as_f64).unwrap_or_default();
        let first = run.summary.begin - warm_up + run.step_length.unwrap_or(1.0);
        let subjects = conflicts.into_iter().map(|conflict| {
            let mut period = Period::around(&run, [conflict.begin, conflict.begin], [BEFORE, horizon]);
            period.from = period.from.max(first);
            Subject { conflict, period }
        });
        let scenario = Self { folder, seed, subjects: subjects.collect() };
        let options = options(&run, tools);
        let periods =
            scenario.subjects.iter().map(|subject| (subject.conflict.id, subject.period.from, subject.period.end));
        let inputs = run.inputs.iter().map(|input| &input.sha256).collect::<Vec<_>>();
        let made_of = json!({
            "words": run.sumo_words, "inputs": inputs, "options": options, "periods": periods.collect::<Vec<_>>()
        });
        let made_of = made_of.to_string();
        let known = input_file::text(&scenario.folder.join(MADE_OF));
        if known.is_ok_and(|known| known == made_of) {
            return Ok(scenario);
        }
        scenario.fill(&run, &options, tools)?;
        output_file::write(&scenario.folder.join(MADE_OF), made_of.as_bytes())?;
        Ok(scenario)
    }

    /// Fills the folder anew.
    fn fill(&self, run: &LoggedRun, options: &Value, tools: &mut Tools) -> Result<()> {
        let place = &self.folder;
        let fault = |source| Error::file(place, source);
        if place.exists() {
            fs::remove_dir_all(place).map_err(fault)?;
        }
        fs::create_dir_all(place).map_err(fault)?;
        let saved = place.join("saved.sumocfg");
        (tools.save_configuration)(&run.sumo_words, &saved)?;
        // Two that touch go on: what counts as a contact is for closecall to say, and SUMO removes none.
        let whole = Configuration::gather(&saved, place)?;
        fs::remove_file(&saved).map_err(|source| Error::file(&saved, source))?;
        let filter = run.options.get("filter").and_then(Value::as_str).map(Path::new);
        let filter = filter.map(|filter| configuration::copy(filter, place)).transpose()?;
        let filter = filter.map_or_else(String::new, |name| format!("filter = {}\n", Value::from(name)));
        output_file::write(&place.join(SETTINGS), toml_options::toml(options, &filter).as_bytes())?;
        let last = self.subjects.iter().map(|subject| subject.period.end).fold(0.0, f64::max);
        whole.clone().with("end", last).write(&place.join(WHOLE))?;
        let short = whole.without("route-files").without("load-state").without("collision.");
        let short = short.with("collision.action", "none");
        for Subject { conflict, period } in &self.subjects {
            for state in [self.state(conflict.id), self.state_without_draws(conflict.id)] {
                let name = state.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let of_state =
                    short.clone().with("load-state", name).with("begin", period.from).with("end", period.end);
                of_state.write(&state.with_extension("sumocfg"))?;
            }
        }
        Ok(())
    }

    /// The configuration of the whole run.
    pub fn whole(&self) -> PathBuf {
        self.folder.join(WHOLE)
    }

    /// The options of closecall in all runs.
    pub fn settings(&self) -> PathBuf {
        self.folder.join(SETTINGS)
    }

    /// SUMO's state before a conflict; the configuration that begins there has the same name.
    pub fn state(&self, conflict: u64) -> PathBuf {
        self.folder.join(format!("conflict-{conflict}.xml"))
    }

    /// The same without random numbers: SUMO then draws them by its seed.
    pub fn state_without_draws(&self, conflict: u64) -> PathBuf {
        self.folder.join(format!("conflict-{conflict}-drawn.xml"))
    }

    /// Writes the states without random numbers.
    pub fn remove_draws(&self) -> Result<()> {
        for Subject { conflict, .. } in &self.subjects {
            let state = self.state(conflict.id);
            let text = input_file::text(&state)?;
            let without = match (text.find("<rngState"), text.find("</rngState>")) {
                (Some(begin), Some(end)) => [&text[..begin], &text[end + "</rngState>".len()..]].concat(),
                _ => text,
            };
            output_file::write(&self.state_without_draws(conflict.id), without.as_bytes())?;
        }
        Ok(())
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
