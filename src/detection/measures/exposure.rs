//! What a step adds to TET and TIT (Minderhoud and Bovy 2001): the time exposed to a TTC of at most TTC*, and the integral of
//! what the TTC lacks to TTC*.
//!
//! ```text
//! TET = Σ Δt            over the steps with TTC ≤ TTC*
//! TIT = Σ (TTC* − TTC) Δt
//! ```

use crate::util::units::Second;

/// The threshold TTC* in s: SUMO's device.ssm's default.
pub(crate) const THRESHOLD: Second = 3.0;

/// The part of a step that counts in TET: all of it, or none.
pub fn exposed(ttc: Option<Second>) -> f64 {
    f64::from(ttc.is_some_and(|ttc| ttc <= THRESHOLD))
}

/// What the TTC lacks to the threshold, in s.
pub fn lacks(ttc: Option<Second>) -> Second {
    ttc.map_or(0.0, |ttc| (THRESHOLD - ttc).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_ttc_up_to_the_threshold_counts() {
        assert_eq!([Some(0.0), Some(3.0), Some(3.1), None].map(exposed), [1.0, 1.0, 0.0, 0.0]);
        assert_eq!([Some(0.0), Some(2.5), Some(3.1), None].map(lacks), [3.0, 0.5, 0.0, 0.0]);
    }
}
