//! The values of options with a choice.

use serde::Serialize;

/// The method that finds the conflicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
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
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
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
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Deceleration {
    /// `emergencyDecel`, its maximum.
    #[default]
    Emergency,
    /// `decel`, that of ordinary driving.
    Decel,
}
