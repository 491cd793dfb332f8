//! A difference of distances with the size of its terms: whether plain f64 has kept enough digits of it.

use crate::util::units::Metre;

/// A difference of ways, and how large the terms were that it was formed from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needed<N> {
    pub distance: N,
    pub scale: f64,
}

impl Needed<f64> {
    /// Whether so little cancelled in this sum of the terms that plain f64 has kept 13 digits.
    ///
    /// A clearly negative distance is the floor ε for the models that have one, and needs no digits.
    pub fn trusted(&self, sum: Metre) -> bool {
        /// Each of some ten operations may err by half a unit in the last place of the largest term.
        const KEPT: f64 = 1.0 / 64.0;
        sum.abs() > KEPT * self.scale || self.scale == 0.0
    }
}
