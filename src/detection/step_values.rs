//! The values of a pair in a step that a condition compares.

use super::encounter::Encounter;
use super::measures;
use super::measures::headway::headway;
use crate::options::condition::Measure;
use crate::util::units::{Kilogram, MetrePerSecond};

/// A pair in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepValues<'a> {
    pub found: &'a Encounter,
    /// The ego's and the foe's.
    pub speeds: [MetrePerSecond; 2],
    /// The ego's and the foe's.
    pub masses: [Kilogram; 2],
}

impl StepValues<'_> {
    /// The value of a measure, if the pair has it in this step.
    pub fn of(&self, measure: Measure) -> Option<f64> {
        let &Self { found, speeds: [ego_speed, foe_speed], masses: [ego_mass, foe_mass] } = self;
        let delta_v = || measures::delta_v((ego_speed, ego_mass), (foe_speed, foe_mass), found.angle);
        match measure {
            Measure::Gap => Some(found.gap),
            Measure::Mu => Some(found.mu),
            Measure::Margin => Some(found.margin),
            Measure::Clearance => found.nearness.map(|near| near.clearance),
            Measure::Ttc => found.nearness?.ttc,
            Measure::Drac => found.nearness?.drac,
            Measure::Pet => None,
            Measure::Headway => headway(found.kind, found.gap, ego_speed),
            Measure::Overlap => Some(found.overlap),
            Measure::Angle => Some(found.angle),
            Measure::EgoSpeed => Some(ego_speed),
            Measure::FoeSpeed => Some(foe_speed),
            Measure::EgoDeltaV => Some(delta_v()[0]),
            Measure::FoeDeltaV => Some(delta_v()[1]),
        }
    }
}
