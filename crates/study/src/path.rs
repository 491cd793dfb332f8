//! Path prediction: the paper's rule and three path models on recorded runs, against the paths that followed.

use rustc_hash::FxHashMap;

use super::clock::median;
use super::driven::{DrivenTraces, IdPair, Truth};
use super::measurement::{Axis, Measurement, Plan, Recorder};
use super::recorded::{GapsByStep, ROUNDING, RecordedScenario, conflicts, measure_each};
use closecall::options::{Mode, Options, PathModel};
use closecall::util::units::Metre;
use closecall_run::Result;

const DEFAULT: &str = "lanes";
const METHODS: [(&str, Mode, PathModel); 4] = [
    ("paper", Mode::Paper, PathModel::Straight),
    ("straight", Mode::Closecall, PathModel::Straight),
    ("arc", Mode::Closecall, PathModel::Arc),
    (DEFAULT, Mode::Closecall, PathModel::Lanes),
];
/// Scenarios with bends, crossings and oncoming traffic; a quick study uses the first three.
const NETS: [&str; 6] = ["curves", "priority", "left_turn", "roundabout", "signals", "overtaking"];
/// One of this many steps of 0.1 s is compared; those in between differ little.
const EVERY: u64 = 10;

pub(super) fn measure(plan: &Plan, record: &mut Recorder) -> Result<Vec<Measurement>> {
    let (nets, end, rounds) = if plan.quick { (&NETS[..3], 100.0, 3) } else { (&NETS[..], 300.0, 5) };
    measure_each(plan, nets, end, record, |scenario, _| {
        let driven = DrivenTraces::read(&scenario.recording)?;
        DrivenScenario { scenario, driven }.measure(rounds)
    })
}

/// A recorded run, and what was really driven in it.
struct DrivenScenario {
    scenario: RecordedScenario,
    driven: DrivenTraces,
}

impl DrivenScenario {
    fn measure(&self, rounds: usize) -> Result<Vec<Measurement>> {
        let mut times = vec![Vec::new(); METHODS.len()];
        let mut found = vec![GapsByStep::new(); METHODS.len()];
        let mut truth = Vec::new();
        let mut items = 0;
        for round in 0..rounds {
            for (index, (_, mode, path)) in METHODS.into_iter().enumerate() {
                let options = Options { mode, path, ..Options::default() };
                let mut steps = 0_u64;
                let timed = self.scenario.replay(&self.scenario.recording, &options, &mut |run| {
                    steps += 1;
                    if round == 0 && steps.is_multiple_of(EVERY) {
                        found[index].push(conflicts(run));
                        if index == 0 {
                            truth.push(self.driven.truth(&run.frame, &run.roster, &options));
                        }
                    }
                })?;
                items = timed.rows;
                times[index].push(timed.lasts * 1e9 / timed.rows.max(1) as f64);
            }
        }
        let mut measured = Vec::new();
        for (((name, ..), found), times) in METHODS.iter().zip(&found).zip(&mut times) {
            let score = Score::of(found, &truth);
            let ns_per_item = median(times);
            let errors = [
                ("share of conflicts missed or invented", score.wrong(), self.scenario.name.to_owned()),
                ("median error of the gap, m", score.gap_error, format!("{}, gap", self.scenario.name)),
            ];
            // The gap can only be compared for conflicts that were found.
            let errors = errors.into_iter().take(if score.right > 0 { 2 } else { 1 });
            measured.extend(errors.map(|(error_name, error, scene)| Measurement {
                axis: Axis::Path,
                method: name,
                parameter: self.scenario.name.to_owned(),
                error_name,
                error,
                false_negative_rate: score.missed as f64 / (score.right + score.missed).max(1) as f64,
                false_positive_rate: score.invented as f64 / (score.right + score.invented).max(1) as f64,
                ns_per_item,
                items,
                on_pareto_front: false,
                scene,
                default: *name == DEFAULT,
            }));
        }
        Ok(measured)
    }
}

/// A method's results against the truth.
struct Score {
    right: usize,
    missed: usize,
    invented: usize,
    gap_error: Metre,
}

impl Score {
    fn of(found: &GapsByStep, truth: &[FxHashMap<IdPair, Truth>]) -> Self {
        let mut right = 0;
        let mut missed = 0;
        let mut invented = 0;
        let mut gaps = Vec::new();
        for (found, truth) in found.iter().zip(truth) {
            for (pair, truth) in truth {
                match (truth, found.get(pair)) {
                    (Truth::Conflict(gap), Some(found)) => {
                        right += 1;
                        let off = (gap - found).abs();
                        gaps.push(if off < ROUNDING { 0.0 } else { off });
                    }
                    (Truth::Conflict(_), None) => missed += 1,
                    (Truth::None, Some(_)) => invented += 1,
                    (Truth::None, None) | (Truth::Unknown, _) => {}
                }
            }
        }
        let gap_error = if gaps.is_empty() { 0.0 } else { median(&mut gaps) };
        Self { right, missed, invented, gap_error }
    }

    /// The share of all true or reported conflicts that were missed or invented.
    fn wrong(&self) -> f64 {
        (self.missed + self.invented) as f64 / (self.right + self.missed + self.invented).max(1) as f64
    }
}
