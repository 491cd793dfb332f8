//! Phase 2, accurate: where two road users would meet, and by the angle there of which kind that is.
//!
//! Two that drive straight on, side by side or in line, are a matter of one dimension: [`rear_end`] where they drive
//! the same way, [`frontal`] where they drive towards each other. All others are swept: [`side`]. The paper's own
//! tests are in [`paper`].

mod conflict_point;
pub mod frontal;
pub mod paper;
mod participant;
pub mod rear_end;
pub mod side;
mod swept_bounds;

pub use conflict_point::ConflictPoint;
pub use participant::Participant;
pub use swept_bounds::SweptBounds;

use crate::braking::{self, MuModel};
use crate::geometry::bisection::Bisection;
use crate::geometry::{Vector, cross};
use crate::util::units::{Metre, Radian};

/// Two straight paths are parallel where they deviate by less than this over their length, in m.
const PARALLEL: Metre = 1e-3;

/// Where a pair meets that does not touch now, and whether the first of it is the ego: the one with the longer way,
/// of equal ones the first if `a_is_smaller` says that its id is.
pub fn meet(a: &Participant, b: &Participant, a_is_smaller: &impl Fn() -> bool) -> Option<(bool, ConflictPoint)> {
    if drive_in_line(a, b) {
        meet_in_one_dimension(a, b, a_is_smaller)
    } else {
        side::meet(&mut Bisection::default(), a, b, false, a_is_smaller)
    }
}

/// Whether both drive straight on, side by side or in line.
pub fn drive_in_line(a: &Participant, b: &Participant) -> bool {
    if !a.straight || !b.straight || !a.shape.is_empty() || !b.shape.is_empty() {
        return false;
    }
    lead_alike([&a.rectangle.axis, &b.rectangle.axis], [a.stop + a.length(), b.stop + b.length()])
}

/// Whether two axes lead so much the same way, or the opposite one, that over neither of these lengths they deviate.
pub fn lead_alike([a, b]: [&Vector; 2], [length, other]: [Metre; 2]) -> bool {
    cross(a, b).abs() * length.max(other) <= PARALLEL
}

/// Whether two that drive in line drive towards each other, or away from each other.
pub fn drive_opposed(a: &Participant, b: &Participant) -> bool {
    a.rectangle.axis.dot(&b.rectangle.axis) <= 0.0
}

/// Where two that drive in line meet; `true` where the first of them is the ego.
pub fn meet_in_one_dimension(
    a: &Participant,
    b: &Participant,
    a_is_smaller: &impl Fn() -> bool,
) -> Option<(bool, ConflictPoint)> {
    let axis = a.rectangle.axis;
    let between = b.rectangle.centre - a.rectangle.centre;
    if cross(&axis, &between).abs() > a.rectangle.half_width + b.rectangle.half_width {
        return None;
    }
    let along = between.dot(&axis);
    let ahead = along.abs() - a.rectangle.half_length - b.rectangle.half_length;
    if !drive_opposed(a, b) {
        let (ego_is_a, ego, foe) = if along > 0.0 { (true, a, b) } else { (false, b, a) };
        rear_end::in_line(ego, foe, ahead).map(|meeting| (ego_is_a, meeting))
    } else if along > 0.0 {
        frontal::in_line(a, b, ahead, a_is_smaller)
    } else {
        None
    }
}

/// σ = cos α.
pub fn sigma(angle: Radian) -> f64 {
    if angle == 0.0 { 1.0 } else { angle.cos() }
}

/// The room that is left: max(way_ego − σ·way_foe, 0).
pub fn gap(ego_distance: Metre, foe_distance: Metre, sigma: f64) -> Metre {
    (ego_distance - sigma * foe_distance).max(0.0)
}

/// The minimal collision distance of a pair.
pub fn mu(model: MuModel, ego: &Participant, foe: &Participant, sigma: f64, epsilon: Metre) -> Metre {
    braking::mu(model, ego.braking(), foe.braking(), sigma, epsilon)
}
