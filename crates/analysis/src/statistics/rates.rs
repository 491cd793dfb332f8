//! The traffic of runs, and the rates of conflicts in it.

use serde::Serialize;

use super::rate::{Rate, rate};
use crate::logged::LoggedRun;

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rates {
    /// Per simulated hour.
    pub per_hour: Option<Rate>,
    /// Per vehicle-kilometre.
    pub per_vehicle_kilometre: Option<Rate>,
    /// Per 1,000 vehicles.
    pub per_1000_vehicles: Option<Rate>,
}

impl Traffic {
    /// The traffic of these runs together.
    pub fn of<'a>(runs: impl Iterator<Item = &'a LoggedRun>) -> Self {
        let mut traffic = Self::default();
        for run in runs {
            let exposure = run.summary.exposure;
            traffic.hours += run.hours();
            traffic.vehicles += exposure.vehicles;
            traffic.persons += exposure.persons;
            traffic.vehicle_kilometres += exposure.vehicle_kilometres;
            traffic.vehicle_hours += exposure.vehicle_hours;
        }
        traffic
    }
}

impl Rates {
    /// The rates of conflicts with these counts per run.
    pub fn of(counts: &[f64], runs: &[&LoggedRun]) -> Self {
        let per =
            |traffic: fn(&LoggedRun) -> f64| rate(counts, &runs.iter().map(|run| traffic(run)).collect::<Vec<_>>());
        Self {
            per_hour: per(LoggedRun::hours),
            per_vehicle_kilometre: per(|run| run.summary.exposure.vehicle_kilometres),
            per_1000_vehicles: per(|run| run.summary.exposure.vehicles as f64 / 1000.0),
        }
    }
}
