//! The bounds between the kinds and the severities of conflicts.

use super::Options;
use super::defaults::{SERIOUS_DELTA_V, SERIOUS_DRAC, SERIOUS_PROBABILITY, SERIOUS_TTC};
use super::severity_rule::SeverityRule;
use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Probability, Radian, Second};
use crate::{Error, Result};

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

    /// Checks that no threshold is set that the rule of the severity does not ask for.
    ///
    /// # Errors
    /// [`Error::OtherRule`] that names it and its rule.
    pub(super) fn check_thresholds(&self) -> Result<()> {
        let (time_left, fhwa) = ((SeverityRule::TimeLeft, "time-left"), (SeverityRule::Fhwa, "fhwa"));
        let thresholds = [
            ("serious_probability", self.serious_probability != SERIOUS_PROBABILITY, time_left),
            ("serious_delta_v", self.serious_delta_v != SERIOUS_DELTA_V, time_left),
            ("serious_ttc", self.serious_ttc != SERIOUS_TTC, fhwa),
            ("serious_drac", self.serious_drac != SERIOUS_DRAC, fhwa),
        ];
        let unused = thresholds.into_iter().find(|(_, is_set, (rule, _))| *is_set && *rule != self.severity_rule);
        unused.map_or(Ok(()), |(name, _, (_, rule))| Err(Error::OtherRule { name, rule }))
    }

    /// The thresholds of severity.
    pub fn severity_thresholds(&self) -> SeverityThresholds {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_threshold_of_another_rule_is_refused() {
        let options = Options { serious_probability: 0.9, ..Options::default() };
        let message = options.clone().checked().unwrap_err().to_string();
        assert_eq!(message, "serious_probability: it has no effect without severity_rule time-left");
        assert!(Options { severity_rule: SeverityRule::TimeLeft, ..options }.checked().is_ok());
        let options = Options { serious_drac: 5.0, severity_rule: SeverityRule::Ssm, ..Options::default() };
        assert!(options.clone().checked().is_err());
        assert!(Options { severity_rule: SeverityRule::Fhwa, ..options }.checked().is_ok());
        // The default may be written out.
        assert!(Options { serious_ttc: SERIOUS_TTC, ..Options::default() }.checked().is_ok());
    }
}
