//! The bounds between the kinds and the severities of conflicts.

use super::Options;
use super::severity_rule::SeverityRule;
use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Probability, Radian, Second};

/// The angles at the conflict point that separate the kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KindBounds {
    /// Rear-end below this angle.
    pub rear_end_below: Radian,
    /// Frontal above this angle.
    pub frontal_above: Radian,
}

/// When a conflict is serious or critical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeverityThresholds {
    /// By the table of nearness and consequence: `detection::severity`.
    Levels,
    /// Serious if both are reached; critical if even braking at once is too late.
    TimeLeft {
        /// The crash probability.
        probability: Probability,
        /// The larger ΔV of both at their present speeds.
        delta_v: MetrePerSecond,
    },
    /// Serious beyond thresholds; critical if DRAC is above the ego's braking deceleration.
    Measures {
        /// Serious below this TTC.
        ttc: Second,
        /// Serious above this DRAC.
        drac: MetrePerSecondSquared,
    },
}

impl Options {
    /// The bounds between the kinds.
    pub(crate) fn kind_bounds(&self) -> KindBounds {
        KindBounds { rear_end_below: self.rear_end_below, frontal_above: self.frontal_above }
    }

    /// The thresholds of severity.
    pub(crate) fn severity_thresholds(&self) -> SeverityThresholds {
        match self.severity_rule {
            SeverityRule::Levels => SeverityThresholds::Levels,
            SeverityRule::TimeLeft => {
                SeverityThresholds::TimeLeft { probability: self.serious_probability, delta_v: self.serious_delta_v }
            }
            SeverityRule::Fhwa => SeverityThresholds::Measures { ttc: self.serious_ttc, drac: self.serious_drac },
            SeverityRule::Ssm => SeverityThresholds::Measures { ttc: 3.0, drac: 3.0 },
        }
    }
}
