//! `closecall study SCENARIO`: the settings of a scenario around the user's own, as a sweep.

use std::ffi::OsString;
use std::path::Path;

use clap::Args;

use super::error::Result;
use super::files::{absolute, default_folder, print_if_elsewhere};
use super::print::{print, value};
use super::run::request;
use super::run_progress::{RunProgress, Telling};
use super::sumo::{RunRequest, Sumo, no_sumo};
use super::sweep::{ParseRun, Passed, UNFINISHED, check, check_runs, distribute};
use super::workers::Workers;
use closecall::options::share;
use closecall::util::threads::processors;
use closecall_analysis::batch::sweep::{Seeds, Sweep, Vary};
use closecall_analysis::study::scenario::{self, Plan, Study};
use closecall_run::input::sumo_files;
use closecall_run::output::folder::LogFolder;
use closecall_run::util::input_file;

/// What to vary in a scenario, and how to run it.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct ScenarioArgs {
    /// With a SCENARIO: values of an option of closecall run, or of SUMO (sumo:NAME=A,B), instead of the default axes. If
    /// repeated, each option is varied by itself; only the step length is combined with sumo:step-method.ballistic.
    #[arg(long, value_name = "NAME=A,B,…", action = clap::ArgAction::Append, requires = "scenario")]
    vary: Vec<Vary>,
    /// With a SCENARIO: random seeds for SUMO, such as 1-5 or 1,2,5-9 [default: 1-5, or 1-3 with --quick].
    #[arg(long, value_name = "SEEDS", requires = "scenario")]
    seeds: Option<Seeds>,
    /// With a SCENARIO: relative error in conflicts per vehicle-hour that the recommended step may have.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share, requires = "scenario")]
    accuracy: f64,
    /// With a SCENARIO: runs at the same time [default: one per processor].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), requires = "scenario")]
    workers: Option<u16>,
    #[command(flatten)]
    passed: Passed,
}

/// The name of the results' default folder.
pub(super) const RESULTS: &str = "closecall-study";
/// The seeds of a study, and those of a quick one: with two, an interval would be three times as wide as with three.
const SEEDS: [u32; 5] = [1, 2, 3, 4, 5];
const QUICK_SEEDS: usize = 3;

impl ScenarioArgs {
    /// Refuses options of `closecall run` without a scenario to run.
    pub(crate) fn check_without_scenario(&self) -> Result<()> {
        if self.passed.is_empty() { Ok(()) } else { Err(value("options of closecall run need a SCENARIO")) }
    }

    /// Does the missing runs and writes what all of them show; returns the exit status, 1 if some failed.
    pub fn run(
        self,
        scenario: &Path,
        out: Option<&Path>,
        quick: bool,
        sumo: Option<Sumo>,
        parse_run: &ParseRun,
    ) -> Result<u8> {
        let Some(mut sumo) = sumo else { return no_sumo().map(|()| 0) };
        let default_out = default_folder(scenario, RESULTS);
        let out = absolute(out.unwrap_or(&default_out))?;
        // Opened here so that an error carries the operating system's own message.
        input_file::file(scenario)?;
        let _alone = LogFolder::claim(&out)?;
        self.vary.iter().try_for_each(check)?;
        let seeds =
            self.seeds.unwrap_or_else(|| Seeds(SEEDS[..if quick { QUICK_SEEDS } else { SEEDS.len() }].to_vec()));
        let (args, files) = self.passed.shared(scenario, &self.vary)?;
        let all = ["closecall", "run"].into_iter().chain(args.iter().map(String::as_str)).chain(["--"]);
        let all = all.chain(self.passed.for_sumo.iter().map(String::as_str)).map(OsString::from);
        let own = request(&parse_run(all.collect())?)?;
        let plan = Plan::of(&self.vary, quick, &|vary| own_value(&own, vary))?;
        let runs = Sweep::of_settings(&args, &self.passed.for_sumo, &seeds, &plan.settings(), &out, &files)?;
        check_runs(&runs, &seeds, parse_run)?;
        let missing = runs.missing()?;
        let workers = Workers::Local(self.workers.map_or_else(processors, usize::from));
        let done = runs.tasks.len() - missing.len();
        let telling = if missing.is_empty() { Telling::Nothing } else { Telling::Cost };
        let step = sumos_value(&own, "step-length").and_then(|step| step.parse().ok());
        let progress = RunProgress::new(&missing, done, workers.at_once(), step, telling);
        distribute(&mut sumo, &workers, &missing, progress, &out.join(UNFINISHED))?;
        let failed = runs.missing()?.into_iter().map(|task| task.name.clone()).collect::<Vec<_>>();
        let study = Study::read(plan, &runs.tasks, &failed, seeds.to_string(), self.accuracy)?;
        let name = scenario.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let answer = scenario::write(&study, &out, &name)?;
        print_if_elsewhere(&default_out, scenario, RESULTS)?;
        print(format_args!("{answer}\nMore is in {}\n", out.join("study.md").display()))?;
        if !failed.is_empty() {
            print(format_args!("{} failed and are left out; the same command tries them again\n", failed.len()))?;
        }
        Ok(u8::from(!failed.is_empty()))
    }
}

/// The value that an option has in the run as it was asked for; none where neither the command line nor the configuration
/// sets one of SUMO's.
fn own_value(run: &RunRequest, vary: &Vary) -> Option<String> {
    let name = vary.option();
    if vary.is_sumos() || name == "step-length" {
        return sumos_value(run, name);
    }
    if name == "threads" {
        return Some(run.threads.to_string());
    }
    match serde_json::to_value(&run.options).ok()?.get(name.replace('-', "_"))? {
        serde_json::Value::String(text) => Some(text.clone()),
        other => Some(other.to_string()),
    }
}

/// The value of one of SUMO's options, by its words or the configuration.
fn sumos_value(run: &RunRequest, name: &str) -> Option<String> {
    word_value(&run.sumo_words, name).or_else(|| sumo_files::value_of(&run.scenario, name))
}

/// The value of an option among SUMO's words.
fn word_value(args: &[String], name: &str) -> Option<String> {
    let place = args.iter().rposition(|word| word.trim_start_matches('-').split('=').next() == Some(name))?;
    let own = args[place].split_once('=').map(|(_, value)| value.to_owned());
    let next = || args.get(place + 1).filter(|next| !next.starts_with("--")).cloned();
    own.or_else(next).or_else(|| Some("true".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_own_value_of_sumos_option_is_the_one_that_counts() {
        let args =
            ["-c", "a.sumocfg", "--step-length", "0.5", "--scale=2", "--step-method.ballistic"].map(str::to_owned);
        let of = |name| word_value(&args, name);
        assert_eq!(of("step-length").as_deref(), Some("0.5"));
        assert_eq!(of("scale").as_deref(), Some("2"));
        assert_eq!(of("step-method.ballistic").as_deref(), Some("true"));
        assert_eq!(of("end"), None);
    }
}
