//! How a road user brakes.

use crate::units::{MetrePerSecondSquared, Second};

/// How one road user brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brakes {
    /// Response time t1 + t2 in s: full speed until it is over.
    pub response: Second,
    /// Build-up time t3 in s, in which the deceleration rises linearly.
    pub build_up: Second,
    /// Deceleration in m/s² from then on.
    pub deceleration: MetrePerSecondSquared,
}

/// Which model of μ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MuModel {
    /// The narrowest moment on the way to rest.
    Minimal,
    /// Both at rest.
    AtRest,
    /// Eq. 19 and 21 as printed.
    Paper,
}
