//! Near-miss statistics of one or many runs: counts and rates, quantiles, hot spots, the worst conflicts, crash
//! frequencies, and the comparison of two sets of runs.
//!
//! One pass over the logs ([`Collection`]), then everything from what it kept. docs/statistics.md states each
//! estimator and test with its source.

mod collect;
mod compare;
mod extremes;
mod gpd;
mod group;
pub(crate) mod permutation;
mod quantiles;
mod rate;
pub mod table;
mod worst;

use std::path::PathBuf;

use serde::Serialize;

use super::logged::LoggedRun;
use crate::{Error, Result};

pub use collect::{Collection, Columns, Counts, Group, LeftOutLog, MEASURES, Spot};
pub use compare::{Comparison, MeasureDifference, RateDifference, Significance, compare};
pub use extremes::{Crashes, Extrapolation, Tails, crashes};
pub use gpd::Gpd;
pub use group::By;
pub use permutation::Test;
pub use quantiles::{Quantiles, cliffs_delta, quantile};
pub use rate::{Method, Rate, Ratio, rate, rate_ratio};
pub use worst::{Worst, WorstOf};

/// What statistics are wanted.
#[derive(Clone, Debug)]
pub struct Request {
    /// Log folders, or folders that hold some.
    pub folders: Vec<PathBuf>,
    /// By what conflicts are grouped.
    pub by: By,
    /// The set of runs to hold these against.
    pub against: Vec<PathBuf>,
    /// How many of the worst conflicts, and of the hot spots, are listed.
    pub worst: usize,
}

/// Statistics of a set of runs.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// How many runs.
    pub runs: usize,
    /// How much traffic they had.
    pub traffic: Traffic,
    /// Logs that were not counted, or only in part.
    pub left_out: Vec<LeftOutLog>,
    /// By what conflicts are grouped.
    pub by: By,
    /// All conflicts, then each group.
    pub groups: Vec<GroupStatistics>,
    /// Edges with the most conflicts.
    pub edges: Vec<HotSpot>,
    /// Junctions with the most conflicts.
    pub junctions: Vec<HotSpot>,
    /// The worst conflicts, the worst first.
    pub worst: Vec<Worst>,
    /// Crash frequencies by extreme value theory.
    pub extremes: Vec<Extrapolation>,
    /// How this set differs from the other, if there is one.
    pub comparison: Option<Comparison>,
}

/// How much traffic a set of runs had.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Traffic {
    /// Simulated hours.
    pub hours: f64,
    /// Vehicles.
    pub vehicles: u64,
    /// Persons.
    pub persons: u64,
    /// Way of all vehicles, in km.
    pub vehicle_kilometres: f64,
    /// Time of all vehicles, in h.
    pub vehicle_hours: f64,
}

/// Rates of conflicts per unit of traffic; none where there was none.
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
    /// The group; `all` is all of them.
    pub group: String,
    /// How many conflicts.
    pub count: u64,
    /// In how many the rectangles overlapped.
    pub collisions: u64,
    /// How often.
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

/// A place with conflicts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HotSpot {
    /// SUMO's id of the edge or junction.
    pub id: String,
    /// How many conflicts.
    pub count: u64,
    /// How many of them serious.
    pub serious: u64,
    /// How many critical.
    pub critical: u64,
    /// Per simulated hour.
    pub per_hour: Option<Rate>,
    /// Per 1,000 vehicles of the run.
    pub per_1000_vehicles: Option<Rate>,
}

impl Statistics {
    /// Reads the logs and computes.
    ///
    /// # Errors
    /// As [`Collection::read`] has them; [`Error::Value`] where no folder is named.
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
    let (ttc, pet, margin, delta_v) = (of("ttc"), of("pet"), of("margin"), of("delta_v"));
    GroupStatistics { group, count, collisions, rates, ttc, pet, margin, delta_v }
}

fn hot_spots(set: &Collection, spots: &rustc_hash::FxHashMap<String, Spot>, wanted: usize) -> Vec<HotSpot> {
    let mut spots = spots.iter().map(|(id, spot)| (spot.counts.sum(), id, spot)).collect::<Vec<_>>();
    spots.sort_by(|a, b| (b.0, a.1).cmp(&(a.0, b.1)));
    spots.truncate(wanted);
    let statistics = |(count, id, spot): (u64, &String, &Spot)| {
        let rates = rates(&spot.counts.per_run(set.runs.len()), &set.runs);
        let [_, serious, critical] = spot.severities;
        HotSpot {
            id: id.clone(),
            count,
            serious,
            critical,
            per_hour: rates.per_hour,
            per_1000_vehicles: rates.per_1000_vehicles,
        }
    };
    spots.into_iter().map(statistics).collect()
}
