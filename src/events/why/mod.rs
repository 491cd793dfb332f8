//! What the two of a conflict were doing, and why it came about.
//!
//! Evaluated in the steps in which an event gets worse, and in each step of frontal and side conflicts. The manoeuvre is that
//! of the step with the smallest margin; a cause holds for the conflict if it holds in one that was the worst until then, and
//! how one entered a junction in any step.

mod cause;
mod manoeuvre;
mod pair;

pub use cause::{Cause, Causes};
pub use manoeuvre::Manoeuvre;
pub use pair::Surroundings;

use super::past::Past;
use crate::detection::encounter::Encounter;
use crate::traffic::frame::Frame;
use crate::traffic::net::LaneIndex;
use crate::traffic::roster::Roster;
use pair::Pair;

/// What the two of a conflict were doing, and why it came about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Why {
    /// None where it is not known.
    pub manoeuvre: Option<Manoeuvre>,
    pub causes: Causes,
    /// The lanes that the ego and the foe are on.
    pub lanes: [Option<LaneIndex>; 2],
    /// Whether one of them has jumped to the lanes that the manoeuvre follows from.
    has_jumped: bool,
}

impl Why {
    /// That of one step.
    pub fn of(step: (&Frame, &Roster, &Encounter), around: Surroundings, past: &Past) -> Self {
        let pair = Pair::of(step, around, past);
        let manoeuvre = Manoeuvre::of(&pair);
        let has_jumped = pair.both().iter().any(|(party, _)| party.course.has_jumped);
        let lanes = [&pair.ego, &pair.foe].map(|party| party.course.at(0.0));
        Self { manoeuvre, causes: Causes::of(&pair, manoeuvre), lanes, has_jumped }
    }

    /// The same with a later step that is worse.
    pub fn then(self, later: Self) -> Self {
        let [first, second] = if later.has_jumped { [self, later] } else { [later, self] };
        let mut causes = self.causes;
        causes.add(later.causes);
        Self { manoeuvre: first.manoeuvre.or(second.manoeuvre), causes, ..later }
    }
}
