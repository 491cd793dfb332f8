//! The methods of statistics, each on processes that it may meet.

use super::process::{Process, uniform};
use super::trial::{Case, LEVEL, Told, case};
use closecall::util::units::counted;
use closecall_analysis::statistics::Ratio;
use closecall_analysis::statistics::extremes::crashes;
use closecall_analysis::statistics::gpd::Gpd;
use closecall_analysis::statistics::permutation::p_value;
use closecall_analysis::statistics::planning::{Spread, power};
use closecall_analysis::statistics::rate::{paired_ratio, rate, rate_ratio};
use closecall_analysis::statistics::weighted::WeightedEvents;
use closecall_analysis::study::number::number;

/// The ratio of two sets whose power is measured.
const RATIO: f64 = 1.3;
/// The spread of what the runs of one seed share, as a standard deviation of the logarithm.
const SHARED: f64 = 0.3;

/// All cases; a quick study has fewer sizes of tails and fewer samples.
pub(super) fn cases(quick: bool) -> Vec<Case> {
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

fn ratio_told(found: Ratio) -> Told {
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

/// A tail that is not generalised Pareto: a Weibull one of shape 1.3, which tends to ξ = 0 slowly.
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
    use crate::coverage::measure_case;

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
}
