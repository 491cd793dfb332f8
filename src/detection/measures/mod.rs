//! Surrogate safety measures of a pair in one step: ΔV and severity. TTC is in [`ttc`], DRAC in [`drac`], PET in
//! [`crate::events`].

pub mod drac;
mod drac_straight;
pub mod headway;
pub mod ttc;

use super::kind::Severity;
use crate::options::thresholds::SeverityThresholds;
use crate::util::units::{Kilogram, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// The severity of a conflict in one step.
pub fn severity(
    ttc: Option<Second>,
    drac: Option<MetrePerSecondSquared>,
    ego_deceleration: MetrePerSecondSquared,
    collision: bool,
    thresholds: SeverityThresholds,
) -> Severity {
    if collision || drac.is_some_and(|drac| drac > ego_deceleration) {
        Severity::Critical
    } else if ttc.is_some_and(|ttc| ttc < thresholds.serious_ttc)
        || drac.is_some_and(|drac| drac > thresholds.serious_drac)
    {
        Severity::Serious
    } else {
        Severity::Caution
    }
}

/// ΔV in m/s: the change of the ego's velocity in a fully inelastic collision of both masses, at the current speeds and
/// the angle α at the conflict point.
pub fn delta_v(ego: (MetrePerSecond, Kilogram), foe: (MetrePerSecond, Kilogram), angle: Radian) -> MetrePerSecond {
    let along = ego.0 - foe.0 * angle.cos();
    let across = foe.0 * angle.sin();
    along.hypot(across) / (1.0 + ego.1 / foe.1)
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::*;

    #[test]
    fn equal_masses_share_the_speed_difference() {
        assert_eq!(delta_v((20.0, 1500.0), (10.0, 1500.0), 0.0), 5.0);
        assert_eq!(delta_v((20.0, 1500.0), (10.0, 1500.0), std::f64::consts::PI), 15.0);
    }

    #[test]
    fn a_wall_takes_all_of_the_speed() {
        assert_eq!(delta_v((13.0, 1500.0), (0.0, f64::MAX), std::f64::consts::PI), 13.0);
    }
}
