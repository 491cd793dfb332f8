//! The safe distances of responsibility-sensitive safety (RSS; Shalev-Shwartz, Shammah and Shashua 2017).
//!
//! During the response time ρ each may still speed up by a⁺; then it brakes with at least b, and a leader with at most B:
//!
//! ```text
//! same direction:      d = [ V ρ + a⁺ ρ²/2 + (V + ρ a⁺)²/(2b) − Vᵢ²/(2B) ]₊
//! opposite directions: d = V ρ + a⁺ ρ²/2 + (V + ρ a⁺)²/(2b) + the same of the foe
//! lateral:             d = [ m + u ρ + a ρ²/2 + (u + ρ a)²/(2c) + the same of the foe ]₊
//! ```
//!
//! with the lateral speeds u towards each other, 0 or more, the lateral acceleration a and braking c, and the margin m. A road
//! user that moves away sideways counts with what it moves away within ρ. As in Intel's ad-rss-lib, the margin is within the
//! brackets; in the paper it stands before them. The paper leaves the values open; these are the
//! ones of CARLA's RSS sensor and Intel's ad-rss-lib. Which of two oncoming ones keeps to its lane is not known here, so both
//! brake with b.

use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// Response time ρ in s.
pub const RESPONSE: Second = 1.0;
/// Longitudinal acceleration a⁺ during the response time, in m/s².
pub const ACCELERATION: MetrePerSecondSquared = 3.5;
/// Deceleration b with which every road user brakes at least, in m/s².
pub const LEAST_BRAKING: MetrePerSecondSquared = 4.0;
/// Deceleration B with which a leader brakes at most, in m/s².
pub const MOST_BRAKING: MetrePerSecondSquared = 8.0;
/// Lateral acceleration a during the response time, in m/s².
pub const LATERAL_ACCELERATION: MetrePerSecondSquared = 0.2;
/// Lateral deceleration c, in m/s².
pub const LATERAL_BRAKING: MetrePerSecondSquared = 0.8;
/// Lateral margin m, in m.
pub const LATERAL_MARGIN: Metre = 0.1;

/// The distance until a road user stands that first speeds up and then brakes.
fn way(speed: f64, acceleration: f64, braking: f64) -> Metre {
    let then = speed + RESPONSE * acceleration;
    (speed + then) / 2.0 * RESPONSE + then * then / (2.0 * braking)
}

/// The safe distance in m behind a leader.
pub fn same_direction(speed: MetrePerSecond, leader: MetrePerSecond) -> Metre {
    (way(speed, ACCELERATION, LEAST_BRAKING) - leader * leader / (2.0 * MOST_BRAKING)).max(0.0)
}

/// The safe distance in m between two that drive towards each other.
pub fn opposite_directions(speed: MetrePerSecond, foe: MetrePerSecond) -> Metre {
    way(speed, ACCELERATION, LEAST_BRAKING) + way(foe, ACCELERATION, LEAST_BRAKING)
}

/// The safe lateral distance in m of two with these lateral speeds towards each other, below 0 for one that moves away.
pub fn lateral(speeds: [MetrePerSecond; 2]) -> Metre {
    let approach = speeds.map(|speed| {
        let then = speed + RESPONSE * LATERAL_ACCELERATION;
        if then >= 0.0 { way(speed, LATERAL_ACCELERATION, LATERAL_BRAKING) } else { (speed + then) / 2.0 * RESPONSE }
    });
    (LATERAL_MARGIN + approach.iter().sum::<f64>()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distance by small steps.
    fn driven(mut speed: f64, acceleration: f64, braking: f64) -> f64 {
        const STEP: f64 = 1e-5;
        let (mut way, mut time) = (0.0, 0.0);
        while time < RESPONSE || speed > 0.0 {
            let next = speed + STEP * if time < RESPONSE { acceleration } else { -braking };
            way += (speed + next.max(0.0)) / 2.0 * STEP;
            (speed, time) = (next, time + STEP);
        }
        way
    }

    #[test]
    fn the_distances_are_those_of_small_steps() {
        for (speed, foe) in [(10.0, 10.0), (30.0, 5.0), (2.0, 0.0), (8.0, 14.0)] {
            let (own, of_foe) = (driven(speed, 3.5, 4.0), driven(foe, 3.5, 4.0));
            let leader = foe * foe / 16.0;
            assert!((same_direction(speed, foe) - (own - leader)).abs() < 2e-3);
            assert!((opposite_directions(speed, foe) - (own + of_foe)).abs() < 2e-3);
        }
        let still = driven(0.0, 0.2, 0.8);
        assert!((lateral([0.0, 1.5]) - (0.1 + still + driven(1.5, 0.2, 0.8))).abs() < 1e-3);
    }

    #[test]
    fn a_leader_that_is_much_faster_needs_no_distance() {
        assert_eq!(same_direction(1.0, 40.0), 0.0);
        assert_eq!(lateral([0.0, -3.0]), 0.0);
    }
}
