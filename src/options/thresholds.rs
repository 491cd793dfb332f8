//! The bounds between the kinds and the severities of conflicts.

use super::Options;
use crate::util::units::{MetrePerSecondSquared, Radian, Second};

/// The angles at the conflict point that separate the kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KindBounds {
    /// Rear-end below this angle.
    pub rear_end_below: Radian,
    /// Frontal above this angle.
    pub frontal_above: Radian,
}

/// The values beyond which a conflict is serious.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeverityThresholds {
    /// Serious below this TTC.
    pub serious_ttc: Second,
    /// Serious above this DRAC.
    pub serious_drac: MetrePerSecondSquared,
}

impl Options {
    /// The bounds between the kinds.
    pub fn kind_bounds(&self) -> KindBounds {
        KindBounds { rear_end_below: self.rear_end_below, frontal_above: self.frontal_above }
    }

    /// The thresholds of severity.
    pub fn severity_thresholds(&self) -> SeverityThresholds {
        SeverityThresholds { serious_ttc: self.serious_ttc, serious_drac: self.serious_drac }
    }
}
