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

/// ΔV in m/s of the ego and of the foe: the changes of their velocities in a fully inelastic collision of both masses, at
/// the current speeds and the angle α at the conflict point.
pub fn delta_v(ego: (MetrePerSecond, Kilogram), foe: (MetrePerSecond, Kilogram), angle: Radian) -> [MetrePerSecond; 2] {
    let along = ego.0 - foe.0 * angle.cos();
    let across = foe.0 * angle.sin();
    let closing = along.hypot(across);
    [closing / (1.0 + ego.1 / foe.1), closing / (1.0 + foe.1 / ego.1)]
}

#[cfg(test)]
mod tests {
    use crate::detection::measures::*;

    #[test]
    fn equal_masses_share_the_speed_difference() {
        assert_eq!(delta_v((20.0, 1500.0), (10.0, 1500.0), 0.0), [5.0, 5.0]);
        assert_eq!(delta_v((20.0, 1500.0), (10.0, 1500.0), std::f64::consts::PI), [15.0, 15.0]);
    }

    #[test]
    fn a_wall_takes_all_of_the_speed() {
        let [car, wall] = delta_v((13.0, 1500.0), (0.0, f64::MAX), std::f64::consts::PI);
        assert!(car == 13.0 && wall < 1e-300, "{car} and {wall}");
    }

    #[test]
    fn the_lighter_of_two_changes_its_speed_most() {
        let [truck, cyclist] = delta_v((12.0, 11_900.0), (0.0, 100.0), std::f64::consts::FRAC_PI_2);
        assert_eq!((truck, cyclist), (0.1, 11.9));
    }
}
