//! Surrogate safety measures of a pair in one step: DRAC, ΔV, severity.

use crate::encounter::Severity;
use crate::options::Options;
use crate::units::{MetrePerSecondSquared, Second};

/// How bad a conflict is, from what is known of it in one step.
pub fn severity(
    ttc: Option<Second>,
    drac: Option<MetrePerSecondSquared>,
    ego_deceleration: MetrePerSecondSquared,
    collision: bool,
    options: &Options,
) -> Severity {
    if collision || drac.is_some_and(|drac| drac > ego_deceleration) {
        Severity::Critical
    } else if ttc.is_some_and(|ttc| ttc < options.serious_ttc) || drac.is_some_and(|drac| drac > options.serious_drac) {
        Severity::Serious
    } else {
        Severity::Caution
    }
}

/// Deceleration that the ego needs to just avoid contact (temporary form).
pub fn drac(
    encounter: &crate::encounter::Encounter,
    ego_speed: f64,
    foe_speed: f64,
    _meeting: &crate::accurate::Meeting,
) -> Option<MetrePerSecondSquared> {
    let closing = ego_speed - encounter.angle.cos() * foe_speed;
    (encounter.gap > 0.0 && closing > 0.0).then(|| closing * closing / (2.0 * encounter.gap))
}
