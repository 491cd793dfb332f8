//! Time to accident (TA), conflicting speed and severity level of the Swedish traffic conflict technique (Hydén 1987; Svensson
//! 1998): the time left until contact, and the speed of the road user that evades, when its evasive action begins. Also how
//! hard it really brakes, which needs no prediction.
//!
//! The levels are lines in the diagram of TA and conflicting speed V (in m/s), each half a second apart; from level 26 on a
//! conflict is serious. The border of level 26 and the distance between the lines are second-hand: neither could be checked in
//! a primary text.
//!
//! ```text
//! TA_border = 1.5 V / (16.7 exp(−0.0306 V/2)),   level = 26 + ⌊(TA_border − TA) / 0.5⌋, from 1 to 30
//! ```

use crate::util::units::{MetrePerSecond, MetrePerSecondSquared, Ratio, Second};

/// A driver that slows down by at least this, in m/s², has responded: from here on, a vehicle has to light its brake lamps
/// (UN R13-H, 5.2.22.4).
pub const BRAKES: MetrePerSecondSquared = 1.3;

/// The first level of serious conflicts.
const SERIOUS: f64 = 26.0;
/// The highest level.
const HIGHEST: f64 = 30.0;
/// The time between the lines of two levels, in s.
const APART: Second = 0.5;

/// The conflicting speed: that of the road user that evades by braking, before this step; the faster one's if both do, none if
/// neither does.
pub fn conflicting_speed(
    speeds: [MetrePerSecond; 2],
    accelerations: [MetrePerSecondSquared; 2],
    step: Second,
) -> Option<MetrePerSecond> {
    let evading = speeds.into_iter().zip(accelerations).filter(|(_, acceleration)| *acceleration <= -BRAKES);
    evading.map(|(speed, acceleration)| speed - acceleration * step).reduce(f64::max)
}

/// The deceleration of the vehicle that brakes harder, as far as braking counts as an evasive action; none if neither brakes so
/// hard. `vehicles` are the accelerations of the pair's vehicles: that a person stops at once is not a sign of danger.
pub fn evasive_braking(vehicles: impl Iterator<Item = MetrePerSecondSquared>) -> Option<MetrePerSecondSquared> {
    vehicles.map(|acceleration| -acceleration).filter(|braking| *braking >= BRAKES).reduce(f64::max)
}

/// The severity level of a TA and a conflicting speed.
pub fn level(ta: Second, speed: MetrePerSecond) -> Ratio {
    let border = 1.5 * speed / (16.7 * (-0.0306 * speed / 2.0).exp());
    (SERIOUS + ((border - ta) / APART).floor()).clamp(1.0, HIGHEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_fifty_kilometres_per_hour_the_border_is_1_543_seconds() {
        let speed = 50.0 / 3.6;
        assert_eq!([1.544, 1.542, 1.0, 0.0].map(|ta| level(ta, speed)), [25.0, 26.0, 27.0, 29.0]);
        assert_eq!([level(20.0, speed), level(0.0, 60.0)], [1.0, 30.0]);
    }

    #[test]
    fn the_harder_braking_counts_if_it_evades() {
        let braking = |accelerations: [f64; 2]| evasive_braking(accelerations.into_iter());
        assert_eq!([[-2.0, -6.0], [1.0, -1.3]].map(braking), [Some(6.0), Some(1.3)]);
        assert_eq!(braking([-1.2, 0.0]), None);
    }

    #[test]
    fn the_one_that_brakes_has_the_conflicting_speed() {
        let speed = |accelerations| conflicting_speed([10.0, 7.0], accelerations, 0.1);
        assert_eq!(speed([-0.5, -2.0]), Some(7.2));
        assert_eq!(speed([-1.3, -4.0]), Some(10.13));
        assert_eq!(speed([0.0, -1.2]), None);
    }
}
