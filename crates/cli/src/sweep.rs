//! `closecall sweep`: plans many runs, each a task, and hands them to the bridge, which distributes them.

use std::collections::HashSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, FromArgMatches};

use super::error::{Error, Result};
use super::files::{absolute, default_folder, print_if_elsewhere};
use super::print::{print, value};
use super::run::{RunArgs, request};
use super::run_progress::{RunProgress, Telling};
use super::sumo::{Sumo, no_sumo};
use super::workers::{Workers, WorkersArgs};
use closecall::util::units::counted;
use closecall_analysis::batch::sweep::{Seeds, Sweep, Task, Vary};
use closecall_run::Error as RunError;
use closecall_run::input::sumo_outputs::is_output;
use closecall_run::output::folder::LogFolder;
use closecall_run::util::input_file;

/// A SUMO scenario, its seeds, and the options to vary.
#[derive(Args)]
#[command(next_help_heading = "Run")]
pub(crate) struct SweepArgs {
    /// SUMO configuration file.
    #[arg(value_name = "SCENARIO", help_heading = None::<&str>)]
    scenario: PathBuf,
    /// Random seeds for SUMO, one run each, such as 1-100 or 1,2,5-9.
    #[arg(long, value_name = "SEEDS")]
    seeds: Seeds,
    /// Values of an option of closecall run, or of SUMO (sumo:NAME=A,B), one run each. If repeated, every combination is run.
    #[arg(long, value_name = "NAME=A,B,…", action = clap::ArgAction::Append)]
    vary: Vec<Vary>,
    #[command(flatten)]
    workers: WorkersArgs,
    /// Print the runs as CSV instead of doing them: the number of each, its name, and whether it is done.
    #[arg(long, conflicts_with_all = ["task", "workers", "scheduler"])]
    list: bool,
    /// Do only the run with this number in --list, for a batch system that starts a process for each run.
    #[arg(long, value_name = "N", conflicts_with_all = ["workers", "scheduler"])]
    task: Option<usize>,
    #[command(flatten)]
    passed: Passed,
    /// Folder for the results [default: closecall-sweep next to the scenario, or else in the working directory].
    #[arg(short, long, value_name = "DIR", help_heading = "Output", display_order = 0)]
    out: Option<PathBuf>,
    /// Print only errors.
    #[arg(short, long, help_heading = "Output", display_order = 0)]
    quiet: bool,
}

/// Parses a command line of `closecall run`, including its TOML file.
pub(crate) type ParseRun = dyn Fn(Vec<OsString>) -> Result<RunArgs>;

/// Arguments of `closecall run` that are the same in all runs, as they were typed.
#[derive(Debug, Default)]
pub(super) struct Passed {
    args: Vec<String>,
    pub for_sumo: Vec<String>,
    /// The files among them.
    files: Vec<PathBuf>,
}

impl Passed {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.args.is_empty() && self.for_sumo.is_empty()
    }

    /// The words of `closecall run` that all runs share, and the files whose content matters.
    pub fn shared(&self, scenario: &Path, varied: &[Vary]) -> Result<(Vec<String>, Vec<PathBuf>)> {
        let mut args = vec![text(&absolute(scenario)?)?];
        args.extend(DEFAULTS.map(|(option, value)| format!("--{option}={value}")));
        args.extend_from_slice(&self.args);
        let mut files = self.files.clone();
        for vary in varied.iter().filter(|vary| !vary.is_sumos() && FILES.contains(&vary.option())) {
            files.extend(vary.values.iter().map(PathBuf::from));
        }
        let named = files.iter().filter_map(|file| filter_in(file)).collect::<Vec<_>>();
        files.extend(named);
        Ok((args, files))
    }
}

/// Defaults of a sweep where `closecall run` has others. The workers already use all processors, so one thread per run is
/// fastest. Clips of thousands of runs are made only if they are asked for.
const DEFAULTS: [(&str, &str); 2] = [("threads", "1"), ("log-clips", "none")];
/// Arguments of `closecall run` that a sweep sets itself or has no use for.
const OWN: [&str; 14] = [
    "scenario",
    "configuration_file",
    "gui",
    "label",
    "roll_out",
    "pause_at",
    "quit_on_end",
    "out",
    "force",
    "seed",
    "quiet",
    "explain",
    "ssm_output",
    "trj_output",
];
/// The name of the results' default folder.
const RESULTS: &str = "closecall-sweep";
/// The folder of unfinished logs in that of the results, hidden; a run that is done by itself adds its name, as others may be
/// done meanwhile.
pub(super) const UNFINISHED: &str = ".unfinished";
/// Options that name a file whose content matters.
const FILES: [&str; 2] = ["config", "filter"];
/// The argument for the words after `--`.
const FOR_SUMO: &str = "sumo_options";

