//! Finds the recording's lanes in the net, and a road user's offset from its lane.

use super::recorded_step::RecordedRow;
use closecall::detection::path::Foot;
use closecall::geometry::Point;
use closecall::geometry::rectangle::direction;
use closecall::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};
use closecall::util::units::{Metre, Radian};

/// A junction has fewer parts of a lane one behind the other.
const MOST_PARTS: usize = 10;

/// Cosine of the angle between a lane and the heading of a road user that goes straight along it in the other direction: within
/// 1.1°, by which places and angles may be rounded and lanes may bend.
const OPPOSITE: f64 = -0.9998;

/// The net's lane for each of the recording's lanes; each is looked up once.
#[derive(Debug, Default)]
pub(super) struct Lanes {
    known: Vec<Option<LaneIndex>>,
}

impl Lanes {
    /// The lane for a [`RecordedRow::lane`], if the net has it; `id` tells a lane's id.
    #[inline]
    pub fn lane<'a>(&mut self, lane: u32, id: impl Fn(u32) -> &'a str, net: &Net) -> Option<LaneIndex> {
        // The recording numbers its lanes in the order in which they appear.
        while self.known.len() <= lane as usize {
            self.known.push(net.lane(id(self.known.len() as u32)));
        }
        self.known[lane as usize]
    }
}

/// The edge that a lane is on. For a lane in a junction, the edge before the junction and the edge behind it.
pub(super) fn edges_of(net: &Net, lane: LaneIndex) -> Option<(EdgeIndex, Option<EdgeIndex>)> {
    let edge_of = |lane: LaneIndex| net.lanes[lane].edge;
    let function = |lane: LaneIndex| net.edges[edge_of(lane)].function;
    match function(lane) {
        EdgeFunction::Normal => Some((edge_of(lane), None)),
        EdgeFunction::Internal => {
            let before = std::iter::successors(Some(lane), |lane| net.lanes[*lane].from.first().copied());
            let before = before.take(MOST_PARTS).find(|lane| function(*lane) == EdgeFunction::Normal)?;
            let behind = net.lanes[lane].links.first().map(|link| edge_of(link.to));
            Some((edge_of(before), behind))
        }
        _ => None,
    }
}

/// Whether a road user's heading is against its lane.
pub(super) fn is_against(row: &RecordedRow, net: &Net, lane: LaneIndex) -> bool {
    foot(row, net, lane).direction.dot(&direction(heading(row))) < 0.0
}

/// Whether a road user goes straight along its lane in the other direction, as when it overtakes on the opposite lane. In a
/// sharp turn its heading is turned by more.
pub(super) fn is_opposite(row: &RecordedRow, net: &Net, lane: LaneIndex) -> bool {
    foot(row, net, lane).direction.normalize().dot(&direction(heading(row))) < OPPOSITE
}

/// The distance of a road user from its lane's centre line.
pub(super) fn distance(row: &RecordedRow, net: &Net, lane: LaneIndex) -> Metre {
    (foot(row, net, lane).point - Point::new(row.x, row.y)).norm()
}

fn foot(row: &RecordedRow, net: &Net, lane: LaneIndex) -> Foot {
    Foot::on_any_part(net.lines.line(lane.0), Point::new(row.x, row.y))
}

/// The heading, counter-clockwise from +x.
#[inline]
pub(super) fn heading(row: &RecordedRow) -> Radian {
    (90.0 - row.angle).to_radians()
}
