//! The measures that a condition may compare: those of a step, and the PET.

use strum::{Display, EnumString, VariantNames};

/// A measure of a pair in a step, by the name of its column in the log; `detection::step_values` has its value. The PET is that
/// of the event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Display, EnumString, VariantNames)]
#[strum(serialize_all = "snake_case")]
#[expect(missing_docs, reason = "docs/log.md describes the columns")]
pub enum Measure {
    Gap,
    Mu,
    Margin,
    Clearance,
    Ttc,
    Drac,
    Pet,
    Headway,
    Overlap,
    Angle,
    EgoSpeed,
    FoeSpeed,
    EgoDeltaV,
    FoeDeltaV,
    ResponseLeft,
    Ttb,
    CrashProbability,
    CrashProbabilityBraking,
    InjuryProbability,
    ExtendedDeltaV,
}
