//! The lanes a road user comes from and goes to, which determine its manoeuvre.

use smallvec::SmallVec;

use crate::geometry::Point;
use crate::traffic::lane_change::LaneChangeReason;
use crate::traffic::net::{EdgeIndex, LaneIndex, Net};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// A lane of a [`Course`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// The lane.
    pub lane: LaneIndex,
    /// How far ahead of the front bumper it begins; negative behind.
    pub begin: Metre,
    /// How far ahead of the front bumper it ends.
    pub end: Metre,
}

/// A change from a lane to another of the same edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneChange {
    /// The first step in which it was on the new lane.
    pub time: Second,
    /// The lane before.
    pub from: LaneIndex,
    /// The lane after.
    pub to: LaneIndex,
    /// Why; none where that is not known.
    pub reason: Option<LaneChangeReason>,
}

impl LaneChange {
    /// Whether two changed at once between the same lanes.
    pub(crate) fn is_with(&self, other: &Self) -> bool {
        (self.time, self.from, self.to) == (other.time, other.from, other.to)
    }
}

/// The lanes of a road user from behind its rear to beyond where it can stop, and how it drives along them.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The lanes in driving order; empty where they are not known.
    pub stretches: SmallVec<[Stretch; 6]>,
    /// Whether it drives against the direction of its lane.
    pub is_against: bool,
    /// Whether it has jumped to these lanes since the last step.
    pub has_jumped: bool,
    /// Its last change of lanes.
    pub change: Option<LaneChange>,
    /// Its lateral speed, positive to the left.
    pub lateral_speed: MetrePerSecond,
    /// How hard it brakes now; 0 or more.
    pub deceleration: MetrePerSecondSquared,
    /// How long ago its speed fell by more than brakes can do within a step; infinite where it never did.
    pub since_impossible_stop: Second,
}

impl Default for Course {
    fn default() -> Self {
        Self {
            stretches: SmallVec::new(),
            is_against: false,
            has_jumped: false,
            change: None,
            lateral_speed: 0.0,
            deceleration: 0.0,
            since_impossible_stop: Second::INFINITY,
        }
    }
}

impl Course {
    /// The same of a person of which SUMO tells the edge.
    pub fn on_edge(mut self, net: Option<&Net>, edge: Option<EdgeIndex>, front: Point) -> Self {
        if let Some(lane) = net.zip(edge).and_then(|(net, edge)| net.lane_of_edge_at(edge, front)) {
            self.stretches.push(Stretch { lane, begin: f64::NEG_INFINITY, end: f64::INFINITY });
        }
        self
    }

    /// The lane at a distance ahead of the front bumper; the first or last beyond either end.
    pub fn at(&self, ahead: Metre) -> Option<LaneIndex> {
        let found = self.stretches.iter().find(|stretch| stretch.end > ahead);
        found.or(self.stretches.last()).map(|stretch| stretch.lane)
    }

    /// Where on its way it takes a lane.
    pub fn of(&self, lane: LaneIndex) -> Option<&Stretch> {
        self.stretches.iter().find(|stretch| stretch.lane == lane)
    }
}
