//! Hot spots: the edges and junctions with the largest risk index.

use rustc_hash::FxHashMap;
use serde::Serialize;

use super::collect::Collection;
use super::counts::Spot;
use super::rate::Rate;
use super::rates::Rates;
use crate::logged::LoggedRun;

/// An edge or junction with conflicts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HotSpot {
    /// SUMO's id of the edge or junction.
    pub id: String,
    /// The number of conflicts.
    pub count: u64,
    /// The number of serious ones.
    pub serious: u64,
    /// The number of critical ones.
    pub critical: u64,
    /// The sum of the crash probabilities: compares places; not a number of crashes.
    pub risk_index: Option<Rate>,
    /// The same per 1,000 vehicles that entered; of junctions, where all runs have counted them.
    pub risk_index_per_1000_entering: Option<Rate>,
    /// Per simulated hour.
    pub per_hour: Option<Rate>,
    /// Per 1,000 vehicles of the run.
    pub per_1000_vehicles: Option<Rate>,
}

/// The edges with the largest risk index, at most `wanted`.
pub(super) fn edges(set: &Collection, wanted: usize) -> Vec<HotSpot> {
    hot_spots(set, &set.edges, wanted, |_| None)
}

/// The junctions with the largest risk index, at most `wanted`.
pub(super) fn junctions(set: &Collection, wanted: usize) -> Vec<HotSpot> {
    // A run of an earlier version has no such counts.
    let are_known = set.runs.iter().all(|run| !run.summary.entered.is_empty());
    let of_run = |id: &str, run: &LoggedRun| run.summary.entered.get(id).map_or(0.0, |entered| *entered as f64);
    let entered = |id: &str| set.runs.iter().map(|run| of_run(id, run) / 1000.0).collect();
    hot_spots(set, &set.junctions, wanted, |id| are_known.then(|| entered(id)))
}

/// The `wanted` spots with the largest risk index, the most first; equal ones by their conflicts, then by id. `entered`
/// tells how many thousand vehicles entered a spot in each run.
fn hot_spots(
    set: &Collection,
    spots: &FxHashMap<String, Spot>,
    wanted: usize,
    entered: impl Fn(&str) -> Option<Vec<f64>>,
) -> Vec<HotSpot> {
    let mut spots = spots.iter().map(|(id, spot)| (spot.counts.sum(), id, spot)).collect::<Vec<_>>();
    spots.sort_by(|a, b| b.2.crashes.sum().total_cmp(&a.2.crashes.sum()).then_with(|| (b.0, a.1).cmp(&(a.0, b.1))));
    spots.truncate(wanted);
    let statistics = |(count, id, spot): (u64, &String, &Spot)| {
        // Runs that differ in their settings have no common rate.
        let (rates, risk_index, per_1000_entering) = match &set.variants.all[..] {
            [only] => (
                Rates::of(&spot.counts.of(&only.runs), &set.members(only)),
                spot.crashes.interval(set.runs.len()),
                entered(id).and_then(|entered| spot.crashes.rate(&entered)),
            ),
            _ => (Rates::default(), None, None),
        };
        let [_, serious, critical] = spot.severities;
        HotSpot {
            id: id.clone(),
            count,
            serious,
            critical,
            risk_index,
            risk_index_per_1000_entering: per_1000_entering,
            per_hour: rates.per_hour,
            per_1000_vehicles: rates.per_1000_vehicles,
        }
    };
    spots.into_iter().map(statistics).collect()
}
