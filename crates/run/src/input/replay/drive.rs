//! What one vehicle drove: its edges, and the step in which it reached each.
//!
//! A vehicle that overtakes on the opposite lane is on an edge that it does not drive along: its heading is against the
//! lane. After a sharp turn the heading of a long vehicle is against its new lane too, but only until its rear has
//! followed. An edge therefore counts from when the vehicle came there, if it later drives along it.

use closecall::traffic::net::EdgeIndex;
use closecall::util::units::{Metre, MetrePerSecond, Second};

/// No road user is faster.
const FASTEST: MetrePerSecond = 100.0;

/// The step of an edge that was not reached before the recording or the vehicle's part in it ended.
pub(super) const NEVER: u32 = u32::MAX;

/// An edge that was reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reached {
    pub edge: EdgeIndex,
    /// The number of the step.
    pub step: u32,
    /// How far the vehicle can have driven since it was last seen on an edge.
    pub unseen: Metre,
}

/// A step of the recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// Its number.
    pub step: u32,
    pub time: Second,
    /// The time of the step before.
    pub before: Second,
}

/// What a vehicle has driven so far.
#[derive(Debug, Default)]
pub(super) struct Drive {
    reached: Vec<Reached>,
    /// While it is in a junction, and until it is seen elsewhere, the edge behind the junction.
    ahead: Option<EdgeIndex>,
    /// The edge that it is on with its heading against the lane, and the step in which it came there.
    against: Option<(EdgeIndex, u32)>,
    /// Since when it has not been seen on an edge that it drives along.
    unseen_since: Option<Second>,
}

impl Drive {
    /// It is along its lane on this edge, or in the junction between this edge and `ahead`.
    pub fn along(&mut self, edge: EdgeIndex, ahead: Option<EdgeIndex>, moment: &Moment) {
        let against = self.against.take().filter(|(known, _)| *known == edge);
        let was_ahead = std::mem::replace(&mut self.ahead, ahead);
        let is_same = self.reached.last().is_some_and(|last| last.edge == edge);
        if is_same && (was_ahead == ahead || was_ahead.is_none()) {
            self.unseen_since = None;
            return;
        }
        let step = against.map_or(moment.step, |(_, step)| step);
        let passed = was_ahead.filter(|passed| *passed != edge);
        self.reach(passed.into_iter().chain([edge]), step, moment);
    }

    /// Its heading is against its lane, which is on this edge, or in the junction between this edge and `ahead`.
    pub fn against(&mut self, edge: EdgeIndex, ahead: Option<EdgeIndex>, moment: &Moment) {
        // In a junction it is in a sharp turn if it came from there; an overtaker would be on an oncoming path.
        let came_from_there = self.ahead == Some(edge) || self.reached.last().is_some_and(|last| last.edge == edge);
        if ahead.is_some() && came_from_there {
            return self.along(edge, ahead, moment);
        }
        if self.against.is_none_or(|(known, _)| known != edge) {
            self.against = Some((edge, moment.step));
        }
        // Once it has left a junction it is on the edge behind, or beside it.
        if ahead.is_none()
            && let Some(edge) = self.ahead.take()
        {
            self.reach([edge], moment.step, moment);
        }
        self.lose_sight(moment.before);
    }

    fn reach(&mut self, edges: impl IntoIterator<Item = EdgeIndex>, step: u32, moment: &Moment) {
        let unseen = FASTEST * (moment.time - self.unseen_since.take().unwrap_or(moment.before));
        self.reached.extend(edges.into_iter().map(|edge| Reached { edge, step, unseen }));
    }

    /// It has not been seen on an edge since this time.
    pub(crate) fn lose_sight(&mut self, since: Second) {
        self.unseen_since.get_or_insert(since);
    }

    /// All that it reached. From within a junction it goes on to the edge behind.
    pub fn finish(mut self) -> Vec<Reached> {
        self.reached.extend(self.ahead.map(|edge| Reached { edge, step: NEVER, unseen: 0.0 }));
        self.reached
    }
}

#[cfg(test)]
mod tests {
    use crate::input::replay::drive::*;

    const A: EdgeIndex = EdgeIndex(0);
    const B: EdgeIndex = EdgeIndex(1);
    const C: EdgeIndex = EdgeIndex(2);

