//! Required longitudinal and lateral acceleration, and their threat numbers, shares of the available acceleration: BTN and STN
//! (Jansson 2005; Brännström, Sjöberg and Coelingh 2008).
//!
//! A follower needs this constant deceleration behind a leader that goes on braking with b until it stands:
//!
//! ```text
//! both stand before contact:  a = V² / (2 (gap + Vᵢ²/(2b)))
//! the follower stands first:  a = b + (V − Vᵢ)² / (2 gap)
//! ```
//!
//! To be beside the foe at the time to collision, an ego needs this constant lateral acceleration, with the least lateral
//! displacement y, to the left or to the right, that clears the foe:
//!
//! ```text
//! a = 2 y / TTC²,   BTN = a_long / a_max,   STN = a_lat / a_max
//! ```
//!
//! The tyres transmit as much sideways as along (Kamm's circle), so a_max is the braking deceleration for both.

use super::drac::LIMIT;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::{cross, left_of};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// The longitudinal deceleration in m/s² that a follower needs, at most `LIMIT`; 0 where it needs none.
pub fn behind(
    gap: Metre,
    speed: MetrePerSecond,
    leader: MetrePerSecond,
    braking: MetrePerSecondSquared,
) -> MetrePerSecondSquared {
    let closing = speed - leader;
    let needed = if braking > 0.0 {
        let until_both_stand = speed * speed / (2.0 * (gap + leader * leader / (2.0 * braking)));
        let stands_last = closing <= 0.0 || leader * until_both_stand <= speed * braking;
        if stands_last { until_both_stand } else { braking + closing * closing / (2.0 * gap) }
    } else if closing > 0.0 {
        closing * closing / (2.0 * gap)
    } else {
        0.0
    };
    // Nothing moves at no distance: 0 / 0.
    if needed.is_nan() { 0.0 } else { needed.min(LIMIT) }
}

/// The lateral acceleration in m/s² with which the ego is beside the foe when both would touch, at most `LIMIT`; both
/// rectangles are those at that time.
pub fn aside(ego: &Rectangle, foe: &Rectangle, ttc: Second) -> MetrePerSecondSquared {
    let left = left_of(&ego.axis);
    let reach = foe.half_width * foe.axis.dot(&ego.axis).abs() + foe.half_length * cross(&ego.axis, &foe.axis).abs();
    let aside = (foe.centre - ego.centre).dot(&left);
    let displacement = (reach + ego.half_width - aside.abs()).max(0.0);
    if displacement == 0.0 { 0.0 } else { (2.0 * displacement / (ttc * ttc)).min(LIMIT) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use fastrand::Rng;

    /// The smallest room of a follower that brakes constantly, by small steps.
    fn least_room(gap: f64, [mut speed, mut leader]: [f64; 2], [own, other]: [f64; 2]) -> f64 {
        const STEP: f64 = 1e-3;
        let (mut room, mut least) = (gap, gap);
        for _ in 0..40_000 {
            let next = [(speed - own * STEP).max(0.0), (leader - other * STEP).max(0.0)];
            room -= (speed + next[0] - leader - next[1]) / 2.0 * STEP;
            [speed, leader] = next;
            least = least.min(room);
        }
        least
    }

    #[test]
    fn a_follower_that_brakes_so_just_stays_behind() {
        let mut chance = Rng::with_seed(9);
        let mut between = |low: f64, high: f64| low + (high - low) * chance.f64();
        let mut compared = 0;
        for _ in 0..100 {
            let (gap, speeds) = (between(1.0, 40.0), [between(1.0, 25.0), between(0.0, 25.0)]);
            let braking = if between(0.0, 1.0) < 0.3 { 0.0 } else { between(0.5, 8.0) };
            let needed = behind(gap, speeds[0], speeds[1], braking);
            if needed > 0.0 && needed < LIMIT && speeds[0] / needed < 39.0 {
                compared += 1;
                let least = least_room(gap, speeds, [needed, braking]);
                assert!(least.abs() < 0.02, "{needed} leaves {least} of {gap}: {speeds:?} {braking}");
            }
        }
        assert!(compared > 50, "{compared}");
    }

    #[test]
    fn nothing_is_needed_behind_one_that_is_no_slower() {
        assert_eq!([behind(5.0, 10.0, 10.0, 0.0), behind(0.0, 0.0, 0.0, 0.0)], [0.0; 2]);
        assert_eq!(behind(0.0, 10.0, 5.0, 0.0), LIMIT);
    }

    #[test]
    fn half_a_car_aside_needs_half_as_much() {
        let car = |x, y| Rectangle::new(Point::new(x, y), 0.0, 5.0, 2.0);
        let of = |y| aside(&car(0.0, 0.0), &car(5.0, y), 2.0);
        assert_eq!([of(0.0), of(1.0), of(-1.0), of(2.5)], [1.0, 0.5, 0.5, 0.0]);
        let across = Rectangle::new(Point::new(3.5, 1.5), std::f64::consts::FRAC_PI_2, 5.0, 2.0);
        assert_eq!(aside(&car(0.0, 0.0), &across, 2.0), 1.0);
    }
}
