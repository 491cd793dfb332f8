//! The runs of each phase, planned as a sweep: what was done already is not done again.

use std::path::{Path, PathBuf};

use super::answer::Answer;
use super::arms::{ANSWERED, BASELINE, ERROR, FILMED, RolledOut, name_of};
use super::asked::{Asked, Draws, Onset};
use super::page;
use super::paths::{Baseline, nearest};
use super::scenario::{Scenario, Subject, Tools};
use crate::batch::extract::WHOLE_STATE;
use crate::batch::sweep::{PlannedRun, Sweep};
use crate::logged::{Label, LabelValue, LoggedConflict};
use crate::{Error, Result, rows_csv};
use closecall_run::run::roll_out::{DriverError, ErringDriver, Outcome, ROLL_OUT, RollOut, Watched};

/// SUMO's seeds are below this.
const SEEDS: u32 = 1 << 31;
/// What the other driver is like that answers an error: the median.
const MEDIAN: f64 = 0.5;

/// Conflicts and what is asked about them.
#[derive(Debug)]
pub struct WhatIf {
    /// What is asked.
    pub asked: Asked,
    out: PathBuf,
    scenario: Scenario,
    baselines: Vec<std::result::Result<Baseline, String>>,
}

impl WhatIf {
    /// Prepares what is asked about conflicts of the log in a folder; `out` is the folder of the results.
    ///
    /// # Errors
    /// [`Error::content`] where SUMO cannot run it again; those of reading and writing.
    pub fn prepare(
        log: &Path,
        conflicts: Vec<LoggedConflict>,
        asked: Asked,
        out: &Path,
        tools: &mut Tools,
    ) -> Result<Self> {
        let scenario = Scenario::prepare(log, conflicts, &asked, out.join("scenario"), tools)?;
        Ok(Self { asked, out: out.to_owned(), scenario, baselines: Vec::new() })
    }

    /// The run that saves the states, if any are needed, in a data set of its own.
    ///
    /// # Errors
    /// Those of [`Sweep::of_runs`].
    pub fn original(&self) -> Result<Sweep> {
        let watched = self.scenario.subjects.iter().map(watched).collect();
        let states = self.scenario.starts().map(|(_, _, period)| (period.from, self.scenario.state(period)));
        let mut states = states.collect::<Vec<_>>();
        states.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        states.dedup();
        let times = joined(states.iter().map(|(time, _)| time.to_string()));
        let files = joined(states.iter().map(|(_, file)| file.display().to_string()));
        let sumo = ["--save-state.times", &*times, "--save-state.files", &*files].into_iter().chain(WHOLE_STATE);
        let sumo = sumo.filter(|_| !self.asked.is_exact);
        let roll_out = RollOut { watched, ..RollOut::default() };
        let args = self.args(&self.scenario.whole(), self.scenario.seed, &roll_out, [], sumo.map(str::to_owned))?;
        let run = PlannedRun { name: page::ORIGINAL.to_owned(), args, labels: Vec::new() };
        Sweep::of_runs(vec![run], &self.out.join(page::ORIGINAL), &[self.scenario.settings()])
    }

    /// The runs from each start in which no driver errs, once the original has ended.
    ///
    /// # Errors
    /// Those of [`Sweep::of_runs`].
    pub fn baselines(&self) -> Result<Sweep> {
        let runs = self.scenario.starts().map(|(subject, start, _)| {
            let roll_out = RollOut { watched: vec![watched(subject)], ..RollOut::default() };
            self.run(subject, start, BASELINE, start as u32, self.scenario.seed, &roll_out)
        });
        self.sweep(runs.collect::<Result<_>>()?)
    }

    /// The roll-outs of the conflicts that happen in their baselines, once these have ended.
    ///
    /// # Errors
    /// Those of [`Sweep::of_runs`], and of reading the baselines.
    pub fn roll_outs(&mut self) -> Result<Sweep> {
        let [original] = &self.original()?.tasks[..] else { return self.sweep(Vec::new()) };
        let baselines = self.baselines()?;
        let mut tasks = baselines.tasks.iter();
        let is_exact = self.asked.is_exact;
        let own = |subject: &Subject| nearest(subject, original, tasks.by_ref().take(subject.periods.len()), is_exact);
        self.baselines = self.scenario.subjects.iter().map(own).collect::<Result<_>>()?;
        let mut runs = Vec::new();
        for (subject, _) in self.that_happen() {
            for number in 0..self.asked.roll_outs {
                runs.push(self.roll_out(subject, number, ERROR)?);
            }
        }
        self.sweep(runs)
    }

