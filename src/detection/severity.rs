//! How severe a conflict is: two questions, and a table of their answers.
//!
//! **Nearness**: how near to a crash was it? The evidence is of either kind. Foreseen: the probability that the driver brakes
//! too late, and the time to brake. Seen: evasive braking that was needed, or crossing paths that were passed at speed with
//! hardly any time or room between.
//!
//! **Consequence**: what would a crash have meant? By the ΔV of both, and the injuries to be expected from it.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

use super::kind::Severity;
use crate::options::thresholds::SeverityThresholds;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Probability, Second};

/// How near to a crash a conflict was.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum NearnessLevel {
    /// A crash would have taken more than an ordinary driver's response.
    Possible,
    /// An ordinary driver more likely than not brakes too late, or has to brake hard.
    Likely,
    /// Braking at once is too late, or takes all that brakes can do.
    NearCertain,
}

/// What a crash would have meant.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Consequence {
    /// Damage at most.
    Minor,
    /// An injury.
    Moderate,
    /// An injury that may be fatal.
    Severe,
}

/// From this crash probability on a crash is likely: a driver more likely brakes too late than not.
pub const LIKELY: Probability = 0.5;
/// From this crash probability on a crash is near certain: of twenty drivers one brakes in time (our choice).
pub const NEAR_CERTAIN: Probability = 0.95;
/// Evasive braking from this on, in m/s², if needed, makes a crash likely: more than the 0.45 g from which naturalistic
/// studies look for near-crashes (Simons-Morton et al. 2012, doi:10.1093/aje/kwr440), and than SUMO's cars brake by default.
pub const EVASIVE: MetrePerSecondSquared = 4.5;
/// Braking from this on, in m/s², is all that brakes do: the deceleration of full braking on a dry road (UN R13-H asks for
/// 6.43 of new brakes; SUMO's cars have 9).
pub const FULL: MetrePerSecondSquared = 7.0;
/// Crossing paths that the second enters less than this after the first has left make a crash likely, in s (Allen, Shin and
/// Cooper 1978 observe PETs; a PET below 0.5 s is the most severe class of Peesapati, Hunter and Rodgers 2013,
/// doi:10.3141/2386-05, from 1 s on).
pub const LIKELY_PET: Second = 0.5;
/// Crossing paths passed with less room than this, in m …
pub const LIKELY_CLEARANCE: Metre = 1.0;
/// … at a speed relative to each other of at least this, in m/s, make a crash likely: the pace above which a collision
/// injures a pedestrian (20 km/h; our choice).
pub const AT_SPEED: MetrePerSecond = 20.0 / 3.6;

/// ΔV from which the consequence is moderate, in m/s: 10 km/h, from which on occupants report neck injuries (docs/model.md).
pub const MODERATE: MetrePerSecond = 10.0 / 3.6;
/// Probability of a fatal injury from which on it is severe: one in a hundred; of occupants about 36 km/h of ΔV from the
/// front, 24 from the side; of those that nothing protects, 26 (our choice).
pub const SEVERE: Probability = 0.01;

/// What the severity of a step depends on.
#[derive(Clone, Copy, Debug)]
pub struct SeverityInputs {
    /// Time to collision.
    pub ttc: Option<Second>,
    /// Deceleration to avoid the collision.
    pub drac: Option<MetrePerSecondSquared>,
    /// The ego's braking deceleration.
    pub ego_deceleration: MetrePerSecondSquared,
    /// Time to brake.
    pub ttb: Option<Second>,
    /// Probability that the driver does not brake in time.
    pub crash_probability: f64,
    /// How hard the one brakes that can avoid the collision; 0 or more.
    pub braking: MetrePerSecondSquared,
    /// The larger ΔV of both if they collided at their present speeds.
    pub delta_v: MetrePerSecond,
    /// Probability of a fatal injury then.
    pub injury_probability: Probability,
    /// Whether the two collide.
    pub collision: bool,
}

/// How severe a step is, and why. Ordered by severity, then by nearness, then by consequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Assessment {
    /// By the rule of the options.
    pub severity: Severity,
    /// How near to a crash it was.
    pub nearness: NearnessLevel,
    /// What a crash would have meant.
    pub consequence: Consequence,
}

