//! How often the intervals of docs/statistics.md hold the truth, and how often its tests are wrong, on known processes.
//!
//! Conflicts come one by one (Poisson), or in clusters of a geometric size of [`CLUSTER`] on average, so that the variance of
//! a run's count is 2 · 3 − 1 = 5 times its mean. Values of a measure have tails of several shapes and are 0 at a crash.

use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use super::in_short::number;
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use crate::analysis::statistics::extremes::crashes;
use crate::analysis::statistics::gpd::Gpd;
use crate::analysis::statistics::permutation::p_value;
use crate::analysis::statistics::planning::{Spread, power};
use crate::analysis::statistics::rate::{CONFIDENCE, paired_ratio, rate, rate_ratio};
use crate::analysis::statistics::weighted::WeightedEvents;
use crate::util::threads::processors;
use crate::util::units::counted;

/// The mean size of a cluster.
const CLUSTER: f64 = 3.0;
/// The ratio of two sets whose power is measured.
const RATIO: f64 = 1.3;
/// The level of tests.
const LEVEL: f64 = 0.05;
/// The spread of what the runs of one seed share, as a standard deviation of the logarithm.
const SHARED: f64 = 0.3;

/// How conflicts come.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Process {
    Single,
    Clusters,
}

impl Process {
    const ALL: [Self; 2] = [Self::Single, Self::Clusters];

    fn name(self) -> &'static str {
        match self {
            Self::Single => "Poisson",
            Self::Clusters => "clusters",
        }
    }

    /// The number of conflicts of a run with this many on average.
    fn count(self, mean: f64, chance: &mut Chance) -> f64 {
        match self {
            Self::Single => poisson(mean, chance),
            Self::Clusters => {
                let clusters = poisson(mean / CLUSTER, chance) as usize;
                // Sizes from 1 on, of which each goes on with the probability 1 − 1/3.
                let size = |chance: &mut Chance| 1.0 + (uniform(chance).ln() / (1.0 - 1.0 / CLUSTER).ln()).floor();
                (0..clusters).map(|_| size(chance)).sum()
            }
        }
    }

    fn counts(self, runs: usize, mean: f64, chance: &mut Chance) -> Vec<f64> {
        (0..runs).map(|_| self.count(mean, chance)).collect()
    }
}

/// A number above 0, up to 1.
fn uniform(chance: &mut Chance) -> f64 {
    1.0 - chance.between(0.0, 1.0)
}

/// A count of independent events: how many exponential times fit into `mean`.
fn poisson(mean: f64, chance: &mut Chance) -> f64 {
    let (mut count, mut time) = (0.0, -uniform(chance).ln());
    while time < mean {
        count += 1.0;
        time -= uniform(chance).ln();
    }
    count
}

/// What one sample told.
enum Told {
    /// An interval, an estimate, and the truth.
    Interval { low: f64, high: f64, estimate: f64, truth: f64 },
    /// Whether a test rejected, where it had reason to, and the power that it says it has.
    Rejected(bool, Option<f64>),
    /// The method refused.
    Refused,
}

/// One method on one process.
struct Case {
    method: &'static str,
    process: String,
    samples: usize,
    draw: Box<dyn Fn(&mut Chance) -> Told + Sync>,
}

/// Measures every case, several at a time.
pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let cases = cases(plan.quick);
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(at) else { return done };
            done.push((at, measure_case(case, at as u64)));
        }
    };
    let mut rows = thread::scope(|scope| {
        let workers = (0..processors()).map(|_| scope.spawn(work)).collect::<Vec<_>>();
        let joined = workers.into_iter().map(|worker| worker.join());
        joined.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect::<Vec<_>>()
    });
    rows.sort_by_key(|(at, _)| *at);
    rows.into_iter().map(|(_, row)| row).collect()
}