/// The arguments of `closecall run` that a sweep passes on, with its own defaults.
fn passed() -> Vec<Arg> {
    let all = RunArgs::augment_args(clap::Command::new("run"));
    let passed = all.get_arguments().filter(|argument| !OWN.contains(&argument.get_id().as_str())).cloned();
    let as_own = |argument: Arg| {
        let own = DEFAULTS.into_iter().find(|(option, _)| argument.get_long() == Some(*option));
        let argument = own.map_or(argument.clone(), |(_, value)| argument.default_value(value));
        let argument = match argument.get_long() {
            // The help of `closecall run` names its own default.
            Some("threads") => argument.help("Threads of each run at most, SUMO's own included"),
            _ => argument,
        };
        // In the help, they come after what only this command has.
        argument.display_order(None)
    };
    passed.map(as_own).collect()
}

impl Args for Passed {
    fn augment_args(command: clap::Command) -> clap::Command {
        // What was typed wins over the TOML file.
        command.args(passed().into_iter().map(|argument| {
            let name = argument.get_id().clone();
            if argument.is_positional() { argument } else { argument.overrides_with(name) }
        }))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Passed {
    fn from_arg_matches(matches: &ArgMatches) -> std::result::Result<Self, clap::Error> {
        let mut passed = Self::default();
        passed.update_from_arg_matches(matches)?;
        Ok(passed)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> std::result::Result<(), clap::Error> {
        for argument in passed() {
            let name = argument.get_id().as_str();
            if matches.value_source(name) != Some(ValueSource::CommandLine) {
                continue;
            }
            let values = matches.get_raw(name).into_iter().flatten();
            let values = values.map(|value| value.to_string_lossy().into_owned()).collect::<Vec<_>>();
            if FILES.contains(&name) {
                self.files.extend(values.iter().map(PathBuf::from));
            }
            match argument.get_long() {
                Some(long) if argument.get_action().takes_values() => {
                    self.args.push(format!("--{long}={}", values.join(",")));
                }
                Some(long) => self.args.push(format!("--{long}")),
                None if name == FOR_SUMO => self.for_sumo = values,
                None => {}
            }
        }
        Ok(())
    }
}

/// Does the missing runs; returns the exit status, 1 if some failed.
pub fn run(arguments: SweepArgs, sumo: Option<Sumo>, parse_run: &ParseRun) -> Result<u8> {
    let Some(mut sumo) = sumo else { return no_sumo().map(|()| 0) };
    let default_out = default_folder(&arguments.scenario, RESULTS);
    let out = absolute(arguments.out.as_deref().unwrap_or(&default_out))?;
    // Opened here so that an error carries the operating system's own message.
    input_file::file(&arguments.scenario)?;
    arguments.vary.iter().try_for_each(check)?;
    let (args, files) = arguments.passed.shared(&arguments.scenario, &arguments.vary)?;
    let mut plan = Sweep::plan(&args, &arguments.passed.for_sumo, &arguments.seeds, &arguments.vary, &out, &files)?;
    check_runs(&plan, &arguments.seeds, parse_run)?;
    if arguments.list {
        return list(&plan).map(|()| 0);
    }
    let mut unfinished = out.join(UNFINISHED);
    if let Some(number) = arguments.task {
        plan = plan.only(number)?;
        unfinished = out.join(format!("{UNFINISHED}-{}", plan.tasks[0].name));
    }
    // Single runs may be done side by side, each of them once.
    let _alone = LogFolder::claim(if arguments.task.is_some() { &unfinished } else { &out })?;
    let missing = plan.missing()?;
    let done = plan.tasks.len() - missing.len();
    let workers = arguments.workers.workers();
    let telling = if arguments.quiet { Telling::Nothing } else { Telling::Progress };
    let progress = RunProgress::new(&missing, done, workers.at_once(), None, telling);
    let failed = distribute(&mut sumo, &workers, &missing, progress, &unfinished)?;
    if !arguments.quiet {
        if arguments.out.is_none() {
            print_if_elsewhere(&default_out, &arguments.scenario, RESULTS)?;
        }
        let runs = counted((plan.tasks.len() - failed) as u64, "run");
        print(format_args!("{runs} in {}\n", plan.data_set().display()))?;
        if done > 0 {
            print(format_args!("{done} of them were there already\n"))?;
        }
        if failed > 0 {
            print(format_args!("{failed} failed; the same command tries them again\n"))?;
        }
    }
    Ok(u8::from(failed > 0))
}

/// Prints the runs of a sweep; their names need no quotes.
fn list(plan: &Sweep) -> Result<()> {
    let missing = plan.missing()?.into_iter().map(|task| &task.name).collect::<HashSet<_>>();
    let lines = plan.tasks.iter().enumerate();
    let lines = lines.map(|(place, task)| format!("{},{},{}\n", place + 1, task.name, !missing.contains(&task.name)));
    print(format_args!("task,run,done\n{}", lines.collect::<String>()))
}

/// The selection file that a TOML file of options names.
fn filter_in(file: &Path) -> Option<PathBuf> {
    let table = input_file::text(file).ok()?.parse::<toml::Table>().ok()?;
    Some(table.get("filter")?.as_str()?.into())
}

/// Has the missing runs done, with their logs in a working folder until then; returns how many failed.
pub(super) fn distribute(
    sumo: &mut Sumo,
    workers: &Workers,
    missing: &[&Task],
    mut progress: RunProgress,
    unfinished: &Path,
) -> Result<usize> {
    if missing.is_empty() {
        return Ok(0);
    }
    std::fs::create_dir_all(unfinished).map_err(|source| RunError::file(unfinished, source))?;
    let mut failed = 0;
    let outcome = (sumo.distribute)(workers, unfinished, missing, &mut |name, error| {
        failed += usize::from(error.is_some());
        progress.count(name, error.map(|error| format!("run {name} failed twice: {error}")));
    });
    let [done, all] = progress.counts();
    drop(progress);
    // Removes what killed workers left; if that fails, the folder is at least hidden.
    let _ = std::fs::remove_dir_all(unfinished);
    match outcome {
        Ok(()) => Ok(failed),
        Err(RunError::Stopped) => Err(Error::Paused(done, all)),
        Err(error) => Err(error.into()),
    }
}

/// Checks that an option can be varied.
pub(super) fn check(vary: &Vary) -> Result<()> {
    if vary.is_sumos() {
        return match vary.option() {
            "seed" => Err(value("--vary sumo:seed: use --seeds")),
            option if is_output(option) => Err(value(format!(
                "--vary sumo:{option}: its values are files, which several runs would write at once; write \
                 -- --{option} FILE for one file a run"
            ))),
            _ => Ok(()),
        };
    }
    let name = vary.option();
    let known = passed().into_iter().find(|argument| argument.get_long() == Some(name));
    match known {
        Some(argument) if argument.get_action().takes_values() => Ok(()),
        Some(_) => Err(value(format!("--vary {name}: --{name} takes no value"))),
        None if name == "seed" => Err(value("--vary seed: use --seeds")),
        None => Err(value(format!(
            "--vary {name}: closecall run has no such option that can be varied; for one of SUMO's write sumo:{name}"
        ))),
    }
}

/// Checks that `closecall run` accepts the words of each setting, with the first seed.
pub(super) fn check_runs(plan: &Sweep, seeds: &Seeds, parse_run: &ParseRun) -> Result<()> {
    for task in &plan.tasks[..plan.tasks.len() / seeds.0.len()] {
        let args = ["closecall", "run"].into_iter().chain(task.args.iter().map(String::as_str));
        let request = request(&parse_run(args.map(OsString::from).collect())?)?;
        if let Some((option, _)) = request.outputs.files().next() {
            return Err(value(format!("{option} in the file of --config: all runs would write the same file")));
        }
    }
    Ok(())
}

fn text(path: &Path) -> Result<String> {
    let text = path.to_str().map(str::to_owned);
    Ok(text.ok_or_else(|| RunError::content(path, "its name is not UTF-8, so a sweep cannot pass it on"))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed_of(args: &[&str]) -> Passed {
        let args = ["closecall", "a.sumocfg", "--seeds", "1"].iter().chain(args);
        let command = SweepArgs::augment_args(clap::Command::new("closecall").args_override_self(true));
        SweepArgs::from_arg_matches(&command.try_get_matches_from(args).unwrap()).unwrap().passed
    }

    #[test]
    fn only_typed_options_of_closecall_run_are_passed_on() {
        let passed =
            passed_of(&["--epsilon", "1", "--mu=paper", "--obstacles", "a,b", "--artefacts", "--", "--scale", "2"]);
        let mut args = passed.args;
        args.sort();
        assert_eq!(args, ["--artefacts", "--epsilon=1", "--mu=paper", "--obstacles=a,b"]);
        assert_eq!(passed.for_sumo, ["--scale", "2"]);
        assert!(passed_of(&[]).args.is_empty());
        assert_eq!(passed_of(&["--epsilon", "1", "--epsilon", "2"]).args, ["--epsilon=2"]);
    }

    #[test]
    fn what_cannot_be_varied_is_refused() {
        for (vary, said) in [
            ("seed=1,2", "use --seeds"),
            ("artefacts=1", "takes no value"),
            ("scale=1,2", "write sumo:scale"),
            ("sumo:fcd-output=a.xml,b.xml", "several runs would write at once"),
            ("sumo:log=a", "several runs would write at once"),
            ("out=a", "no such option"),
        ] {
            let message = check(&vary.parse().unwrap()).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
        }
        assert!(check(&"serious_ttc=1,2".parse().unwrap()).is_ok());
    }
}