impl NearnessLevel {
    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// That of a step.
    fn of(inputs: &SeverityInputs) -> Self {
        let SeverityInputs { ttc, drac, ttb, crash_probability, braking, delta_v, collision, .. } = *inputs;
        // The braking that was needed: without contact ahead none is, and what is beyond the need is caution.
        let needed = braking.min(drac.unwrap_or(0.0));
        let brakes_fully = braking >= FULL && ttc.is_some();
        match () {
            () if collision || ttb == Some(0.0) || crash_probability >= NEAR_CERTAIN => Self::NearCertain,
            // Of two about as fast as each other the DRAC is small whatever the need.
            () if needed >= FULL || (brakes_fully && delta_v < MODERATE) => Self::NearCertain,
            () if crash_probability >= LIKELY || needed >= EVASIVE || brakes_fully => Self::Likely,
            () => Self::Possible,
        }
    }
}

impl Consequence {
    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// That of a collision in which a velocity changes by ΔV.
    pub fn of(delta_v: MetrePerSecond, injury_probability: Probability) -> Self {
        if injury_probability >= SEVERE {
            Self::Severe
        } else if delta_v >= MODERATE {
            Self::Moderate
        } else {
            Self::Minor
        }
    }
}

impl Assessment {
    /// Of a step.
    pub fn of(inputs: &SeverityInputs, thresholds: SeverityThresholds) -> Self {
        let nearness = NearnessLevel::of(inputs);
        let consequence = Consequence::of(inputs.delta_v, inputs.injury_probability);
        Self { severity: severity(inputs, thresholds, nearness, consequence), nearness, consequence }
    }

    /// The same where one of the two will wait: what is foreseen from how it drives now is only possible.
    pub(crate) fn of_one_that_waits(self, rule: SeverityThresholds) -> Self {
        match rule {
            SeverityThresholds::Levels => {
                let nearness = NearnessLevel::Possible;
                Self { severity: table(nearness, self.consequence), nearness, ..self }
            }
            _ => self,
        }
    }

    /// The same where it was seen that a crash was at least this near.
    pub(crate) fn at_least(self, nearness: NearnessLevel, thresholds: SeverityThresholds) -> Self {
        let nearness = nearness.max(self.nearness);
        let severity = match thresholds {
            SeverityThresholds::Levels => table(nearness, self.consequence),
            _ => self.severity,
        };
        Self { severity, nearness, ..self }
    }
}

/// Whether a severity may depend on where between two bounds a crash probability is.
pub(crate) fn depends_on(thresholds: SeverityThresholds, [least, most]: [Probability; 2]) -> bool {
    let own = match thresholds {
        // A probability of 0 is never late.
        SeverityThresholds::TimeLeft { probability, .. } => probability.max(f64::MIN_POSITIVE),
        _ => LIKELY,
    };
    [LIKELY, NEAR_CERTAIN, own].iter().any(|threshold| least < *threshold && *threshold <= most)
}

/// The severity of a nearness and a consequence; it falls with neither.
pub const fn table(nearness: NearnessLevel, consequence: Consequence) -> Severity {
    match (nearness, consequence) {
        (NearnessLevel::Possible, _) | (NearnessLevel::Likely, Consequence::Minor) => Severity::Caution,
        (NearnessLevel::Likely, _) | (NearnessLevel::NearCertain, Consequence::Minor) => Severity::Serious,
        (NearnessLevel::NearCertain, _) => Severity::Critical,
    }
}

