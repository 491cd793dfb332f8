//! What is known of a road user that has jumped to another lane at the end of a step.

use crate::geometry::Vector;
use crate::util::units::Radian;

/// A road user that has jumped to another lane.
pub(super) struct Jump {
    /// Its row in the frame.
    pub row: u32,
    /// By how much it is beside its former path.
    pub aside: Vector,
    /// The heading of that path there.
    pub heading: Radian,
}
