//! The progress of many runs: a bar on a terminal, elsewhere a line now and then. A study states beforehand what its runs
//! cost, by the first run that ends.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use closecall::util::units::counted;
use closecall_analysis::batch::sweep::Task;

/// Without a terminal, lines of progress are this far apart.
const PERIOD: Duration = Duration::from_secs(30);
/// SUMO's own step length, in s, of a run that names none.
const SUMOS_STEP: f64 = 1.0;

/// How much is printed about many runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Telling {
    /// Only errors.
    Nothing,
    /// How far they are.
    Progress,
    /// First also what they will cost.
    Cost,
}

/// Shows how many runs are done.
pub(super) struct RunProgress {
    bar: Option<ProgressBar>,
    telling: Telling,
    started: Instant,
    told: Instant,
    before: usize,
    done: usize,
    all: usize,
    /// The names of the runs to do, each with its cost: the steps in a simulated second.
    costs: Vec<(String, f64)>,
    /// The runs at the same time.
    at_once: usize,
}

impl RunProgress {
    /// These runs, this number at the same time; others are done already.
    pub fn new(missing: &[&Task], before: usize, at_once: usize, own_step: Option<f64>, telling: Telling) -> Self {
        let all = before + missing.len();
        let on_terminal = telling != Telling::Nothing && std::io::stderr().is_terminal();
        let bar = on_terminal.then(|| {
            let style = ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {elapsed}, {eta} to go");
            let bar = ProgressBar::new(all as u64).with_style(style.unwrap_or(ProgressStyle::default_bar()));
            bar.enable_steady_tick(Duration::from_secs(1));
            bar.with_position(before as u64)
        });
        let own = own_step.unwrap_or(SUMOS_STEP);
        let costs = missing.iter().map(|task| (task.name.clone(), 1.0 / step_length(&task.args).unwrap_or(own)));
        let now = Instant::now();
        let (done, costs) = (before, costs.collect());
        let it = Self { bar, telling, started: now, told: now, before, done, all, costs, at_once: at_once.max(1) };
        if telling == Telling::Cost {
            let already = if before > 0 { format!(", {before} more are done") } else { String::new() };
            let runs = counted(missing.len() as u64, "run");
            it.say(&format!("{runs}{already}; {at_once} at the same time; the first tells how long they take"));
        }
        it
    }

    /// A run has ended; `failure` is what to print about it.
    pub fn count(&mut self, name: &str, failure: Option<String>) {
        self.done += 1;
        if let Some(failure) = failure {
            self.say(&failure);
        }
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
        let ended = self.done - self.before;
        let is_first = self.telling == Telling::Cost && ended == 1 && self.done < self.all;
        if is_first {
            let first = self.costs.iter().find(|(known, _)| known == name).map_or(1.0, |(_, cost)| *cost);
            let rest = self.costs.iter().map(|(_, cost)| cost).sum::<f64>() - first;
            let one = self.started.elapsed();
            let left = one.mul_f64(rest / first / self.at_once as f64);
            self.say(&format!("the first run took {}; all others will take about {}", in_words(one), in_words(left)));
        } else if self.telling != Telling::Nothing && self.bar.is_none() && self.told.elapsed() >= PERIOD {
            let spent = self.started.elapsed();
            let left = spent.mul_f64((self.all - self.done) as f64 / ended as f64);
            let (done, all, left) = (self.done, self.all, in_words(left));
            self.say(&format!("{done} of {all} runs after {}, about {left} to go", in_words(spent)));
        } else {
            return;
        }
        self.told = Instant::now();
    }

    /// The number of runs that are done, with those of before, and of all.
    pub fn counts(&self) -> [usize; 2] {
        [self.done, self.all]
    }

    fn say(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| eprintln!("closecall: {line}")),
            None => eprintln!("closecall: {line}"),
        }
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// The step length that the words of a run name, in s.
fn step_length(args: &[String]) -> Option<f64> {
    let named = args.iter().rev().find_map(|word| word.strip_prefix("--step-length="));
    named?.parse().ok().filter(|step| *step > 0.0)
}

/// A time as people say it.
fn in_words(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        ..10.0 => format!("{seconds:.1} s"),
        ..90.0 => format!("{seconds:.0} s"),
        ..5400.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_said_with_two_digits() {
        let said = [4.4, 89.0, 600.0, 9000.0].map(|seconds| in_words(Duration::from_secs_f64(seconds)));
        assert_eq!(said, ["4.4 s", "89 s", "10 min", "2.5 h"]);
    }

    #[test]
    fn the_last_step_length_counts() {
        let words = ["run", "--step-length=0.5", "--step-length=0.1", "--"].map(str::to_owned);
        assert_eq!(step_length(&words), Some(0.1));
        assert_eq!(step_length(&words[..1]), None);
    }
}