    /// The roll-outs with a contact once more, with the other driver braking as well.
    ///
    /// # Errors
    /// Those of [`Sweep::of_runs`], and of reading the roll-outs.
    pub fn answered(&self) -> Result<Sweep> {
        let mut runs = Vec::new();
        for (subject, baseline) in self.that_happen() {
            for rolled in self.rolled_out(subject)?.iter().filter(|rolled| rolled.outcome.contact.is_some()) {
                // Persons cannot be steered.
                if !baseline.persons.contains(&self.drawn_driver(subject, rolled.number).foe) {
                    runs.push(self.roll_out(subject, rolled.number, ANSWERED)?);
                }
            }
        }
        self.sweep(runs)
    }

    /// The first roll-out of each conflict with a contact and the first without, once more with clips.
    ///
    /// # Errors
    /// Those of [`Sweep::of_runs`], and of reading the roll-outs.
    pub fn filmed(&self) -> Result<Sweep> {
        let mut runs = Vec::new();
        for (subject, _) in self.that_happen() {
            let rolled = self.rolled_out(subject)?;
            for is_contact in [true, false] {
                let first = rolled.iter().find(|rolled| rolled.outcome.contact.is_some() == is_contact);
                if let Some(first) = first {
                    runs.push(self.roll_out(subject, first.number, FILMED)?);
                }
            }
        }
        self.sweep(runs)
    }

    /// What the roll-outs say, once all have ended; `lost` are the names of those that failed.
    ///
    /// # Errors
    /// Those of reading the runs.
    pub fn answers(&self, lost: &[String]) -> Result<Vec<Answer>> {
        let of = |(subject, baseline): (&Subject, &std::result::Result<Baseline, String>)| match baseline {
            Err(why) => Ok(Answer::refused(&subject.conflict, why)),
            Ok(baseline) => {
                let is_lost = |name: &&String| name.starts_with(&name_of(subject.conflict.id, ERROR, ""));
                let lost = lost.iter().filter(is_lost).count() as u64;
                let answered = self.outcomes(subject, ANSWERED)?;
                let filmed = self.outcomes(subject, FILMED)?;
                Answer::of(&subject.conflict, baseline, &self.rolled_out(subject)?, &answered, &filmed, lost)
            }
        };
        self.scenario.subjects.iter().zip(&self.baselines).map(of).collect()
    }

    /// Writes `whatif.csv` and `whatif.html` into the folder of the results; returns the paths of the two.
    ///
    /// # Errors
    /// Those of reading the runs and of writing the files.
    pub fn write(&self, answers: &[Answer]) -> Result<[PathBuf; 2]> {
        let files = [page::TABLE, page::PAGE].map(|name| self.out.join(name));
        rows_csv::write(&files[0], answers)?;
        page::write(&self.out, &self.asked.in_words())?;
        Ok(files)
    }

    fn that_happen(&self) -> impl Iterator<Item = (&Subject, &Baseline)> {
        let all = self.scenario.subjects.iter().zip(&self.baselines);
        all.filter_map(|(subject, baseline)| Some((subject, baseline.as_ref().ok()?)))
    }

    /// The roll-outs of a conflict that have ended.
    fn rolled_out(&self, subject: &Subject) -> Result<Vec<RolledOut>> {
        self.outcomes(subject, ERROR)
    }

    /// The runs of an arm of a conflict that have ended.
    fn outcomes(&self, subject: &Subject, arm: &'static str) -> Result<Vec<RolledOut>> {
        let planned = (0..self.asked.roll_outs).map(|number| self.roll_out(subject, number, arm));
        let sweep = self.sweep(planned.collect::<Result<_>>()?)?;
        let mut found = Vec::new();
        for (task, number) in sweep.tasks.into_iter().zip(0..) {
            let path = task.beside().join(ROLL_OUT);
            if task.file().exists() && path.exists() {
                found.push(RolledOut { number, outcome: Outcome::read(&path)?, task });
            }
        }
        Ok(found)
    }

    /// A roll-out with the driver that is drawn for its number; with the other braking too in the arm `answered`.
    fn roll_out(&self, subject: &Subject, number: u32, arm: &'static str) -> Result<PlannedRun> {
        let mut drivers = vec![self.drawn_driver(subject, number)];
        if arm == ANSWERED {
            let ErringDriver { id, foe, from, .. } = drivers[0].clone();
            let (response, deceleration) = (MEDIAN, MEDIAN);
            drivers.push(ErringDriver { id: foe, foe: id, error: DriverError::Late, from, response, deceleration });
        }
        let roll_out =
            RollOut { watched: vec![watched(subject)], drivers, ends_at_contact: true, ..RollOut::default() };
        // A state has the numbers of draws so far; what is drawn follows from the seed.
        let seed = match self.asked.draws {
            Draws::Same => self.scenario.seed,
            Draws::New => self.asked.seed.wrapping_add(number) % SEEDS,
        };
        let start = self.baseline(subject).map_or(0, |baseline| baseline.start);
        self.run(subject, start, arm, number, seed, &roll_out)
    }

