//! How far ahead a pair is predicted: until both stand, or further if the log's condition looks further.
//!
//! If a pair meets before both stand, its gap and μ are measured there, so they are the same under every condition. Only other
//! pairs are predicted again with the longer distances.

use crate::braking::stopping_distance;
use crate::detection::measures::ttc::HORIZON;
use crate::options::condition::LookAhead;
use crate::traffic::frame::State;
use crate::traffic::profile::Profile;
use crate::util::units::Metre;

/// How far ahead pairs are predicted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cover {
    /// Until both stand, and ε further.
    UntilTheyStand,
    /// As far as a condition looks.
    Further(LookAhead),
}

impl Cover {
    /// The distance within which a road user of this type may be met.
    #[inline(always)]
    pub fn stop(&self, state: &State, profile: &Profile) -> Metre {
        match self {
            Self::UntilTheyStand => stop(state, profile),
            Self::Further(look) => further(look, state, profile),
        }
    }

    /// The same and ε further.
    #[inline(always)]
    pub fn reach(&self, state: &State, profile: &Profile, epsilon: Metre) -> Metre {
        match self {
            Self::UntilTheyStand => reach(state, profile, epsilon),
            Self::Further(look) => match further(look, state, profile) {
                0.0 => 0.0,
                distance => distance + epsilon,
            },
        }
    }
}

fn further(look: &LookAhead, state: &State, profile: &Profile) -> Metre {
    look.distance(if state.moves() { state.speed } else { 0.0 }, stop(state, profile), HORIZON)
}

/// The distance until a road user of this type stands.
#[inline(always)]
pub(super) fn stop(state: &State, profile: &Profile) -> Metre {
    if state.moves() { stopping_distance(state.speed, &profile.brakes) } else { 0.0 }
}

/// The distance until a road user of this type stands, and ε further. ε is a reserve for braking: a standing road user reaches
/// no further than its own rectangle.
#[inline(always)]
pub(super) fn reach(state: &State, profile: &Profile, epsilon: Metre) -> Metre {
    if state.moves() { stopping_distance(state.speed, &profile.brakes) + epsilon } else { 0.0 }
}
