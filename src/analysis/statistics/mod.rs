//! Near-miss statistics of one or many runs: counts and rates, quantiles, hot spots, the worst conflicts, crash
//! frequencies, and the comparison of two sets of runs.
//!
//! One pass over the logs fills a [`Collection`]; all statistics come from it. docs/statistics.md states each estimator
//! and test with its source.

mod collect;
mod compare;
mod extremes;
mod gpd;
mod group;
mod hot_spots;
pub(crate) mod permutation;
mod quantiles;
mod rate;
pub mod table;
mod worst;

use std::path::PathBuf;

use serde::Serialize;

use super::logged::LoggedRun;
use crate::{Error, Result};
use hot_spots::hot_spots;

pub use collect::{Collection, LeftOutLog, MEASURES};
pub use compare::{Comparison, Significance, compare};
pub use extremes::{Crashes, Extrapolation};
pub use group::By;
pub use hot_spots::HotSpot;
pub use permutation::Test;
pub use quantiles::{Quantiles, quantile};
pub use rate::{IntervalMethod, Rate, Ratio, rate};
pub use worst::RankedConflict;

/// The statistics that are asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Log folders, or folders that contain log folders.
    pub folders: Vec<PathBuf>,
    /// How conflicts are grouped.
    pub by: By,
    /// The runs to compare with; empty for no comparison.
    pub against: Vec<PathBuf>,
    /// The number of worst conflicts, and of hot spots, to list.
    pub worst: usize,
}

/// Statistics of a set of runs.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// The number of runs.
    pub runs: usize,
    /// The traffic of all runs.
    pub traffic: Traffic,
    /// Logs that were not counted, were counted in part, or repeat another.
    pub left_out: Vec<LeftOutLog>,
    /// How conflicts are grouped.
    pub by: By,
    /// All conflicts as one group, then each group.
    pub groups: Vec<GroupStatistics>,
    /// Edges with the most conflicts.
    pub edges: Vec<HotSpot>,
    /// Junctions with the most conflicts.
    pub junctions: Vec<HotSpot>,
    /// The worst conflicts, the worst first.
    pub worst: Vec<RankedConflict>,
    /// Crash frequencies by extreme value theory.
    pub extremes: Vec<Extrapolation>,
    /// The comparison with the other set, if there is one.
    pub comparison: Option<Comparison>,
}

/// The traffic of a set of runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Traffic {
    /// Simulated hours.
    pub hours: f64,
    /// The number of vehicles.
    pub vehicles: u64,
    /// The number of persons.
    pub persons: u64,
    /// The distance that all vehicles travelled, in km.
    pub vehicle_kilometres: f64,
    /// The time that all vehicles spent, in h.
    pub vehicle_hours: f64,
}

/// Rates of conflicts per unit of traffic; none if there was no traffic of that unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rates {
    /// Per simulated hour.
    pub per_hour: Option<Rate>,
    /// Per vehicle-kilometre.
    pub per_vehicle_kilometre: Option<Rate>,
    /// Per 1,000 vehicles.
    pub per_1000_vehicles: Option<Rate>,
}

/// Statistics of a group of conflicts.
#[derive(Clone, Debug, Serialize)]
pub struct GroupStatistics {
    /// The name of the group; `all` for all conflicts.
    pub group: String,
    /// The number of conflicts.
    pub count: u64,
    /// The number of conflicts in which the rectangles overlapped.
    pub collisions: u64,
    /// The rates.
    #[serde(flatten)]
    pub rates: Rates,
    /// Time to collision, in s.
    pub ttc: Quantiles,
    /// Post-encroachment time, in s.
    pub pet: Quantiles,
    /// gap − μ, in m.
    pub margin: Quantiles,
    /// Speed change in a collision, in m/s.
    pub delta_v: Quantiles,
}

impl Statistics {
    /// Reads the logs and computes their statistics.
    ///
    /// # Errors
    /// Those of [`Collection::read`]; [`Error::Value`] if no folder is named.
    pub fn of(request: &Request) -> Result<Self> {
        if request.folders.is_empty() {
            return Err(Error::Value("no log folder is named".to_owned()));
        }
        let mut set = Collection::read(&request.folders, request.by, request.worst)?;
        let mut left_out = std::mem::take(&mut set.left_out);
        let comparison = if request.against.is_empty() {
            None
        } else {
            let mut other = Collection::read(&request.against, request.by, 0)?;
            left_out.append(&mut other.left_out);
            Some(compare(&set, &other))
        };
        let hours = set.runs.iter().map(LoggedRun::hours).sum();
        Ok(Self {
            runs: set.runs.len(),
            traffic: traffic(&set.runs, hours),
            left_out,
            by: request.by,
            edges: hot_spots(&set, &set.edges, request.worst),
            junctions: hot_spots(&set, &set.junctions, request.worst),
            extremes: set.tails.extrapolate(hours),
            comparison,
            groups: groups(&mut set, request.by),
            worst: set.worst.into_sorted(&set.runs),
        })
    }
}

fn traffic(runs: &[LoggedRun], hours: f64) -> Traffic {
    let mut traffic = Traffic { hours, ..Traffic::default() };
    for exposure in runs.iter().map(|run| run.summary.exposure) {
        traffic.vehicles += exposure.vehicles;
        traffic.persons += exposure.persons;
        traffic.vehicle_kilometres += exposure.vehicle_kilometres;
        traffic.vehicle_hours += exposure.vehicle_hours;
    }
    traffic
}

fn rates(counts: &[f64], runs: &[LoggedRun]) -> Rates {
    let per = |traffic: fn(&LoggedRun) -> f64| rate(counts, &runs.iter().map(traffic).collect::<Vec<_>>());
    Rates {
        per_hour: per(LoggedRun::hours),
        per_vehicle_kilometre: per(|run| run.summary.exposure.vehicle_kilometres),
        per_1000_vehicles: per(|run| run.summary.exposure.vehicles as f64 / 1000.0),
    }
}

fn groups(set: &mut Collection, by: By) -> Vec<GroupStatistics> {
    let all = (0..MEASURES.len()).map(|measure| Quantiles::of_sorted(&set.sorted(measure))).collect::<Vec<_>>();
    let counts = set.counts(None, None);
    let mut found = vec![group_statistics(
        "all".to_owned(),
        counts.iter().sum::<f64>() as u64,
        set.groups.values().map(|group| group.collisions).sum(),
        rates(&counts, &set.runs),
        &all,
    )];
    for (name, mut group) in std::mem::take(&mut set.groups) {
        let quantiles = group.columns.iter_mut().map(|values| {
            values.sort_unstable_by(f64::total_cmp);
            Quantiles::of_sorted(values)
        });
        let quantiles = quantiles.collect::<Vec<_>>();
        let rates = rates(&group.counts.per_run(set.runs.len()), &set.runs);
        found.push(group_statistics(name, group.counts.sum(), group.collisions, rates, &quantiles));
    }
    by.sort(&mut found[1..], |group| &group.group, |group| group.count);
    found
}

fn group_statistics(
    group: String,
    count: u64,
    collisions: u64,
    rates: Rates,
    quantiles: &[Quantiles],
) -> GroupStatistics {
    let of = |name: &str| {
        MEASURES.iter().position(|measure| *measure == name).map_or_else(Default::default, |at| quantiles[at])
    };
    let ttc = of("ttc");
    let pet = of("pet");
    let margin = of("margin");
    let delta_v = of("delta_v");
    GroupStatistics { group, count, collisions, rates, ttc, pet, margin, delta_v }
}
