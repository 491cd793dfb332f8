//! Near-miss statistics of one or many runs: counts and rates, quantiles, hot spots, the worst conflicts, crash
//! frequencies, and the comparison of two sets of runs.
//!
//! One pass over the logs fills a [`Collection`]; all statistics come from it. docs/statistics_how.md states each
//! estimator and test with its source.

mod chosen;
mod collect;
mod compare;
mod counts;
mod effects;
pub mod extremes;
pub mod gpd;
mod gpd_posterior;
mod group;
mod hot_spots;
mod observed;
mod of_run;
mod pairs;
pub mod permutation;
pub mod planning;
mod quantiles;
pub mod rate;
mod rates;
pub(crate) mod share;
pub mod table;
mod together;
mod variant;
pub mod weighted;
mod worst;

use std::path::PathBuf;

use serde::Serialize;

use super::filter::ConflictFilter;
use super::logged::{LoggedRun, LostRows, Progress};
use crate::{Error, Result};
use closecall_run::output::summary::SetAside;

pub use chosen::LeftOutLog;
pub use collect::Collection;
pub use compare::{Comparison, Significance, compare};
pub use effects::Effects;
pub use extremes::{Crashes, Extrapolation};
pub use group::By;
pub use hot_spots::HotSpot;
pub use observed::{Observed, PerYear, Transferred};
pub use permutation::Test;
pub use planning::{PlannedGroup, RunPlan};
pub use quantiles::{Quantiles, quantile};
pub use rate::{IntervalMethod, Rate, Ratio, rate, t_quantile};
pub use rates::Traffic;
pub use variant::{GroupStatistics, VariantStatistics};
pub use worst::{RankedConflict, quoted};

/// The statistics that are asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Log folders, or folders that contain log folders.
    pub folders: Vec<PathBuf>,
    /// How conflicts are grouped.
    pub by: By,
    /// The runs to compare with; empty for no comparison.
    pub against: Vec<PathBuf>,
    /// Which conflicts count.
    pub filter: ConflictFilter,
    /// The number of worst conflicts, and of hot spots, to list.
    pub worst: usize,
    /// The ratio of rates for which runs are to be planned.
    pub plan: Option<f64>,
    /// The crashes observed in reality for the runs to compare with.
    pub observed: Option<Observed>,
}

/// Statistics of a set of runs.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// The scenario's name.
    #[serde(skip)]
    pub name: String,
    /// The number of runs.
    pub runs: usize,
    /// The traffic of all runs.
    pub traffic: Traffic,
    /// The settings in which the runs differ, besides the seed.
    pub varied: Vec<String>,
    /// The variants: runs that agree in all settings. Each has rates of its own.
    pub variants: Vec<VariantStatistics>,
    /// What the reader should know about the variants.
    pub notes: Vec<String>,
    /// Logs that were not counted, were counted in part, or repeat another.
    pub left_out: Vec<LeftOutLog>,
    /// The logs that lack rows, whose other rows count.
    #[serde(skip)]
    pub lost: Vec<LostRows>,
    /// The conflicts that are none of traffic's, and are not counted.
    pub set_aside: SetAside,
    /// Which conflicts count, as the words of a command line; none for all.
    pub filter: Option<String>,
    /// How conflicts are grouped.
    pub by: By,
    /// For each variant all conflicts as one group, then each group.
    pub groups: Vec<GroupStatistics>,
    /// The sum of crash probabilities per vehicle-kilometre, of runs of one variant: compares plans with the same steps; not a
    /// number of crashes.
    pub risk_index_per_vehicle_kilometre: Option<Rate>,
    /// Edges with the largest risk index.
    pub edges: Vec<HotSpot>,
    /// Junctions with the largest risk index.
    pub junctions: Vec<HotSpot>,
    /// The worst conflicts, the worst first.
    pub worst: Vec<RankedConflict>,
    /// Crash frequencies by extreme value theory.
    pub extremes: Vec<Extrapolation>,
    /// The comparison with the other set, if there is one.
    pub comparison: Option<Comparison>,
    /// The runs that a comparison needs, if it was asked.
    pub plan: Option<RunPlan>,
    /// The crashes to be expected, from observed ones; none where the ratio of conflicts has no finite interval.
    pub transferred: Option<Transferred>,
}

impl Statistics {
    /// Reads the logs and computes their statistics. It reports to `progress` how far it has read.
    ///
    /// # Errors
    /// Those of [`Collection::read`]; [`Error::NoLog`] if no folder is named, or if runs of one set that is compared with
    /// another differ in their settings.
    pub fn of(request: &Request, progress: &mut Progress) -> Result<Self> {
        if request.folders.is_empty() {
            return Err(Error::NoLog);
        }
        request.filter.check()?;
        if request.by == By::Place && request.filter.named.is_none() {
            return Err(Error::Value("--by place needs a file of --places".to_owned()));
        }
        let mut set = Collection::read(&request.folders, request.by, &request.filter, request.worst, progress)?;
        let mut left_out = std::mem::take(&mut set.left_out);
        let mut lost = std::mem::take(&mut set.lost);
        let mut plan = None;
        let comparison = if request.against.is_empty() {
            if let Some(ratio) = request.plan {
                set.check_alike(&request.folders)?;
                plan = Some(planning::plan(ratio, &set, None));
            }
            None
        } else {
            let mut other = Collection::read(&request.against, request.by, &request.filter, 0, progress)?;
            left_out.append(&mut other.left_out);
            lost.append(&mut other.lost);
            set.check_alike(&request.folders)?;
            other.check_alike(&request.against)?;
            plan = request.plan.map(|ratio| planning::plan(ratio, &set, Some(&other)));
            Some(compare(&set, &other))
        };
        let ratio = comparison.as_ref().and_then(|comparison| comparison.rates.first()?.ratio);
        let transferred =
            request.observed.zip(ratio).and_then(|(observed, ratio)| observed::transfer(observed, &ratio));
        let traffic = Traffic::of(set.runs.iter());
        let hours = if set.variants.are_several() {
            Err("the runs differ in their settings: name those of one variant")
        } else {
            Ok(traffic.hours)
        };
        let variants = set.variants.clone();
        let kilometres = set.runs.iter().map(|run| run.summary.exposure.vehicle_kilometres).collect::<Vec<_>>();
        Ok(Self {
            name: set.runs.first().map_or_else(|| "closecall".to_owned(), LoggedRun::name),
            runs: set.runs.len(),
            traffic,
            varied: variants.varied.clone(),
            variants: variant::statistics(&set),
            notes: variants.notes.iter().cloned().chain(set.filtered(&request.filter)).collect(),
            left_out,
            lost,
            set_aside: std::mem::take(&mut set.set_aside),
            filter: (!request.filter.is_empty()).then(|| request.filter.to_string()),
            by: request.by,
            risk_index_per_vehicle_kilometre: set.risk.rate(&kilometres).filter(|_| !variants.are_several()),
            edges: hot_spots::edges(&set, request.worst),
            junctions: hot_spots::junctions(&set, request.worst),
            extremes: set.tails.extrapolate(hours),
            comparison,
            plan,
            transferred,
            groups: variant::groups(&mut set, request.by),
            worst: set.worst.into_sorted(&set.runs, &variants),
        })
    }
}
