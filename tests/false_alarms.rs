//! How often the statistical test finds a difference where nothing was changed, on real runs: an experiment, to be
//! repeated as docs/compare.md says.

use std::path::PathBuf;

use closecall::regress::outcome::Outcome;
use closecall::regress::scenario::Settings;
use closecall::regress::statistics::comparisons;

const TRIALS: usize = 10_000;
const SEEDS: usize = 6;

/// Both sides of a trial are drawn from the same runs, no seed twice.
#[test]
#[ignore = "needs the logs of many runs; CLOSECALL_LOGS is their folder, with seed-1, seed-2, …"]
fn at_most_one_false_alarm_in_a_hundred_between_runs_of_the_same_scenario() {
    let folder = PathBuf::from(std::env::var("CLOSECALL_LOGS").unwrap());
    let nets = PathBuf::from(std::env::var("CLOSECALL_SCENARIO").unwrap());
    let logs = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut runs = logs
        .map(|log| {
            let seed = log.file_name().unwrap().to_str().unwrap().trim_start_matches("seed-").parse::<u32>().unwrap();
            Outcome::collect(&nets, &[(seed, log)]).unwrap()
        })
        .collect::<Vec<_>>();
    runs.sort_by_key(Outcome::seeds);
    let settings = Settings::default();
    let mut state = 1_u64;
    let mut below = |bound: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % bound
    };
    let mut alarms = 0;
    for _ in 0..TRIALS {
        for place in 0..2 * SEEDS {
            let other = place + below(runs.len() - place);
            runs.swap(place, other);
        }
        let (expected, found) = (together(&runs[..SEEDS]), together(&runs[SEEDS..2 * SEEDS]));
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
