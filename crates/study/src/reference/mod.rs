//! The reference: the same definitions in exact and in high-precision arithmetic, written independently of the formulas
//! that they verify. Only [`crate`] and [`crate::stress`] use it; the detector does not.

pub mod braking;
pub mod chance;
pub mod contact;
pub mod pairs;
pub mod probability;
pub mod turning;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// A number of any size and precision, in base 2.
pub(crate) type BigFloat = FBig<HalfEven, 2>;

/// The bits of a high-precision number: 90 decimal digits, of which cancellation may consume 70.
const BITS: usize = 300;

/// A finite f64 as an exact number, whose sums and products are exact, too. Anything else is 0.
pub fn exact(value: f64) -> BigFloat {
    unlimited(value, 0)
}

/// A finite f64 as a number with 300 bits of precision. Anything else is 0.
pub(crate) fn precise(value: f64) -> BigFloat {
    unlimited(value, BITS)
}

fn unlimited(value: f64, bits: usize) -> BigFloat {
    BigFloat::try_from(value).map_or(BigFloat::ZERO, |number| number.with_precision(bits).value())
}

/// The nearest f64.
pub fn nearest(number: &BigFloat) -> f64 {
    number.to_f64().value()
}

/// |number|.
pub fn absolute(number: BigFloat) -> BigFloat {
    if number < BigFloat::ZERO { -number } else { number }
}

/// The deviation of a result from its expected value.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deviation {
    /// In the unit of the result.
    pub absolute: f64,
    /// Relative to the expected value.
    pub relative: f64,
    /// In units in the last place of the nearest f64.
    pub ulps: f64,
}

/// The deviation of `found` from `expected`; infinite if `found` is not finite.
pub fn deviation(found: f64, expected: &BigFloat) -> Deviation {
    if !found.is_finite() {
        return Deviation { absolute: f64::INFINITY, relative: f64::INFINITY, ulps: f64::INFINITY };
    }
    let off = nearest(&absolute(precise(found) - expected));
    let size = nearest(expected).abs();
    let ulp = (size.next_up() - size).max(f64::from_bits(1));
    // Below the normal range an f64 has fewer than 53 bits that could be right.
    let relative = if off == 0.0 { 0.0 } else { off / size.max(LEAST_SIZE) };
    Deviation { absolute: off, relative, ulps: off / ulp }
}

/// The deviation of a result smaller than this is relative to it, because products of its parts leave f64's normal range.
pub(crate) const LEAST_SIZE: f64 = 1e-290;
