//! The longitudinal safe distances of responsibility-sensitive safety (RSS; Shalev-Shwartz, Shammah and Shashua 2017).
//!
//! During the response time ρ each may still speed up by a⁺; then it brakes with at least b, and a leader with at most B:
//!
//! ```text
//! same direction:      d = [ V ρ + a⁺ ρ²/2 + (V + ρ a⁺)²/(2b) − Vᵢ²/(2B) ]₊
//! opposite directions: d = V ρ + a⁺ ρ²/2 + (V + ρ a⁺)²/(2b) + the same of the foe
//! ```
//!
//! The paper leaves the values open; these are the ones of CARLA's RSS sensor and Intel's ad-rss-lib. Which of two oncoming
//! vehicles keeps to its lane is unknown here, so both brake with b.

use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// Response time ρ in s.
pub const RESPONSE: Second = 1.0;
/// Longitudinal acceleration a⁺ during the response time, in m/s².
pub(crate) const ACCELERATION: MetrePerSecondSquared = 3.5;
/// Deceleration b with which every road user brakes at least, in m/s².
pub(crate) const LEAST_BRAKING: MetrePerSecondSquared = 4.0;
/// Deceleration B with which a leader brakes at most, in m/s².
pub(crate) const MOST_BRAKING: MetrePerSecondSquared = 8.0;

/// The distance in m until a road user stands that first speeds up for its response time and then brakes.
pub fn stopping_distance(speed: MetrePerSecond) -> Metre {
    let then = speed + RESPONSE * ACCELERATION;
    (speed + then) / 2.0 * RESPONSE + then * then / (2.0 * LEAST_BRAKING)
}

/// What the foe adds to the room, at σ = cos α: the way on which it brakes as a leader, or less its own way if oncoming.
fn of_foe(foe: MetrePerSecond, sigma: f64) -> Metre {
    sigma * if sigma > 0.0 { foe * foe / (2.0 * MOST_BRAKING) } else { stopping_distance(foe) }
}

/// The safe distance in m behind a leader (σ = 1), of two that drive towards each other (σ = −1), and between.
pub(crate) fn safe_distance(speed: MetrePerSecond, foe: MetrePerSecond, sigma: f64) -> Metre {
    (stopping_distance(speed) - of_foe(foe, sigma)).max(0.0)
}

/// The longest response time ρ of the ego in s with which the safe distance fits into a room; 0 where none does.
pub(crate) fn longest_response(speed: MetrePerSecond, foe: MetrePerSecond, sigma: f64, room: Metre) -> Second {
    // V ρ + a⁺ ρ²/2 + (V + ρ a⁺)²/(2b) = room, a quadratic equation.
    let ratio = 1.0 + ACCELERATION / LEAST_BRAKING;
    let (half, slope) = (ACCELERATION * ratio, speed * ratio);
    let left = room + of_foe(foe, sigma) - speed * speed / (2.0 * LEAST_BRAKING);
    if left > 0.0 { 2.0 * left / (slope + (slope * slope + 2.0 * half * left).sqrt()) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::braking::{Brakes, Braking, MuModel, mu, response_left};

    /// The distance by small steps.
    fn driven(mut speed: f64) -> f64 {
        const STEP: f64 = 1e-5;
        let (mut stopping_distance, mut time) = (0.0, 0.0);
        while time < RESPONSE || speed > 0.0 {
            let next = speed + STEP * if time < RESPONSE { ACCELERATION } else { -LEAST_BRAKING };
            stopping_distance += (speed + next.max(0.0)) / 2.0 * STEP;
            (speed, time) = (next, time + STEP);
        }
        stopping_distance
    }

    #[test]
    fn the_distances_are_those_of_small_steps() {
        for (speed, foe) in [(10.0, 10.0), (30.0, 5.0), (2.0, 0.0), (8.0, 14.0)] {
            let (own, of_foe, leader) = (driven(speed), driven(foe), foe * foe / 16.0);
            for (sigma, wanted) in [(1.0, own - leader), (0.5, own - leader / 2.0), (0.0, own), (-1.0, own + of_foe)] {
                assert!((safe_distance(speed, foe, sigma) - wanted).abs() < 2e-3);
            }
        }
        assert_eq!(safe_distance(1.0, 40.0, 1.0), 0.0);
    }

    #[test]
    fn mu_is_the_safe_distance_and_its_response_the_inverse() {
        let brakes = Brakes { response: 0.3, build_up: 0.1, deceleration: 9.0 };
        let at = |speed| Braking { speed, brakes: &brakes };
        for (speed, foe, sigma) in [(13.0, 11.0, 1.0), (13.0, 30.0, 0.9), (0.0, 0.0, 0.0), (20.0, 15.0, -1.0)] {
            let needed = mu(MuModel::Rss, at(speed), at(foe), sigma, 0.5);
            assert_eq!(needed, safe_distance(speed, foe, sigma) + 0.5);
            let left = |gap| response_left(MuModel::Rss, at(speed), at(foe), sigma, 0.5, gap);
            if needed > 0.5 {
                assert!((left(needed) - RESPONSE).abs() < 1e-9 && left(needed + 1.0) > RESPONSE);
            }
            assert_eq!(left(0.4), 0.0);
        }
    }
}
