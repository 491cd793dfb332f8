//! What closecall is judged by: the same definitions in exact and in high-precision arithmetic, written without a look
//! at the formulas that they judge. For [`crate::study`] and [`crate::study::stress`]; the detector knows none of it.

pub mod braking;
pub mod chance;
pub mod contact;
pub mod pairs;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// A number of any size and precision, in base 2.
pub type Number = FBig<HalfEven, 2>;

/// Bits of a high-precision number: 90 decimal digits, of which cancellation may take 70.
const BITS: usize = 300;

/// A finite f64 as an exact number: sums and products of such are exact, too. Anything else is 0.
pub fn exact(value: f64) -> Number {
    unlimited(value, 0)
}

/// A finite f64 as a number that computes with 300 bits. Anything else is 0.
pub fn precise(value: f64) -> Number {
    unlimited(value, BITS)
}

fn unlimited(value: f64, bits: usize) -> Number {
    Number::try_from(value).map_or(Number::ZERO, |number| number.with_precision(bits).value())
}

/// The nearest f64.
pub fn nearest(number: &Number) -> f64 {
    number.to_f64().value()
}

/// |number|.
pub fn absolute(number: Number) -> Number {
    if number < Number::ZERO { -number } else { number }
}

/// How far a result is from what it should be.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deviation {
    /// In m, s or whatever both are in.
    pub absolute: f64,
    /// Relative to what it should be.
    pub relative: f64,
    /// In units in the last place of the nearest f64.
    pub ulps: f64,
}

/// How far `found` is from `expected`; infinitely far where it is no finite number.
pub fn deviation(found: f64, expected: &Number) -> Deviation {
    if !found.is_finite() {
        return Deviation { absolute: f64::INFINITY, relative: f64::INFINITY, ulps: f64::INFINITY };
    }
    let off = nearest(&absolute(precise(found) - expected));
    let size = nearest(expected).abs();
    let ulp = (size.next_up() - size).max(f64::from_bits(1));
    // Below the normal range an f64 has no 53 digits to be right.
    let relative = if off == 0.0 { 0.0 } else { off / size.max(LEAST_SIZE) };
    Deviation { absolute: off, relative, ulps: off / ulp }
}

/// Results smaller than this are compared with it: products of their parts leave f64's normal range.
pub const LEAST_SIZE: f64 = 1e-290;
