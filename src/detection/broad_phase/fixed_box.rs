//! Boxes in whole 64ths of a metre, half the memory: what the search keeps of areas, and compares four sides at once.

use crate::geometry::{Bounds, Vector};
use crate::util::units::Metre;

/// So fine that a box is hardly larger than without, so coarse that any projection of the earth has room.
const PER_METRE: f64 = 64.0;

/// What is further from the origin than this, along x or y, counts as being there, in m; nothing on earth is.
pub(super) const FURTHEST: Metre = 3.3e7;

/// A box that holds another one, and is larger by less than 1.6 cm on each side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coarse {
    /// Smallest x and y, then the largest x and y with another sign: then all sides are rounded the same way.
    sides: [i32; 4],
}

impl Coarse {
    /// Nothing.
    pub const EMPTY: Self = Self { sides: [i32::MAX; 4] };

    /// Smallest x and y, in its own unit.
    pub fn low(&self) -> [i32; 2] {
        [self.sides[0], self.sides[1]]
    }

    /// Largest x and y, in its own unit.
    pub fn high(&self) -> [i32; 2] {
        [-self.sides[2], -self.sides[3]]
    }

    /// The middle's y, in m.
    pub fn middle(&self) -> Metre {
        let ([_, low], [_, high]) = (self.low(), self.high());
        (f64::from(low) + f64::from(high)) / (2.0 * PER_METRE)
    }

    /// How long and how high it is, in m.
    pub fn size(&self) -> Vector {
        let (low, high) = (self.low().map(f64::from), self.high().map(f64::from));
        Vector::new(high[0] - low[0], high[1] - low[1]) / PER_METRE
    }

    /// The place so far before another one along an axis, both in a box's own unit; none is before the first there is.
    pub fn before(place: i32, way: Metre) -> i32 {
        (f64::from(place) - way * PER_METRE) as i32
    }

    /// Whether a side is as far from the origin as sides get.
    pub fn is_far(&self) -> bool {
        self.sides.iter().any(|side| side.abs() >= (FURTHEST * PER_METRE) as i32)
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

/// The 64ths of a metre of a way, no more than it is unless that is further away than anything.
///
/// A number so large that its last digit is a 1 has the other number's whole part there: what `floor` says, without a call
/// where the processor has no instruction for it, and of several at once.
#[inline(always)]
fn rounded_down(way: Metre) -> i32 {
    const LARGE: f64 = (3_u64 << 51) as f64;
    /// And a little more, so that no rounding before that matters.
    const HALF: f64 = 0.5 + 1e-6;
    let parts = (way * PER_METRE).clamp(-FURTHEST * PER_METRE, FURTHEST * PER_METRE);
    (parts - HALF + LARGE).to_bits() as i32
}

#[cfg(test)]
mod tests {
    use crate::detection::broad_phase::fixed_box::*;
    use crate::geometry::Point;
    use proptest::prelude::*;

    /// Of any size, from 0 to infinity.
    fn number() -> impl Strategy<Value = f64> {
        let whole = (-1_000_000..1_000_000).prop_map(|parts| f64::from(parts) / PER_METRE);
        prop_oneof![any::<f64>(), -3.3e7..3.3e7, -1.0..1.0, whole, Just(f64::INFINITY), Just(f64::NEG_INFINITY)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        #[test]
        fn no_side_is_rounded_inward_or_far_outward(value in number()) {
            let parts = value.clamp(-FURTHEST, FURTHEST) * PER_METRE;
            let down = f64::from(rounded_down(value));
            prop_assert!((parts - 1.00001..=parts).contains(&down), "{down} of {parts}");
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
