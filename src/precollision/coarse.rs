//! Boxes in single precision, half the memory: what the search keeps of areas, and compares four sides at once.

use crate::geometry::{Bounds, Vector};
use crate::units::Metre;

/// A box that holds another one, and is hardly larger: by its distance from the origin times 10⁻⁷.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coarse {
    /// Smallest x and y, then the largest x and y with another sign: then all sides are rounded the same way.
    sides: [f32; 4],
}

impl Coarse {
    /// Nothing.
    pub const EMPTY: Self = Self { sides: [f32::INFINITY; 4] };

    pub fn low(&self) -> [f32; 2] {
        [self.sides[0], self.sides[1]]
    }

    pub fn high(&self) -> [f32; 2] {
        [-self.sides[2], -self.sides[3]]
    }

    /// How long and how high it is.
    pub fn size(&self) -> Vector {
        let (low, high) = (self.low().map(f64::from), self.high().map(f64::from));
        Vector::new(high[0] - low[0], high[1] - low[1])
    }

    /// Whether it gets so far from the origin.
    pub fn is_beyond(&self, distance: Metre) -> bool {
        self.sides.iter().any(|side| f64::from(side.abs()) >= distance)
    }

    /// Whether the two share a point.
    #[inline(always)]
    pub fn meets(&self, other: &Self) -> bool {
        let [low_x, low_y, high_x, high_y] = other.sides;
        let opposite = [-high_x, -high_y, -low_x, -low_y];
        // All four at once: which of them fails is nothing that a processor could guess.
        self.sides.iter().zip(opposite).fold(true, |meet, (side, opposite)| meet & (*side <= opposite))
    }
}

impl From<&Bounds> for Coarse {
    #[inline(always)]
    fn from(Bounds { low, high }: &Bounds) -> Self {
        Self { sides: [low.x, low.y, -high.x, -high.y].map(rounded_down) }
    }
}

/// A number in single precision that is not larger.
#[inline(always)]
fn rounded_down(value: f64) -> f32 {
    /// Rounding adds at most half of this part, and of the smallest numbers less than that.
    const PART: f64 = f32::EPSILON as f64;
    let finite = value.min(f64::MAX);
    (finite - (finite.abs() * PART + f32::MIN_POSITIVE as f64)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use proptest::prelude::*;

    /// Of any size, from 0 to the largest there is.
    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![any::<f64>(), -1e6..1e6, Just(0.0), Just(f64::INFINITY), Just(f64::NEG_INFINITY)]
    }

    proptest! {
        #[test]
        fn no_side_is_rounded_inward(value in number()) {
            let down = f64::from(rounded_down(value));
            prop_assert!(down <= value || down == f64::INFINITY);
            prop_assert!(value.abs() > 1e30 || value - down < 1e-6 * value.abs().max(1e-30), "{down}");
        }

        #[test]
        fn boxes_that_meet_still_do(sides in prop::array::uniform8(number())) {
            let bounds = |sides: &[f64]| {
                let [a, b] = [Point::new(sides[0], sides[1]), Point::new(sides[2], sides[3])];
                Bounds { low: a.inf(&b), high: a.sup(&b) }
            };
            let (a, b) = (bounds(&sides[..4]), bounds(&sides[4..]));
            prop_assert!(!a.meet(&b) || Coarse::from(&a).meets(&Coarse::from(&b)));
        }
    }
}
