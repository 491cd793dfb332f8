//! Where a conflict is: on which lanes, on which edge or in which junction.

use closecall::detection::path::Foot;
use closecall::geometry::Point;
use closecall::traffic::net::{LaneIndex, Net};
use closecall::util::units::Metre;

/// The edge of the lane of this id; empty without a lane.
pub(super) fn edge_of(lane: &str) -> &str {
    lane.rsplit_once('_').map_or("", |(edge, _)| edge)
}

/// The junction that the lane of this id is within; empty where it is not within one.
pub(super) fn junction_of(lane: &str) -> &str {
    let within = edge_of(lane).strip_prefix(':');
    within.and_then(|edge| edge.rsplit_once('_')).map_or("", |(junction, _)| junction)
}

/// The lane of a road user that is here: the one that is known, or else the nearest; with how far along it the road user is.
pub(super) fn on_lane(net: &Net, known: Option<LaneIndex>, front: Point) -> Option<(&str, Metre)> {
    let lane = known.or_else(|| net.lane_at(front))?;
    Some((net.lane_id(lane), Foot::on_any_part(net.lines.line(lane.0), front).distance))
}
