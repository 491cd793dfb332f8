//! The inputs of the braking model, and the models of μ.

use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Second};

/// How one road user brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brakes {
    /// Response time t1 + t2 in s, at full speed.
    pub response: Second,
    /// Build-up time t3 in s, in which the deceleration rises linearly.
    pub build_up: Second,
    /// Deceleration after the build-up, in m/s²; above 0.
    pub deceleration: MetrePerSecondSquared,
}

impl Brakes {
    /// The same brakes in the paper's worst case: fully applied at once.
    pub fn at_once(&self) -> Self {
        Self { response: 0.0, build_up: 0.0, ..*self }
    }
}

/// A model of the minimal collision distance μ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum MuModel {
    /// The closest approach while braking.
    #[default]
    Minimal,
    /// The room once both have stopped.
    #[cfg_attr(feature = "clap", value(alias = "at_rest"))]
    AtRest,
    /// Eq. 19 and 21 as printed: always a minus sign, no floor.
    Paper,
    /// The safe distance of RSS, whatever the brakes.
    Rss,
}

impl MuModel {
    /// The models that follow from the brakes of both, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Minimal, Self::AtRest, Self::Paper];
}

/// One road user's part in μ: its speed in m/s, 0 or more, and its brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking<'a> {
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// Its brakes.
    pub brakes: &'a Brakes,
}
