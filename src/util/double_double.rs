//! Numbers of twice f64's precision: an unevaluated sum of two f64, by error-free transforms (Dekker 1971, Knuth).
//!
//! Only + − × and √ and ÷, only where S − Si cancels. The products are split by Dekker's method rather than formed by
//! a fused multiply-add: the wheel's baseline of x86-64 has none in hardware, and one in software costs more.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What the formulas of μ need of a number: f64 and `DoubleDouble` have it.
pub trait Number:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The nearest f64.
    fn value(self) -> f64;
    /// The square root; of a negative number, 0.
    fn root(self) -> Self;
}

impl Number for f64 {
    fn value(self) -> f64 {
        self
    }

    fn root(self) -> Self {
        self.max(0.0).sqrt()
    }
}

/// `high + low`, where `low` is at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

/// a + b as the nearest f64 and exactly what that leaves out (Knuth).
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let high = a + b;
    let part = high - a;
    (high, (a - (high - part)) + (b - part))
}

/// The same for |a| ≥ |b|.
fn quick_two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    DoubleDouble { high, low: b - (high - a) }
}

/// a · b as the nearest f64 and exactly what that leaves out (Dekker), as long as neither leaves the normal range.
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let high = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (high, ((a_high * b_high - high) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

fn split(a: f64) -> (f64, f64) {
    const HALF_OF_THE_DIGITS: f64 = 134_217_729.0;
    let shifted = HALF_OF_THE_DIGITS * a;
    let high = shifted - (shifted - a);
    (high, a - high)
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let ((high, low), rest) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = quick_two_sum(high, low + rest.0);
        quick_two_sum(sum.high, sum.low + rest.1)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (high, low) = two_product(self.high, other.high);
        quick_two_sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        let third = rest.high / other.high;
        quick_two_sum(first, second) + Self::from(third)
    }
}

impl Number for DoubleDouble {
    fn value(self) -> f64 {
        self.high
    }

    fn root(self) -> Self {
        if self.high <= 0.0 {
            return Self::from(0.0);
        }
        let root = self.high.sqrt();
        let (high, low) = two_product(root, root);
        let rest = self - Self { high, low };
        quick_two_sum(root, rest.high / (2.0 * root))
    }
}

#[cfg(test)]
mod tests {
    use crate::util::double_double::*;

    fn of(value: f64) -> DoubleDouble {
        DoubleDouble::from(value)
    }

    #[test]
    fn what_a_sum_loses_is_kept() {
        assert_eq!((of(1e16) + of(1.0) - of(1e16)).value(), 1.0);
    }

    #[test]
    fn a_third_times_three_is_one_to_thirty_digits() {
        let rest = of(1.0) / of(3.0) * of(3.0) - of(1.0);
        assert!(rest.value().abs() < 1e-31);
    }

    #[test]
    fn a_root_squared_is_the_number_to_thirty_digits() {
        let root = of(2.0).root();
        assert!((root * root - of(2.0)).value().abs() < 1e-30);
        assert_eq!(of(-1.0).root().value(), 0.0);
    }
}
