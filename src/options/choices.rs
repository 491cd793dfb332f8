//! What an option may be where it is one of several.

use serde::Serialize;

/// The method that finds the conflicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// closecall's own method: paths, conflict points and the corrected μ.
    #[default]
    Closecall,
    /// The paper's flow chart as printed (Guan et al. 2008, fig. 5), for comparison.
    Paper,
}

/// The path that a road user is expected to take while it brakes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum PathModel {
    /// Along the lanes of its route; needs a net.
    #[default]
    Lanes,
    /// On a circle with its current curvature.
    Arc,
    /// Straight on along its heading.
    Straight,
    /// Where it really drove afterwards: only a recording knows.
    Driven,
}

/// The deceleration of SUMO's vehicle type that a vehicle brakes with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Deceleration {
    /// `emergencyDecel`, its maximum.
    #[default]
    Emergency,
    /// `decel`, that of ordinary driving.
    Decel,
}

/// How the file with each step of each conflict is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum SeriesFormat {
    /// As text, while the run goes on.
    Csv,
    /// As Parquet, when the run ends.
    #[cfg(feature = "parquet")]
    Parquet,
}

/// The file with each step of each conflict.
pub(super) const SERIES: &str = "series.csv";
/// The same as Parquet.
pub(super) const SERIES_PARQUET: &str = "series.parquet";
/// The same where it is asked for by the option's former name.
pub(super) const ENCOUNTERS: &str = "encounters.csv";
/// All of these.
pub const SERIES_FILES: [&str; 3] = [SERIES, SERIES_PARQUET, ENCOUNTERS];
