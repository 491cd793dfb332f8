//! Modified DRAC (Kuang, Qu, Weng and Etemad-Shahidi 2015): the deceleration that still avoids contact with a leader that
//! keeps its speed if the follower begins to brake only after its perception–reaction time R.
//!
//! ```text
//! MDRAC = (V − Vᵢ) / (2 (TTC − R)),   TTC = gap / (V − Vᵢ)
//! ```

use super::drac::LIMIT;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// The perception–reaction time R in s: the default of SUMO's device.ssm.
pub(crate) const REACTION: Second = 1.0;

/// MDRAC in m/s², at most `LIMIT`, also where contact comes within R; none if the follower is not faster.
pub fn mdrac(gap: Metre, closing: MetrePerSecond) -> Option<MetrePerSecondSquared> {
    if closing <= 0.0 {
        return None;
    }
    let left = gap / closing - REACTION;
    Some(if left > 0.0 { (closing / (2.0 * left)).min(LIMIT) } else { LIMIT })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_follower_that_waits_and_brakes_with_it_just_stays_behind() {
        for (gap, closing) in [(30.0, 10.0), (12.0, 5.0), (80.0, 14.0)] {
            let braking = mdrac(gap, closing).unwrap();
            // Closing on for the reaction time, then braking the closing speed away.
            let used = closing * REACTION + closing * closing / (2.0 * braking);
            assert!((used - gap).abs() < 1e-12, "{used} of {gap}");
        }
    }

    #[test]
    fn within_the_reaction_time_nothing_is_enough() {
        assert_eq!([mdrac(9.0, 10.0), mdrac(0.0, 1.0), mdrac(10.1, 10.0)], [Some(LIMIT); 3]);
        assert_eq!([mdrac(9.0, 0.0), mdrac(9.0, -3.0)], [None; 2]);
    }
}
