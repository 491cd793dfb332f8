//! The values of a pair in a step that a condition compares.

use super::encounter::{Encounter, Nearness};
use super::measures;
use super::measures::headway::headway;
use super::measures::injury::{Body, injury_probability};
use super::measures::table::LoggedMeasure;
use crate::options::condition::Measure;
use crate::traffic::profile::Profile;
use crate::util::units::{MetrePerSecond, Probability};

/// A pair in a step.
#[derive(Clone, Copy)]
pub(super) struct StepValues<'a> {
    pub found: &'a Encounter,
    /// The ego's and the foe's.
    pub speeds: [MetrePerSecond; 2],
    /// The ego's and the foe's.
    pub types: [&'a Profile; 2],
    /// Works out a crash probability.
    pub crash_probability: &'a dyn Fn(&Nearness, LoggedMeasure) -> Option<Probability>,
}

impl StepValues<'_> {
    /// The value of a measure, if the pair has it in this step.
    pub fn of(&self, measure: Measure) -> Option<f64> {
        let &Self { found, speeds: [ego_speed, foe_speed], types: [ego, foe], crash_probability } = self;
        let delta_v = || measures::delta_v((ego_speed, ego.mass), (foe_speed, foe.mass), found.angle);
        match measure {
            Measure::Gap => Some(found.gap),
            Measure::Mu => Some(found.mu),
            Measure::Margin => Some(found.margin),
            Measure::Clearance => found.nearness.map(|near| near.clearance),
            Measure::Ttc => found.nearness?.values.ttc(),
            Measure::Drac => found.nearness?.values.drac(),
            Measure::Pet => None,
            Measure::Headway => headway(found.kind, found.gap, ego_speed),
            Measure::Overlap => Some(found.overlap),
            Measure::Angle => Some(found.angle),
            Measure::EgoSpeed => Some(ego_speed),
            Measure::FoeSpeed => Some(foe_speed),
            Measure::EgoDeltaV => Some(delta_v()[0]),
            Measure::FoeDeltaV => Some(delta_v()[1]),
            Measure::ResponseLeft => found.nearness?.values.response_left(),
            Measure::Ttb => found.nearness?.values.ttb(),
            Measure::CrashProbability => crash_probability(&found.nearness?, LoggedMeasure::CrashProbability),
            Measure::CrashProbabilityBraking => {
                crash_probability(&found.nearness?, LoggedMeasure::CrashProbabilityBraking)
            }
            Measure::InjuryProbability => {
                let [of_ego, of_foe] = delta_v();
                Some(injury_probability(found.kind, Body::of(ego, of_ego), Body::of(foe, of_foe)))
            }
            Measure::ExtendedDeltaV => found.nearness?.values.extended_delta_v(),
        }
    }
}
