//! How deep an overlap of rectangles is a collision: SUMO's own collisions against those of a replay.

use std::fs;
use std::path::Path;

use rustc_hash::FxHashSet;

use super::clock::median;
use super::driven::{IdPair, ordered};
use super::measurement::{Axis, Measurement, Plan, Recorder};
use super::recorded::{RecordedScenario, collisions_file, measure_each, share_without};
use closecall::options::Options;
use closecall::util::units::Metre;
use closecall_run::{Error, Result};

/// Scenarios with collisions; a quick study uses the first.
const NETS: [&str; 2] = ["reckless", "crowd"];
const TOLERANCES: [Metre; 7] = [0.0, 0.05, 0.1, DEFAULT, 0.5, 1.0, 1.5];
/// Its source is in docs/model.md.
const DEFAULT: Metre = 0.25;

pub(super) fn measure(plan: &Plan, record: &mut Recorder) -> Result<Vec<Measurement>> {
    let (nets, end, rounds) = if plan.quick { (&NETS[..1], 100.0, 3) } else { (&NETS[..], 240.0, 5) };
    measure_each(plan, nets, end, record, |scenario, _| measure_net(&scenario, rounds))
}

fn measure_net(scenario: &RecordedScenario, rounds: usize) -> Result<Vec<Measurement>> {
    let of_sumo = collisions_of_sumo(&collisions_file(&scenario.recording))?;
    let mut found = vec![FxHashSet::default(); TOLERANCES.len()];
    let mut times = vec![Vec::new(); TOLERANCES.len()];
    let mut items = 0;
    for _ in 0..rounds {
        for (index, contact_tolerance) in TOLERANCES.into_iter().enumerate() {
            let options = Options { contact_tolerance, ..Options::default() };
            let timed = scenario.replay(&scenario.recording, &options, &mut |_| {})?;
            items = timed.rows;
            times[index].push(timed.lasts * 1e9 / items.max(1) as f64);
            let colliding = timed.conflicts.into_iter().filter(|conflict| conflict.collision);
            found[index] = colliding.map(|conflict| ordered(conflict.ego, conflict.foe)).collect();
        }
    }
    let row = |(index, tolerance): (usize, Metre)| {
        let all = found[index].union(&of_sumo).count();
        let differ = found[index].symmetric_difference(&of_sumo).count();
        Measurement {
            axis: Axis::Tolerance,
            method: "contact tolerance",
            parameter: format!("{}, {tolerance} m", scenario.name),
            error_name: "share of colliding pairs missed or invented",
            error: differ as f64 / all.max(1) as f64,
            false_negative_rate: share_without(&of_sumo, &found[index]),
            false_positive_rate: share_without(&found[index], &of_sumo),
            ns_per_item: median(&mut times[index].clone()),
            items,
            on_pareto_front: false,
            scene: scenario.name.to_owned(),
            default: tolerance == DEFAULT,
        }
    };
    Ok(TOLERANCES.into_iter().enumerate().map(row).collect())
}

/// The pairs in SUMO's collision-output.
fn collisions_of_sumo(file: &Path) -> Result<FxHashSet<IdPair>> {
    let text = fs::read_to_string(file).map_err(|source| Error::file(file, source))?;
    let of = |line: &str, name: &str| line.split(name).nth(1).and_then(|rest| rest.split('"').next()).map(Into::into);
    let pairs = text.lines().filter_map(|line| Some(ordered(of(line, " collider=\"")?, of(line, " victim=\"")?)));
    Ok(pairs.collect())
}
