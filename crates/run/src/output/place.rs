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

/// A road user's lane, the known one or else the nearest, and its position along it, in SUMO's metres of the lane to the last
/// digit.
pub(super) fn on_lane(net: &Net, known: Option<LaneIndex>, front: Point) -> Option<(&str, Metre)> {
    let lane = known.or_else(|| net.lane_at(front))?;
    let (line, drawn) = (net.lines.line(lane.0), net.lines.length(lane.0));
    let rounded = if drawn > 0.0 { net.lanes[lane].length / drawn } else { 1.0 };
    Some((net.lane_id(lane), Foot::on_any_part(line, front).distance * rounded))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::output::place::*;

    #[test]
    fn a_position_is_that_of_the_simulator() {
        // SUMO's position p is where p · drawn / length of the shape are.
        for length in [100.0, 100.01, 100.5, 99.1, 250.0] {
            let lane = format!(r#"<lane id="a_0" index="0" length="{length}" shape="0,0 60,0 100,0"/>"#);
            let text = format!(r#"<net><edge id="a" from="w" to="e">{lane}</edge></net>"#);
            let net = crate::net::parse(Path::new("town.net.xml"), text).unwrap();
            for x in [0.0, 30.0, 95.0] {
                let (_, position) = on_lane(&net, None, Point::new(x, 0.0)).unwrap();
                assert!((position - x * length / 100.0).abs() < 1e-9, "{position} at {x} m of {length} m");
            }
        }
    }
}
