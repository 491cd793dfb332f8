//! Rear-end on one straight line.

use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::Metre;

/// The conflict point of a follower and its leader, `ahead` m in front of it on the same straight line; none if the
/// follower does not get there.
pub(super) fn in_line(ego: &Participant, foe: &Participant, ahead: Metre) -> Option<ConflictPoint> {
    let ego_distance = ahead.max(0.0);
    (ego_distance <= ego.reach).then(|| ConflictPoint {
        ego_distance,
        foe_distance: 0.0,
        ego_rectangle: Rectangle { centre: ego.rectangle.centre + ego.rectangle.axis * ego_distance, ..ego.rectangle },
        ego_behind: 0.0,
        foe_axis: Some(foe.rectangle.axis),
        foe_leads: true,
    })
}
