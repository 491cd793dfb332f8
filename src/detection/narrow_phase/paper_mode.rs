//! The paper's accurate phase as printed (Guan et al. 2008, fig. 5 to 8), for comparison: straight-line distances, the
//! kind by the current angle.
//!
//! `Dis_P` is the distance of the two centres, a1 and a2 are half the lengths, L2 is the foe's length.

use super::approach::{Approach, Ego};
use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use crate::detection::kind::Kind;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, angle_between, left_of};
use crate::options::thresholds::KindBounds;
use crate::util::units::{Metre, Radian};

/// The result of the paper's flow chart for a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperResult {
    /// Which of the two is the ego, and where it is now.
    pub approach: Approach,
    /// Kind by the current angle.
    pub kind: Kind,
    /// The current angle.
    pub angle: Radian,
    /// The straight-line distance that fig. 5 compares with μ.
    pub distance: Metre,
}

/// Kind and distance by fig. 5. The ego has the other ahead of it. If both or neither do, it is the faster one; at equal
/// speeds, the first.
pub fn measure(a: &Participant, b: &Participant, bounds: KindBounds) -> PaperResult {
    let between = b.rectangle.centre - a.rectangle.centre;
    let a_ahead = between.dot(&a.rectangle.axis) > 0.0;
    let b_ahead = between.dot(&b.rectangle.axis) < 0.0;
    let roles = Ego::first_if(if a_ahead == b_ahead { a.speed >= b.speed } else { a_ahead });
    let [ego, foe] = roles.then_foe([a, b]);
    let angle = angle_between(&ego.rectangle.axis, &foe.rectangle.axis);
    let kind = Kind::at(angle, bounds);
    let a1 = ego.rectangle.half_length;
    let a2 = foe.rectangle.half_length;
    let distance = match kind {
        Kind::Frontal => (between.norm() - a1 - a2).abs(),
        Kind::RearEnd => (between.norm() - a1 - (foe.length() - a2)).abs(),
        Kind::Side => {
            if a_vertex_touches_a_side(&ego.rectangle, &foe.rectangle) {
                0.0
            } else {
                f64::INFINITY
            }
        }
    };
    let conflict_point = ConflictPoint {
        ego_behind: 0.0,
        ego_distance: distance,
        foe_distance: 0.0,
        ego_rectangle: ego.rectangle,
        foe_axis: Some(foe.rectangle.axis),
        foe_leads: kind == Kind::RearEnd,
    };
    PaperResult { approach: Approach { ego: roles, conflict_point }, kind, angle, distance }
}

/// Whether a vertex of one rectangle lies within or on the other (fig. 8). Two rectangles that cross like a plus sign
/// have no such vertex.
pub fn a_vertex_touches_a_side(a: &Rectangle, b: &Rectangle) -> bool {
    a.corners().iter().any(|corner| holds(b, corner)) || b.corners().iter().any(|corner| holds(a, corner))
}

fn holds(rectangle: &Rectangle, point: &Point) -> bool {
    let from_centre = point - rectangle.centre;
    from_centre.dot(&rectangle.axis).abs() <= rectangle.half_length
        && from_centre.dot(&left_of(&rectangle.axis)).abs() <= rectangle.half_width
}
