//! What the two of a conflict were doing, and why it came about.
//!
//! Evaluated in the steps in which an event gets worse, and in each step of frontal and side conflicts. The manoeuvre is that
//! of the step with the smallest margin; a cause holds for the conflict if it holds in a step that was the worst so far, and
//! how one entered a junction in any step.

mod artefact;
mod cause;
mod evidence;
mod manoeuvre;
mod pair;
mod sight;
mod waiting;

pub use artefact::Artefact;
pub use cause::{Cause, Causes};
pub use manoeuvre::Manoeuvre;
pub(super) use pair::Pair;
pub use pair::STANDS;
pub use pair::Surroundings;
pub(super) use waiting::one_will_wait;

use crate::traffic::lane_change::LaneChangeReason;
use crate::traffic::net::LaneIndex;
use evidence::causes_of;
use manoeuvre::changed_into;

/// What the two of a conflict were doing, and why it came about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Why {
    /// None where it is not known.
    pub manoeuvre: Option<Manoeuvre>,
    pub causes: Causes,
    /// SUMO's reason for the lane change, where that is a cause and known.
    pub lane_change_reason: Option<LaneChangeReason>,
    /// The lanes that the ego and the foe are on.
    pub lanes: [Option<LaneIndex>; 2],
}

impl Why {
    /// That of one step.
    pub fn of(pair: &Pair) -> Self {
        let manoeuvre = Manoeuvre::of(pair);
        let lanes = [&pair.ego, &pair.foe].map(|party| party.course.at(0.0));
        let causes = causes_of(pair, manoeuvre);
        let lane_change_reason = if causes.has(Cause::ChangedLane) { lane_change_reason(pair) } else { None };
        Self { manoeuvre, causes, lane_change_reason, lanes }
    }

    /// The same with a later step that is worse.
    pub fn then(self, later: Self) -> Self {
        let manoeuvre = later.manoeuvre.or(self.manoeuvre);
        let mut causes = self.causes;
        causes.add(later.causes);
        let causes = causes.plausible_for(manoeuvre);
        let known = later.lane_change_reason.or(self.lane_change_reason);
        Self { manoeuvre, causes, lane_change_reason: known.filter(|_| causes.has(Cause::ChangedLane)), ..later }
    }
}

/// Why the one changed lanes that did so last.
fn lane_change_reason(pair: &Pair) -> Option<LaneChangeReason> {
    let changed = pair.both().into_iter().filter_map(|(one, other)| Some((changed_into(pair, one, other)?, one)));
    let (time, one) = changed.max_by(|one, other| one.0.total_cmp(&other.0))?;
    one.course.change.filter(|change| change.time == time)?.reason
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_lanes_is_no_cause_once_they_follow() {
        let step = |manoeuvre, causes: &[Cause]| Why {
            manoeuvre: Some(manoeuvre),
            causes: causes.iter().copied().collect(),
            ..Why::default()
        };
        let changes = step(Manoeuvre::CutIn, &[Cause::ChangedLane, Cause::TooFast]);
        let causes = |later| changes.then(step(later, &[])).causes.to_string();
        assert_eq!([Manoeuvre::Following, Manoeuvre::LaneChange].map(causes), ["too_fast", "changed_lane too_fast"]);
    }
}