fn measure_case(case: &Case, seed: u64) -> Measurement {
    let mut chance = Chance::new(seed);
    let begin = Instant::now();
    let told = (0..case.samples).map(|_| (case.draw)(&mut chance)).collect::<Vec<_>>();
    let ns_per_item = begin.elapsed().as_nanos() as f64 / case.samples as f64;
    let (mut used, mut below, mut above, mut refused) = (0_usize, 0_usize, 0_usize, 0_usize);
    let (mut estimates, mut said) = (Vec::new(), Vec::new());
    let mut is_size = false;
    for told in &told {
        match *told {
            Told::Interval { low, high, estimate, truth } => {
                below += usize::from(high < truth);
                above += usize::from(low > truth);
                estimates.extend((truth > 0.0).then_some(estimate / truth));
            }
            Told::Rejected(rejected, Some(power)) => {
                below += usize::from(!rejected);
                said.push(power);
            }
            Told::Rejected(rejected, None) => {
                above += usize::from(rejected);
                is_size = true;
            }
            Told::Refused => {
                refused += 1;
                continue;
            }
        }
        used += 1;
    }
    let share = |count: usize| count as f64 / used.max(1) as f64;
    let mut scene = case.process.clone();
    let error = if !said.is_empty() {
        let said = said.iter().sum::<f64>() / said.len() as f64;
        // Writing to a String does not fail.
        let _ = write!(scene, "; says {:.0} %", 100.0 * said);
        (1.0 - share(below) - said).abs()
    } else if is_size {
        (share(above) - LEVEL).abs()
    } else {
        (1.0 - share(below + above) - CONFIDENCE).abs()
    };
    if refused > 0 {
        let _ = write!(scene, "; {refused} refused");
    }
    estimates.sort_unstable_by(f64::total_cmp);
    if case.method.starts_with("crash")
        && let Some(median) = estimates.get(estimates.len() / 2)
    {
        let _ = write!(scene, "; median {} of the truth", number(*median));
    }
    Measurement {
        axis: Axis::Coverage,
        method: case.method,
        parameter: scene.clone(),
        error_name: "distance from what it says",
        error,
        false_negative_rate: share(below),
        false_positive_rate: share(above),
        ns_per_item,
        items: used,
        on_pareto_front: false,
        scene: format!("{}: {scene}", case.method),
        default: true,
    }
}

/// The table of the page: what each method says and holds, with its standard error.
pub(super) fn table(text: &mut String, rows: &[&Measurement]) {
    // Writing to a String does not fail.
    let _ = write!(
        text,
        "\n| method | process | says | holds, with its standard error | too low | too high | samples |\n|---|---|---|---|---|---|---|\n"
    );
    for row in rows {
        let (holds, says) = if row.method.contains("size") {
            (row.false_positive_rate, format!("{:.0} %", 100.0 * LEVEL))
        } else if row.method.contains("power") {
            (1.0 - row.false_negative_rate, "its power".to_owned())
        } else {
            (1.0 - row.false_negative_rate - row.false_positive_rate, format!("{:.0} %", 100.0 * CONFIDENCE))
        };
        let error = (holds * (1.0 - holds) / row.items.max(1) as f64).sqrt();
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        let _ = writeln!(
            text,
            "| {} | {} | {says} | {:.1} ± {:.1} % | {} | {} | {} |",
            row.method,
            row.parameter,
            100.0 * holds,
            100.0 * error,
            percent(row.false_negative_rate),
            percent(row.false_positive_rate),
            row.items
        );
    }
}

fn cases(quick: bool) -> Vec<Case> {
    let mut cases = Vec::new();
    let many = if quick { 300 } else { 2000 };
    for process in Process::ALL {
        for total in [50, 500, 5000] {
            for runs in [1, 2, 4, 8, 32] {
                cases.push(of_rate(process, total, runs, many));
            }
        }
        for total in [50, 500] {
            for runs in [1, 8] {
                cases.push(of_risk(process, total, runs, many));
            }
            for runs in [1, 4, 8, 32] {
                cases.push(of_ratio(process, total, runs, many));
            }
        }
        for runs in [4, 8] {
            cases.push(of_pairs(process, runs, many));
            let samples = if quick { 60 } else { 600 };
            cases.extend([of_size(process, runs, samples), of_power(process, runs, samples)]);
        }
    }
    let sizes = if quick { &[100, 300][..] } else { &[100, 300, 1000, 5000] };
    for conflicts in sizes {
        for (shape, scale) in [(-0.3, 0.3), (-0.1, 0.15), (0.0, 0.15), (0.2, 0.1)] {
            cases.push(of_tail(Process::Single, Gpd { shape, scale }, *conflicts, if quick { 40 } else { 300 }));
        }
        cases.push(of_weibull(*conflicts, if quick { 40 } else { 300 }));
    }
    for conflicts in sizes {
        let tail = Gpd { shape: 0.0, scale: 0.15 };
        cases.push(of_tail(Process::Clusters, tail, *conflicts, if quick { 40 } else { 300 }));
    }
    cases
}

