//! Where a conflict is: on which lanes, on which edge or in which junction, and its degrees of longitude and latitude.

use super::schema::{Context, LoggedConflict};
use crate::detection::path::Foot;
use crate::events::{Conflict, Snapshot};
use crate::geometry::Point;
use crate::traffic::net::{LaneIndex, Net};
use crate::util::units::{Degree, Metre};

/// The edge of the lane of this id; empty without a lane.
pub(super) fn edge_of(lane: &str) -> &str {
    lane.rsplit_once('_').map_or("", |(edge, _)| edge)
}

/// The junction that the lane of this id is within; empty where it is not within one.
pub(super) fn junction_of(lane: &str) -> &str {
    let within = edge_of(lane).strip_prefix(':');
    within.and_then(|edge| edge.rsplit_once('_')).map_or("", |(junction, _)| junction)
}

impl LoggedConflict {
    /// The edge of the conflict point; empty without a lane. Known of the logs of earlier versions, too.
    pub fn edge(&self) -> &str {
        edge_of(&self.lane)
    }

    /// The junction of the conflict point; empty where it is not within one.
    pub fn junction(&self) -> &str {
        junction_of(&self.lane)
    }
}

impl<'a> Context<'a> {
    pub(super) fn lane(&self, conflict: &Conflict) -> &'a str {
        conflict.lane.zip(self.net).map_or("", |(lane, net)| net.lane_id(lane))
    }

    /// The lane of a road user.
    pub(super) fn lane_of(&self, known: Option<LaneIndex>, user: &Snapshot) -> String {
        self.on(known, user).map(|(net, lane)| net.lane_id(lane).to_owned()).unwrap_or_default()
    }

    /// How far along its lane a road user is.
    pub(super) fn position_of(&self, known: Option<LaneIndex>, user: &Snapshot) -> Option<Metre> {
        self.on(known, user).map(|(net, lane)| Foot::on_any_part(net.lines.line(lane.0), user.front).distance)
    }

    fn on(&self, known: Option<LaneIndex>, user: &Snapshot) -> Option<(&'a Net, LaneIndex)> {
        let net = self.net?;
        Some((net, known.or_else(|| net.lane_at(user.front))?))
    }

    /// The longitude and latitude of the conflict point.
    pub(super) fn degrees(&self, conflict: &Conflict) -> Option<[Degree; 2]> {
        self.net?.degrees(Point::new(conflict.x, conflict.y))
    }
}
