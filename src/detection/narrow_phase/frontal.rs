//! Frontal on one straight line: the two paths meet where the areas that both need to stop meet.

use super::approach::{ALIKE, Approach, Ego};
use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::Metre;

/// The conflict point of two that drive towards each other with `ahead` m between their fronts. The distance of each
/// ends where the area that the other needs to stop begins. The ego is the one with the longer distance.
pub(super) fn in_line(a: &Participant, b: &Participant, ahead: Metre) -> Option<Approach> {
    let distance = |ego: &Participant, foe: &Participant| {
        let distance = (ahead - foe.stop.min(foe.reach)).max(0.0);
        (distance <= ego.reach).then_some(distance)
    };
    let (roles, ego_distance) = match (distance(a, b), distance(b, a)) {
        (None, None) => return None,
        (Some(of_a), Some(of_b)) if (of_a - of_b).abs() <= ALIKE => (Ego::of_equals([a, b]), of_a),
        (Some(a), Some(b)) => (Ego::first_if(a > b), a.max(b)),
        (Some(a), None) => (Ego::First, a),
        (None, Some(b)) => (Ego::Second, b),
    };
    let [ego, foe] = roles.then_foe([a, b]);
    let centre = ego.rectangle.centre + ego.rectangle.axis * ego_distance;
    let conflict_point = ConflictPoint {
        ego_distance,
        foe_distance: ahead.max(0.0) - ego_distance,
        ego_rectangle: Rectangle { centre, ..ego.rectangle },
        ego_behind: 0.0,
        foe_axis: Some(foe.rectangle.axis),
        foe_leads: false,
    };
    Some(Approach { ego: roles, conflict_point })
}