fn severity(
    inputs: &SeverityInputs,
    thresholds: SeverityThresholds,
    nearness: NearnessLevel,
    consequence: Consequence,
) -> Severity {
    let SeverityInputs { ttc, drac, ego_deceleration, ttb, crash_probability, delta_v, collision, .. } = *inputs;
    let (critical, serious) = match thresholds {
        SeverityThresholds::Levels => return table(nearness, consequence),
        SeverityThresholds::TimeLeft { probability, delta_v: least_delta_v } => {
            let is_late = crash_probability > 0.0 && crash_probability >= probability;
            (ttb == Some(0.0), is_late && delta_v >= least_delta_v)
        }
        SeverityThresholds::Measures { ttc: serious_ttc, drac: serious_drac } => (
            drac.is_some_and(|drac| drac > ego_deceleration),
            ttc.is_some_and(|ttc| ttc < serious_ttc) || drac.is_some_and(|drac| drac > serious_drac),
        ),
    };
    match (critical || collision, serious) {
        (true, _) => Severity::Critical,
        (false, true) => Severity::Serious,
        (false, false) => Severity::Caution,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INPUTS: SeverityInputs = SeverityInputs {
        ttc: Some(1.0),
        drac: Some(4.0),
        ego_deceleration: 8.0,
        ttb: Some(0.9),
        crash_probability: 0.2,
        braking: 0.0,
        delta_v: 3.0,
        injury_probability: 1e-4,
        collision: false,
    };

    #[test]
    fn the_table_falls_with_neither_answer() {
        for [one, other] in [[0, 1], [1, 2]] {
            for third in 0..3 {
                let [near, far] =
                    [other, one].map(|place| table(NearnessLevel::VARIANTS[place], Consequence::VARIANTS[third]));
                let [worse, milder] =
                    [other, one].map(|place| table(NearnessLevel::VARIANTS[third], Consequence::VARIANTS[place]));
                assert!(near >= far && worse >= milder);
            }
        }
    }

    #[test]
    fn hard_braking_is_evidence_only_if_needed() {
        let of =
            |braking, drac, ttc, delta_v| NearnessLevel::of(&SeverityInputs { braking, drac, ttc, delta_v, ..INPUTS });
        let nearness = |braking, drac, ttc| of(braking, drac, ttc, 3.0);
        assert_eq!(nearness(4.6, Some(4.6), Some(1.0)), NearnessLevel::Likely);
        assert_eq!(nearness(4.6, Some(3.0), Some(1.0)), NearnessLevel::Possible);
        assert_eq!(nearness(4.4, Some(9.0), Some(1.0)), NearnessLevel::Possible);
        assert_eq!(nearness(8.0, Some(7.0), Some(1.0)), NearnessLevel::NearCertain);
        assert_eq!(nearness(8.0, Some(3.0), Some(1.0)), NearnessLevel::Likely);
        assert_eq!(of(8.0, Some(3.0), Some(1.0), 1.0), NearnessLevel::NearCertain);
        assert_eq!(nearness(8.0, None, None), NearnessLevel::Possible);
    }

    #[test]
    fn an_emergency_stop_is_serious_at_any_speed() {
        let slow = SeverityInputs { delta_v: 0.5, crash_probability: 0.999, ..INPUTS };
        assert_eq!(Assessment::of(&slow, SeverityThresholds::Levels).severity, Severity::Serious);
        let crash = SeverityInputs { delta_v: 0.5, collision: true, ..INPUTS };
        assert_eq!(Assessment::of(&crash, SeverityThresholds::Levels).severity, Severity::Serious);
    }

    #[test]
    fn what_is_seen_raises_the_severity() {
        let foreseen = Assessment::of(&INPUTS, SeverityThresholds::Levels);
        assert_eq!(foreseen.severity, Severity::Caution);
        let seen = foreseen.at_least(NearnessLevel::Likely, SeverityThresholds::Levels);
        assert_eq!((seen.severity, seen.consequence), (Severity::Serious, Consequence::Moderate));
    }

    #[test]
    fn the_other_rules_stay_as_they_are() {
        let fhwa = SeverityThresholds::Measures { ttc: 1.5, drac: 3.4 };
        let time_left = |probability, delta_v| SeverityThresholds::TimeLeft { probability, delta_v };
        let of = |inputs: &SeverityInputs, rule| Assessment::of(inputs, rule).severity;
        assert_eq!(
            [(0.2, 3.0), (0.21, 3.0), (0.2, 3.1)].map(|(p, v)| of(&INPUTS, time_left(p, v))),
            [Severity::Serious, Severity::Caution, Severity::Caution]
        );
        assert_eq!(of(&INPUTS, fhwa), Severity::Serious);
        let too_late = SeverityInputs { ttb: Some(0.0), drac: Some(9.0), ..INPUTS };
        assert_eq!(of(&too_late, time_left(1.0, 9.0)), Severity::Critical);
        assert_eq!(of(&too_late, fhwa), Severity::Critical);
        let apart = SeverityInputs { ttc: None, drac: None, ttb: None, crash_probability: 0.0, ..INPUTS };
        assert_eq!(of(&apart, time_left(0.0, 0.0)), Severity::Caution);
    }
}
