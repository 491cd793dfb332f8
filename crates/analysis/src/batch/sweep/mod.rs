//! Sweeps: runs of one scenario with every seed and every combination of varied options, each run a task of its own.
//!
//! A sweep is planned here ([`Sweep::plan`]), run elsewhere, and finished here ([`Task::finish`]): a run's log becomes
//! `conflicts/run=NAME/conflicts.parquet` in the sweep's folder, in one atomic step. Runs whose file still fits are not
//! repeated ([`Sweep::missing`]), so the same command continues a sweep that was stopped.

mod done;
mod seeds;
mod setting;
mod task;
mod vary;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::logged::{Label, LabelValue};
use crate::{Error, Result};
use closecall_run::input::sumo_outputs::{PREFIX, has_outputs};

pub use seeds::Seeds;
pub use setting::Setting;
pub use task::Task;
pub(super) use task::{log_of, series_of};
pub use vary::Vary;

/// More runs than this are a typing mistake.
const MOST: usize = 1_000_000;

/// A run that is to be part of a sweep.
#[derive(Clone, Debug)]
pub struct PlannedRun {
    /// Its name.
    pub name: String,
    /// The words of `closecall run`, without `--out`.
    pub args: Vec<String>,
    /// The columns that distinguish it from the others.
    pub labels: Vec<Label>,
}

/// All runs of a sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The runs, in the order in which they start: all variants of a seed before the next seed.
    pub tasks: Vec<Task>,
    out: PathBuf,
}

impl Sweep {
    /// Plans a sweep of the scenario whose `closecall run` has these `args` and these options `for_sumo`.
    ///
    /// `also_read` are the files that closecall itself reads; a run is done only if their contents are unchanged.
    ///
    /// # Errors
    /// [`Error::VariedTwice`], [`Error::TooManyRuns`], and those of [`Sweep::of_settings`].
    pub fn plan(
        args: &[String],
        for_sumo: &[String],
        seeds: &Seeds,
        varied: &[Vary],
        out: &Path,
        also_read: &[PathBuf],
    ) -> Result<Self> {
        let mut columns = BTreeSet::new();
        if let Some(twice) = varied.iter().find(|vary| !columns.insert(vary.column())) {
            return Err(Error::VariedTwice(twice.parameter.clone()));
        }
        let runs = varied.iter().map(|vary| vary.values.len()).chain([seeds.0.len()]);
        if runs.fold(1, usize::saturating_mul) > MOST {
            return Err(Error::TooManyRuns(MOST));
        }
        let settings = vary::product(varied).iter().map(|chosen| Setting::of(chosen)).collect::<Vec<_>>();
        Self::of_settings(args, for_sumo, seeds, &settings, out, also_read)
    }

    /// Plans the runs of these settings; the other arguments are those of [`Sweep::plan`].
    ///
    /// # Errors
    /// [`Error::SameName`]; an error of closecall-run that names a file which cannot be read.
    pub fn of_settings(
        args: &[String],
        for_sumo: &[String],
        seeds: &Seeds,
        settings: &[Setting],
        out: &Path,
        also_read: &[PathBuf],
    ) -> Result<Self> {
        // Side by side, runs would write into the same files.
        let has_outputs = seeds.0.len() * settings.len() > 1
            && args.first().is_some_and(|scenario| has_outputs(Path::new(scenario), for_sumo));
        let mut runs = Vec::new();
        for &seed in &seeds.0 {
            for setting in settings {
                let name = format!("{}seed-{seed}", setting.name);
                let mut own = args.iter().chain(&setting.args).cloned().collect::<Vec<_>>();
                own.extend(["--seed".to_owned(), seed.to_string()]);
                let mut sumo = setting.without_its_options(for_sumo);
                sumo.extend_from_slice(&setting.for_sumo);
                if has_outputs {
                    sumo.push(format!("{PREFIX}={name}_"));
                }
                if !sumo.is_empty() {
                    own.push("--".to_owned());
                    own.append(&mut sumo);
                }
                let mut labels = setting.labels.clone();
                labels.push(Label { name: "seed".to_owned(), value: LabelValue::Count(seed) });
                runs.push(PlannedRun { name, args: own, labels });
            }
        }
        Self::of_runs(runs, out, also_read)
    }

    /// Plans these runs, all with labels of the same names.
    ///
    /// # Errors
    /// [`Error::SameName`]; an error of closecall-run that names a file which cannot be read.
    pub fn of_runs(runs: Vec<PlannedRun>, out: &Path, also_read: &[PathBuf]) -> Result<Self> {
        let read = done::contents(also_read)?;
        let mut names = BTreeSet::new();
        let mut tasks = Vec::with_capacity(runs.len());
        for PlannedRun { name, args, labels } in runs {
            if !names.insert(name.clone()) {
                return Err(Error::SameName(name));
            }
            let fingerprint = done::fingerprint(&args, &labels, &read);
            tasks.push(Task { name, args, out: out.to_owned(), labels, fingerprint });
        }
        Ok(Self { tasks, out: out.to_owned() })
    }

    /// The sweep of one of the runs, which are numbered from 1 on.
    ///
    /// # Errors
    /// [`Error::NoRun`] if no run has this number.
    pub fn only(mut self, number: usize) -> Result<Self> {
        let last = self.tasks.len();
        if !(1..=last).contains(&number) {
            return Err(Error::NoRun(number, last));
        }
        self.tasks = vec![self.tasks.swap_remove(number - 1)];
        Ok(self)
    }

    /// The runs to be done: those without a file in the folder, and those whose file no longer fits.
    ///
    /// # Errors
    /// [`Error::content`] if the folder contains the log of a single run, or runs of a sweep that varied other options and
    /// therefore has other columns.
    pub fn missing(&self) -> Result<Vec<&Task>> {
        done::missing(&self.out, &self.tasks)
    }

    /// The folder of the data set.
    pub fn data_set(&self) -> PathBuf {
        task::data_set(&self.out)
    }
}