    /// The steps of a vehicle, one after the other: along an edge, in a junction, or against an edge's lane.
    enum Seen {
        Along(EdgeIndex),
        Between(EdgeIndex, EdgeIndex),
        Against(EdgeIndex),
        AgainstBetween(EdgeIndex, EdgeIndex),
    }
    use Seen::{Against, AgainstBetween, Along, Between};

    fn reached(seen: &[Seen]) -> Vec<(EdgeIndex, u32)> {
        let mut drive = Drive::default();
        for (step, seen) in (0..).zip(seen) {
            let moment = Moment { step, time: f64::from(step), before: f64::from(step) - 1.0 };
            match *seen {
                Along(edge) => drive.along(edge, None, &moment),
                Between(edge, ahead) => drive.along(edge, Some(ahead), &moment),
                Against(edge) => drive.against(edge, None, &moment),
                AgainstBetween(edge, ahead) => drive.against(edge, Some(ahead), &moment),
            }
        }
        drive.finish().iter().map(|reached| (reached.edge, reached.step)).collect()
    }

    #[test]
    fn overtaking_on_the_opposite_lane_reaches_no_edge() {
        assert_eq!(reached(&[Along(A), Against(B), Against(B), Along(A)]), [(A, 0)]);
        assert_eq!(reached(&[Along(A), Against(B), Along(C)]), [(A, 0), (C, 2)]);
    }

    #[test]
    fn a_long_vehicle_has_turned_when_its_front_has() {
        assert_eq!(reached(&[Along(A), Against(B), Against(B), Along(B)]), [(A, 0), (B, 1)]);
    }

    #[test]
    fn a_junction_that_is_left_for_the_opposite_lane_is_behind() {
        assert_eq!(
            reached(&[Along(A), Between(A, B), Against(A), Along(B)]),
            [(A, 0), (B, 2)],
            "turned, then overtakes"
        );
        assert_eq!(
            reached(&[Along(A), AgainstBetween(A, B), Against(A), Along(C)]),
            [(A, 0), (B, 2), (C, 3)],
            "across"
        );
        assert_eq!(reached(&[Along(A), AgainstBetween(C, B), Along(A)]), [(A, 0)], "overtakes through a junction");
        assert_eq!(reached(&[Between(A, B), Against(C), Along(B)]), [(A, 0), (B, 1)], "overtakes beside B");
        assert_eq!(reached(&[Between(A, B), Against(B), Along(B)]), [(A, 0), (B, 1)], "a sharp turn");
    }

    #[test]
    fn a_junction_shows_the_edges_before_and_behind() {
        assert_eq!(reached(&[Between(A, B), Between(A, B), Along(B)]), [(A, 0), (B, 2)]);
        assert_eq!(reached(&[Between(A, B), Along(C)]), [(A, 0), (B, 1), (C, 1)]);
        assert_eq!(reached(&[Along(A), Between(B, C), Along(C)]), [(A, 0), (B, 1), (C, 2)]);
        assert_eq!(reached(&[Along(A), Between(A, B), Along(A)]), [(A, 0), (B, 2), (A, 2)], "round a ring");
        assert_eq!(reached(&[Along(A), Between(A, B)]), [(A, 0), (B, NEVER)]);
        assert_eq!(reached(&[Between(A, B), Between(A, C)]), [(A, 0), (B, 1), (A, 1), (C, NEVER)], "B is short");
        assert_eq!(reached(&[Between(A, B), AgainstBetween(B, A)]), [(A, 0), (B, 1), (A, NEVER)], "turns at once");
    }

    #[test]
    fn what_may_be_driven_unseen_grows_with_the_absence() {
        let mut drive = Drive::default();
        drive.along(A, None, &Moment { step: 0, time: 0.0, before: 0.0 });
        drive.lose_sight(0.5);
        drive.along(B, None, &Moment { step: 1, time: 3.5, before: 3.0 });
        drive.along(C, None, &Moment { step: 2, time: 4.0, before: 3.5 });
        assert_eq!(drive.finish().iter().map(|reached| reached.unseen).collect::<Vec<_>>(), [0.0, 300.0, 50.0]);
    }
}