    /// The baseline of a subject; none where its conflict does not happen.
    fn baseline(&self, subject: &Subject) -> Option<&Baseline> {
        self.that_happen().find(|(known, _)| known.conflict.id == subject.conflict.id).map(|(_, baseline)| baseline)
    }

    /// The driver that errs in a roll-out.
    fn drawn_driver(&self, subject: &Subject, number: u32) -> ErringDriver {
        let drawn = self.asked.draw(self.scenario.seed, subject.conflict.id, number);
        let LoggedConflict { ego, foe, .. } = &subject.conflict;
        let baseline = self.baseline(subject);
        let is_person = |id: &str| baseline.is_some_and(|baseline| baseline.persons.iter().any(|person| person == id));
        let is_foe = if drawn.is_foe { !is_person(foe) } else { is_person(ego) };
        let (id, other) = if is_foe { (foe, ego) } else { (ego, foe) };
        let from = baseline.filter(|_| self.asked.from == Onset::Worst).and_then(|baseline| baseline.worst);
        ErringDriver {
            id: id.to_string(),
            foe: other.to_string(),
            error: self.asked.error,
            from,
            response: drawn.response,
            deceleration: drawn.deceleration,
        }
    }

    fn run(
        &self,
        subject: &Subject,
        start: usize,
        arm: &'static str,
        number: u32,
        seed: u32,
        roll_out: &RollOut,
    ) -> Result<PlannedRun> {
        let more = match arm {
            BASELINE => &["--log-series"][..],
            FILMED => &["--log-clips=caution"],
            _ => &[],
        };
        // Nothing is logged before, as after a state.
        let warm_up = self.asked.is_exact.then(|| format!("--warmup={}", subject.periods[start].warm_up_of_run));
        let more = more.iter().copied().chain(warm_up.as_deref());
        let args = self.args(&self.scenario.configuration(subject, start), seed, roll_out, more, [])?;
        let id = subject.conflict.id;
        let label = |name: &str, value| Label { name: name.to_owned(), value };
        let labels = vec![
            label("conflict", LabelValue::Count(u32::try_from(id).unwrap_or(u32::MAX))),
            label("arm", LabelValue::Text(arm.to_owned())),
            label("roll_out", LabelValue::Count(number)),
        ];
        Ok(PlannedRun { name: name_of(id, arm, &number.to_string()), args, labels })
    }

    /// The words of `closecall run`.
    fn args<'a>(
        &self,
        configuration: &Path,
        seed: u32,
        roll_out: &RollOut,
        more: impl IntoIterator<Item = &'a str>,
        sumo: impl IntoIterator<Item = String>,
    ) -> Result<Vec<String>> {
        let text = |path: &Path| {
            let text = path.to_str().map(str::to_owned);
            text.ok_or_else(|| Error::content(path, "its name is not UTF-8, so a run cannot be told it"))
        };
        let roll_out = serde_json::to_string(roll_out).map_err(|error| Error::Value(error.to_string()))?;
        let mut args = vec![text(configuration)?, format!("--config={}", text(&self.scenario.settings())?)];
        args.extend(["--threads=1".to_owned(), "--log-clips=none".to_owned(), format!("--seed={seed}")]);
        args.extend(more.into_iter().map(str::to_owned));
        args.extend([format!("--roll-out={roll_out}"), "--".to_owned()]);
        args.extend(sumo);
        Ok(args)
    }

    fn sweep(&self, runs: Vec<PlannedRun>) -> Result<Sweep> {
        Sweep::of_runs(runs, &self.out, &[self.scenario.settings()])
    }
}

/// The two of a subject, as long as any of its periods lasts.
fn watched(subject: &Subject) -> Watched {
    let LoggedConflict { ego, foe, .. } = &subject.conflict;
    let from = subject.periods.iter().map(|period| period.from).fold(f64::INFINITY, f64::min);
    let until = subject.periods.iter().map(|period| period.end).fold(0.0, f64::max);
    Watched { pair: [ego.to_string(), foe.to_string()], from, until }
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.collect::<Vec<_>>().join(",")
}
