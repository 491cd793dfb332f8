//! Narrow phase (the paper's "accurate" phase): the conflict point of a pair, and the kind by the angle there.
//!
//! Two that drive straight on, side by side or in line, are a problem in one dimension: `rear_end` if they drive in the
//! same direction, `frontal` if they drive towards each other. All others are swept: [`side`]. The paper's own tests
//! are in `paper`.

mod approach;
mod conflict_point;
mod frontal;
pub mod paper_mode;
mod participant;
mod rear_end;
pub mod side;
mod swept_bounds;

pub use approach::{Approach, Ego};
pub use conflict_point::ConflictPoint;
pub use participant::Participant;
pub use swept_bounds::SweptBounds;

use std::slice::from_ref;

use crate::braking::{self, MuModel};
use crate::geometry::bisection::Bisection;
use crate::geometry::movement::FINE;
use crate::geometry::{Vector, cross};
use crate::util::units::{Metre, Radian};

/// Two straight paths are parallel if they deviate by less than this over their length, in m.
const PARALLEL: Metre = 1e-3;

/// How a pair that does not touch now would meet. The ego is the one with the longer distance to the conflict point; if
/// equal, the one that moves faster towards the other, and of mirror images the first.
pub fn meet(a: &Participant, b: &Participant) -> Option<Approach> {
    if drive_in_line(a, b) {
        meet_in_one_dimension(a, b)
    } else {
        let (mut bisection, a, b) = (Bisection::default(), from_ref(a), from_ref(b));
        side::meet(&mut bisection, a, b)?;
        side::refine(&mut bisection, FINE, a, b)
    }
}

/// Whether both drive straight on, side by side or in line.
pub(crate) fn drive_in_line(a: &Participant, b: &Participant) -> bool {
    if !a.straight || !b.straight || !a.shape.is_empty() || !b.shape.is_empty() {
        return false;
    }
    are_parallel([&a.rectangle.axis, &b.rectangle.axis], [a.stop + a.length(), b.stop + b.length()])
}

/// Whether two axes point in the same or in opposite directions, up to [`PARALLEL`] over the longer of two lengths.
pub(crate) fn are_parallel([a, b]: [&Vector; 2], [length, other]: [Metre; 2]) -> bool {
    cross(a, b).abs() * length.max(other) <= PARALLEL
}

/// Whether two that drive in line have opposite directions.
pub(crate) fn drive_opposed(a: &Participant, b: &Participant) -> bool {
    a.rectangle.axis.dot(&b.rectangle.axis) <= 0.0
}

/// How two that drive in line would meet.
pub(crate) fn meet_in_one_dimension(a: &Participant, b: &Participant) -> Option<Approach> {
    let axis = a.rectangle.axis;
    let between = b.rectangle.centre - a.rectangle.centre;
    if cross(&axis, &between).abs() > a.rectangle.half_width + b.rectangle.half_width {
        return None;
    }
    let along = between.dot(&axis);
    let ahead = along.abs() - a.rectangle.half_length - b.rectangle.half_length;
    if !drive_opposed(a, b) {
        let roles = Ego::first_if(along > 0.0);
        let [ego, foe] = roles.then_foe([a, b]);
        rear_end::in_line(ego, foe, ahead).map(|conflict_point| Approach { ego: roles, conflict_point })
    } else if along > 0.0 {
        frontal::in_line(a, b, ahead)
    } else {
        None
    }
}

/// σ = cos α.
pub fn sigma(angle: Radian) -> f64 {
    if angle == 0.0 { 1.0 } else { angle.cos() }
}

/// The room that is left: max(distance_ego − σ · distance_foe, 0).
pub fn gap(ego_distance: Metre, foe_distance: Metre, sigma: f64) -> Metre {
    (ego_distance - sigma * foe_distance).max(0.0)
}

/// The minimal collision distance of a pair.
pub fn mu(model: MuModel, ego: &Participant, foe: &Participant, sigma: f64, epsilon: Metre) -> Metre {
    braking::mu(model, ego.braking(), foe.braking(), sigma, epsilon)
}
