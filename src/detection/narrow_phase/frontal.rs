//! Frontal on one straight line: the two paths meet where the areas that both need to stop meet.

use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::Metre;

/// The meeting of two that drive towards each other with `ahead` m between their fronts. Each one's way ends where
/// the area that the other needs to stop begins; the ego is the one with the longer way.
pub(super) fn in_line(
    a: &Participant,
    b: &Participant,
    ahead: Metre,
    a_is_smaller: &impl Fn() -> bool,
) -> Option<(bool, ConflictPoint)> {
    let way = |ego: &Participant, foe: &Participant| {
        let way = (ahead - foe.stop.min(foe.reach)).max(0.0);
        (way <= ego.reach).then_some(way)
    };
    let (ego_is_a, ego_distance) = match (way(a, b), way(b, a)) {
        (None, None) => return None,
        (Some(a), Some(b)) => (a > b || (a == b && a_is_smaller()), a.max(b)),
        (Some(a), None) => (true, a),
        (None, Some(b)) => (false, b),
    };
    let (ego, foe) = if ego_is_a { (a, b) } else { (b, a) };
    let centre = ego.rectangle.centre + ego.rectangle.axis * ego_distance;
    let meeting = ConflictPoint {
        ego_distance,
        foe_distance: ahead.max(0.0) - ego_distance,
        ego: Rectangle { centre, ..ego.rectangle },
        foe_axis: Some(foe.rectangle.axis),
        leads: false,
    };
    Some((ego_is_a, meeting))
}