fn case(
    method: &'static str,
    process: String,
    samples: usize,
    draw: impl Fn(&mut Chance) -> Told + Sync + 'static,
) -> Case {
    Case { method, process, samples, draw: Box::new(draw) }
}

fn named(process: Process, total: u32, runs: usize) -> String {
    format!("{}, {total} conflicts in {}", process.name(), counted(runs as u64, "run"))
}

fn of_rate(process: Process, total: u32, runs: usize, samples: usize) -> Case {
    let method = if runs > 1 { "rate, t over runs" } else { "rate, Poisson's exact" };
    let truth = f64::from(total) / runs as f64;
    case(method, named(process, total, runs), samples, move |chance| {
        rate(&process.counts(runs, truth, chance), &vec![1.0; runs]).map_or(Told::Refused, |found| Told::Interval {
            low: found.low,
            high: found.high,
            estimate: found.value,
            truth,
        })
    })
}

/// The sum of crash probabilities, most of them small: the fourth power of a uniform number, 0.2 on average.
fn of_risk(process: Process, total: u32, runs: usize, samples: usize) -> Case {
    let method = if runs > 1 { "risk index, t over runs" } else { "risk index, weighted events" };
    case(method, named(process, total, runs), samples, move |chance| {
        let mut events = WeightedEvents::default();
        for run in 0..runs {
            let count = process.count(f64::from(total) / runs as f64, chance) as usize;
            (0..count).for_each(|_| events.add(run, uniform(chance).powi(4)));
        }
        events.interval(runs).map_or(Told::Refused, |found| Told::Interval {
            low: found.low,
            high: found.high,
            estimate: found.value,
            truth: 0.2 * f64::from(total),
        })
    })
}

fn of_ratio(process: Process, total: u32, runs: usize, samples: usize) -> Case {
    let method = if runs > 1 { "ratio, t over runs" } else { "ratio, two counts" };
    let mean = f64::from(total) / runs as f64;
    case(method, named(process, total, runs) + " each", samples, move |chance| {
        let [first, other] = [RATIO, 1.0].map(|ratio| process.counts(runs, ratio * mean, chance));
        let traffic = vec![1.0; runs];
        rate_ratio((&first, &traffic), (&other, &traffic)).map_or(Told::Refused, ratio_told)
    })
}

fn ratio_told(found: crate::analysis::statistics::Ratio) -> Told {
    let high = found.high.unwrap_or(f64::INFINITY);
    Told::Interval { low: found.low, high, estimate: found.value.unwrap_or(f64::INFINITY), truth: RATIO }
}

/// Runs of the same seeds, whose demands differ.
fn of_pairs(process: Process, runs: usize, samples: usize) -> Case {
    case("ratio, t over pairs", named(process, 500, runs) + " each, seeds shared", samples, move |chance| {
        let means = (0..runs).map(|_| 500.0 / runs as f64 * (SHARED * chance.normal()).exp()).collect::<Vec<_>>();
        let [first, other] =
            [RATIO, 1.0].map(|ratio| means.iter().map(|mean| process.count(ratio * mean, chance)).collect::<Vec<_>>());
        let traffic = vec![1.0; runs];
        paired_ratio((&first, &traffic), (&other, &traffic)).map_or(Told::Refused, ratio_told)
    })
}

/// The p-value of the difference between two sets of runs with equal traffic.
fn tested([first, other]: &[Vec<f64>; 2]) -> Option<f64> {
    let all = [&first[..], other].concat();
    let difference = |split: &[bool]| {
        Some(all.iter().zip(split).map(|(count, is_first)| if *is_first { *count } else { -count }).sum::<f64>())
    };
    p_value(all.len(), first.len(), difference).map(|(p, _)| p)
}

fn of_size(process: Process, runs: usize, samples: usize) -> Case {
    case("permutation test, size", named(process, 500, runs) + " each", samples, move |chance| {
        let sets = [(); 2].map(|()| process.counts(runs, 500.0 / runs as f64, chance));
        tested(&sets).map_or(Told::Refused, |p| Told::Rejected(p <= LEVEL, None))
    })
}

