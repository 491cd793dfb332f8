//! The share of false alarms of the statistical test on real runs of an unchanged scenario: an experiment that
//! docs/compare.md describes.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]

use std::path::PathBuf;

use closecall_analysis::batch::regress::outcome::Outcome;
use closecall_analysis::batch::regress::scenario::RegressSettings;
use closecall_analysis::batch::regress::statistics::comparisons;

const TRIALS: usize = 10_000;
const SEEDS: usize = 6;

/// Both sides of a trial are drawn from the same runs, without repeating a seed.
fn main() {
    // cargo adds `--bench` to the arguments.
    let mut folders = std::env::args_os().skip(1).filter(|word| word != "--bench").map(PathBuf::from);
    let (Some(nets), Some(folder)) = (folders.next(), folders.next()) else {
        println!("usage: cargo bench --bench false_alarms -- SCENARIO LOGS (a folder with seed-1, seed-2, …)");
        return;
    };
    let logs = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut runs = logs
        .map(|log| {
            let seed = log.file_name().unwrap().to_str().unwrap().trim_start_matches("seed-").parse::<u32>().unwrap();
            Outcome::collect(&nets, &[(seed, log)]).unwrap()
        })
        .collect::<Vec<_>>();
    runs.sort_by_key(Outcome::seeds);
    let settings = RegressSettings::default();
    let mut random = fastrand::Rng::with_seed(1);
    let mut alarms = 0;
    for _ in 0..TRIALS {
        for place in 0..2 * SEEDS {
            let other = random.usize(place..runs.len());
            runs.swap(place, other);
        }
        let expected = together(&runs[..SEEDS]);
        let found = together(&runs[SEEDS..2 * SEEDS]);
        alarms += usize::from(comparisons(&expected, &found, &settings).iter().any(|comparison| comparison.differs));
    }
    println!("{alarms} false alarms in {TRIALS} trials of {SEEDS} against {SEEDS} of {} seeds", runs.len());
    assert!(alarms * 100 <= TRIALS);
}

fn together(runs: &[Outcome]) -> Outcome {
    let mut all = runs[0].clone();
    for run in &runs[1..] {
        all.summary.seeds.extend(run.summary.seeds.clone());
        all.conflicts.extend(run.conflicts.clone());
    }
    all
}
