//! The safe lateral distance of responsibility-sensitive safety (RSS; Shalev-Shwartz, Shammah and Shashua 2017); the
//! longitudinal ones are in [`crate::braking::rss`].
//!
//! ```text
//! lateral: d = [ m + u ρ + a ρ²/2 + (u + ρ a)²/(2c) + the same of the foe ]₊
//! ```
//!
//! with the lateral speeds u towards each other, 0 or more, the lateral acceleration a and braking c, and the margin m. A road
//! user that moves away sideways counts with what it moves away within ρ. As in Intel's ad-rss-lib, the margin is within the
//! brackets; in the paper it stands before them. The values are those of CARLA's RSS sensor and Intel's ad-rss-lib.

use crate::braking::rss::RESPONSE;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared};

/// Lateral acceleration a during the response time, in m/s².
pub(crate) const ACCELERATION: MetrePerSecondSquared = 0.2;
/// Lateral deceleration c, in m/s².
pub const BRAKING: MetrePerSecondSquared = 0.8;
/// Lateral margin m, in m.
pub const MARGIN: Metre = 0.1;

/// The safe lateral distance in m of two with these lateral speeds towards each other, below 0 when moving away.
pub fn lateral(speeds: [MetrePerSecond; 2]) -> Metre {
    let approach = speeds.map(|speed| {
        let then = speed + RESPONSE * ACCELERATION;
        let stops = if then >= 0.0 { then * then / (2.0 * BRAKING) } else { 0.0 };
        (speed + then) / 2.0 * RESPONSE + stops
    });
    (MARGIN + approach.iter().sum::<f64>()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lateral_distance_is_that_of_the_formula() {
        // 0.1 m + 0.1 m + 0.2²/1.6 m of the standing one, 1.5 m + 0.1 m + 1.7²/1.6 m of the other.
        assert!((lateral([0.0, 1.5]) - (0.1 + 0.125 + 1.6 + 1.80625)).abs() < 1e-12);
        assert_eq!(lateral([0.0, -3.0]), 0.0);
    }
}
