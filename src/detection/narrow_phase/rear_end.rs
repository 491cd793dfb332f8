//! Rear-end in one lane: one-dimensional.

use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::Metre;

/// The meeting of a follower with its leader, `ahead` m in front of it on the same straight line; none where the
/// follower does not get there.
pub fn in_line(ego: &Participant, foe: &Participant, ahead: Metre) -> Option<ConflictPoint> {
    let ego_distance = ahead.max(0.0);
    (ego_distance <= ego.reach).then(|| ConflictPoint {
        ego_distance,
        foe_distance: 0.0,
        ego: Rectangle { centre: ego.rectangle.centre + ego.rectangle.axis * ego_distance, ..ego.rectangle },
        foe_axis: Some(foe.rectangle.axis),
        leads: true,
    })
}
