//! A difference of distances with the size of its terms, which tells whether f64 has kept enough digits.

use crate::util::units::Metre;

/// A difference of distances, and the magnitude of the terms that it was formed from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needed<N> {
    pub distance: N,
    pub scale: f64,
}

impl Needed<f64> {
    /// Whether f64 has kept 13 digits of this sum of the terms.
    ///
    /// For a model with a floor, a clearly negative distance becomes ε and needs no digits.
    pub(crate) fn trusted(&self, sum: Metre) -> bool {
        /// Each of about ten operations has an error of at most half a unit in the last place of the largest term.
        const KEPT: f64 = 1.0 / 64.0;
        sum.abs() > KEPT * self.scale || self.scale == 0.0
    }
}
