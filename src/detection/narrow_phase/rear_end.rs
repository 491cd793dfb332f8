//! Rear-end in one lane: one-dimensional.

use super::conflict_point::Meeting;
use super::participant::Mover;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::Metre;

/// The meeting of a follower with its leader, `ahead` m in front of it on the same straight line; none where the
/// follower does not get there.
pub fn in_line(ego: &Mover, foe: &Mover, ahead: Metre) -> Option<Meeting> {
    let ego_way = ahead.max(0.0);
    (ego_way <= ego.reach).then(|| Meeting {
        ego_way,
        foe_way: 0.0,
        ego: Rectangle { centre: ego.rectangle.centre + ego.rectangle.axis * ego_way, ..ego.rectangle },
        foe_axis: Some(foe.rectangle.axis),
        leads: true,
    })
}