fn of_power(process: Process, runs: usize, samples: usize) -> Case {
    let name = format!("{} each, ratio {RATIO}", named(process, 500, runs));
    case("permutation test, power", name, samples, move |chance| {
        let sets = [RATIO, 1.0].map(|ratio| process.counts(runs, ratio * 500.0 / runs as f64, chance));
        let traffic = vec![1.0; runs];
        let [first, other] = sets.each_ref().map(|counts| Spread::of(counts, &traffic));
        let said = first.zip(other).and_then(|(first, other)| power(RATIO, first, other));
        tested(&sets).zip(said).map_or(Told::Refused, |(p, said)| Told::Rejected(p <= LEVEL, Some(said)))
    })
}

/// Values whose distance below 1 has a known distribution, and are 0 where it is more.
fn of_values(
    of: Process,
    name: String,
    conflicts: u32,
    samples: usize,
    crash: f64,
    below: impl Fn(f64) -> f64 + Sync + 'static,
) -> Case {
    let truth = f64::from(conflicts) * crash;
    let process = format!("{}, {name}, {conflicts} conflicts, {} crashes per hour", of.name(), number(truth));
    case("crash frequency, extreme values", process, samples, move |chance| {
        let count = of.count(f64::from(conflicts), chance) as usize;
        let mut values = (0..count).map(|_| (1.0 - below(uniform(chance))).max(0.0)).collect::<Vec<_>>();
        values.sort_unstable_by(f64::total_cmp);
        crashes(&values, count, 1.0).map_or(Told::Refused, |found| Told::Interval {
            low: found.low,
            high: found.high,
            estimate: found.per_hour,
            truth,
        })
    })
}

fn of_tail(of: Process, tail: Gpd, conflicts: u32, samples: usize) -> Case {
    of_values(of, format!("tail with ξ = {}", tail.shape), conflicts, samples, tail.survival(1.0), move |probability| {
        tail.exceeded(probability)
    })
}

/// A tail that is no generalised Pareto distribution: a Weibull one of shape 1.3, which tends to ξ = 0 slowly.
fn of_weibull(conflicts: u32, samples: usize) -> Case {
    const SCALE: f64 = 0.25;
    const SHAPE: f64 = 1.3;
    let crash = (-(1.0 / SCALE).powf(SHAPE)).exp();
    of_values(Process::Single, "Weibull tail".to_owned(), conflicts, samples, crash, |probability| {
        SCALE * (-probability.ln()).powf(1.0 / SHAPE)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_have_five_times_the_variance_of_single_conflicts() {
        for (process, wanted) in [(Process::Single, 1.0), (Process::Clusters, 5.0)] {
            let counts = process.counts(20_000, 30.0, &mut Chance::new(1));
            let mean = counts.iter().sum::<f64>() / 20_000.0;
            let variance = counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / 20_000.0;
            assert!((mean - 30.0).abs() < 0.4 && (variance / mean / wanted - 1.0).abs() < 0.05, "{mean} {variance}");
        }
    }

    #[test]
    fn intervals_over_runs_hold_what_they_say_and_a_single_run_of_clusters_does_not() {
        let holds = |case: Case| {
            let row = measure_case(&case, 1);
            1.0 - row.false_negative_rate - row.false_positive_rate
        };
        for process in Process::ALL {
            // The standard error is 0.5 %.
            let found = holds(of_rate(process, 5000, 8, 2000));
            assert!((0.93..0.97).contains(&found), "{process:?}: {found}");
        }
        assert!(holds(of_rate(Process::Clusters, 500, 1, 500)) < 0.75);
        assert!(holds(of_rate(Process::Single, 500, 1, 500)) > 0.93);
    }

    #[test]
    fn a_row_counts_what_an_interval_misses_on_either_side() {
        let told = case("rate", "process".to_owned(), 100, |chance| match chance.below(4) {
            0 => Told::Refused,
            1 => Told::Interval { low: 2.0, high: 3.0, estimate: 2.5, truth: 1.0 },
            _ => Told::Interval { low: 0.0, high: 3.0, estimate: 1.0, truth: 1.0 },
        });
        let row = measure_case(&told, 1);
        assert!(row.items < 100 && row.false_negative_rate == 0.0 && row.false_positive_rate > 0.2, "{row:?}");
        assert!(row.parameter.ends_with("refused"));
        let mut text = String::new();
        table(&mut text, &[&row]);
        assert!(text.lines().last().is_some_and(|line| line.contains("| 95 % | ")), "{text}");
    }
}
