//! The paper's accurate phase as printed (Guan et al. 2008, fig. 5 to 8): straight-line distances, the kind by the
//! angle of now.
//!
//! It exists to be compared with. `Dis_P` is the distance of the two centres, a1 and a2 are half the lengths, L2 is
//! the foe's length.

use super::conflict_point::ConflictPoint;
use super::participant::Participant;
use crate::detection::kind::{Kind, kind_at};
use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, angle_between, left_of};
use crate::options::Options;
use crate::util::units::{Metre, Radian};

/// What the paper's flow chart says of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Whether the first of the pair is the ego.
    pub ego_is_a: bool,
    /// Kind by the angle of now.
    pub kind: Kind,
    /// The angle of now.
    pub angle: Radian,
    /// The straight-line distance that fig. 5 compares with μ.
    pub distance: Metre,
    /// Where the ego is.
    pub meeting: ConflictPoint,
}

/// Kind and distance by fig. 5; the ego is the one that has the other ahead of it, of two such the faster one, else
/// the first.
pub fn measure(a: &Participant, b: &Participant, options: &Options) -> Found {
    let between = b.rectangle.centre - a.rectangle.centre;
    let a_ahead = between.dot(&a.rectangle.axis) > 0.0;
    let b_ahead = between.dot(&b.rectangle.axis) < 0.0;
    let ego_is_a = if a_ahead == b_ahead { a.speed >= b.speed } else { a_ahead };
    let (ego, foe) = if ego_is_a { (a, b) } else { (b, a) };
    let angle = angle_between(&ego.rectangle.axis, &foe.rectangle.axis);
    let kind = kind_at(angle, options);
    let (a1, a2) = (ego.rectangle.half_length, foe.rectangle.half_length);
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
    let meeting = ConflictPoint {
        ego_distance: distance,
        foe_distance: 0.0,
        ego: ego.rectangle,
        foe_axis: Some(foe.rectangle.axis),
        leads: kind == Kind::RearEnd,
    };
    Found { ego_is_a, kind, angle, distance, meeting }
}

/// Fig. 8: whether a vertex of one rectangle lies within or on the other. Two that cross like a plus sign have no
/// such vertex.
pub fn a_vertex_touches_a_side(a: &Rectangle, b: &Rectangle) -> bool {
    a.corners().iter().any(|corner| holds(b, corner)) || b.corners().iter().any(|corner| holds(a, corner))
}

fn holds(rectangle: &Rectangle, point: &Point) -> bool {
    let from_centre = point - rectangle.centre;
    from_centre.dot(&rectangle.axis).abs() <= rectangle.half_length
        && from_centre.dot(&left_of(&rectangle.axis)).abs() <= rectangle.half_width
}
