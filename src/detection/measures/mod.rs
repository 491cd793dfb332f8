//! Surrogate safety measures of a pair in one step: ΔV. The other measures have files of their own.

pub mod accident;
pub mod advantage;
mod blocked_path;
mod corridor;
pub mod crash_potential;
pub mod crash_probability;
pub mod drac;
mod drac_straight;
pub mod driven_path;
pub mod emergency_index;
pub mod exposure;
pub mod headway;
pub mod injury;
pub mod mdrac;
pub mod mttc;
mod passage;
pub mod pet;
pub mod plane;
pub mod rss_lateral;
pub mod table;
pub mod threat;
pub mod ttb;
pub mod ttc;

pub(crate) use blocked_path::MOST_TIMES;

use crate::util::units::{Kilogram, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// ΔV in m/s of the ego and of the foe: the changes of their velocities in a fully inelastic collision of both masses, at
/// the current speeds and the angle α at the conflict point.
pub fn delta_v(ego: (MetrePerSecond, Kilogram), foe: (MetrePerSecond, Kilogram), angle: Radian) -> [MetrePerSecond; 2] {
    let along = ego.0 - foe.0 * angle.cos();
    let across = foe.0 * angle.sin();
    let closing = along.hypot(across);
    [closing / (1.0 + ego.1 / foe.1), closing / (1.0 + foe.1 / ego.1)]
}

/// The deceleration of extended ΔV, in m/s²: the harder one of Laureshyn et al. 2017.
const EXTENDED_BRAKING: MetrePerSecondSquared = 8.0;

/// Extended ΔV in m/s (Laureshyn, De Ceunynck, Karlsson, Svensson and Daniels 2017): the larger ΔV of both if each brakes
/// with 8 m/s² for the time that is left until they touch.
pub fn extended_delta_v(
    ego: (MetrePerSecond, Kilogram),
    foe: (MetrePerSecond, Kilogram),
    angle: Radian,
    left: Second,
) -> MetrePerSecond {
    let braked = |(speed, mass)| (f64::max(speed - EXTENDED_BRAKING * left, 0.0), mass);
    let [ego, foe] = delta_v(braked(ego), braked(foe), angle);
    ego.max(foe)
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
    fn braking_until_contact_lowers_the_delta_v() {
        let extended = |left| extended_delta_v((20.0, 1500.0), (0.0, 1500.0), 0.0, left);
        assert_eq!([0.0, 1.0, 2.5, 9.0].map(extended), [10.0, 6.0, 0.0, 0.0]);
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
