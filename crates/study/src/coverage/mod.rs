//! How often the intervals of docs/statistics_how.md hold the truth, and its tests are wrong, on known processes.
//!
//! Conflicts come one by one (Poisson), or in clusters of a geometric size of three on average, so that the variance of
//! a run's count is 2 · 3 − 1 = 5 times its mean. Values of a measure have tails of several shapes and are 0 at a crash.

mod cases;
mod process;
mod trial;

use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, Builder};
use std::time::Instant;

use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use cases::cases;
use closecall::util::threads::processors;
use closecall_analysis::statistics::rate::CONFIDENCE;
use closecall_analysis::study::number::number;
use trial::{Case, LEVEL, Told};

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
        let begin = |_| Builder::new().spawn_scoped(scope, work).ok();
        let workers = (1..processors()).filter_map(begin).collect::<Vec<_>>();
        let own = work();
        let joined = workers.into_iter().map(|worker| worker.join()).chain([Ok(own)]);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_counts_what_an_interval_misses_on_either_side() {
        let told = super::trial::case("rate", "process".to_owned(), 100, |chance| match chance.below(4) {
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
