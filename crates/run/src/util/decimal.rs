//! Numbers as text with a fixed number of decimals: the same bytes as `{:.6}`, several times faster.
//!
//! The crates for this (ryu, dtoa and what builds on them) write as many digits as a number needs; rounding those once
//! more is not rounding the number.

use std::fmt::{self, Write};

/// Powers of ten, by the number of decimals.
const TENS: [f64; 7] = [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];
/// In units of the last decimal, what is smaller than this is known to 2⁻¹⁰ of one.
const LARGEST: f64 = (1_u64 << 43) as f64;
/// Values closer than this to the middle between two decimals may lie on its other side.
const IN_DOUBT: f64 = 1.0 / 512.0;
/// Room for the digits below [`LARGEST`] and a point.
const DIGITS: usize = 16;

/// Appends a number with `decimals` decimals, 6 at most. The exact value is rounded half to even, as all formatting does.
///
/// Large numbers, those in doubt and those that are none are left to the standard library.
pub(crate) fn push_fixed(text: &mut String, value: f64, decimals: usize) {
    let units = value.abs() * TENS[decimals];
    let below = units as u64;
    let rest = units - below as f64;
    if units.is_nan() || units >= LARGEST || (rest - 0.5).abs() < IN_DOUBT {
        // Writing to a String does not fail.
        let _ = write!(text, "{value:.decimals$}");
        return;
    }
    let mut left = below + u64::from(rest > 0.5);
    let (mut digits, mut begin) = (['0'; DIGITS], DIGITS);
    let mut put = |digit| {
        begin -= 1;
        digits[begin] = digit;
    };
    for place in 0.. {
        if place == decimals && decimals > 0 {
            put('.');
        }
        put(char::from(b'0' + (left % 10) as u8));
        left /= 10;
        if left == 0 && place >= decimals {
            break;
        }
    }
    if value.is_sign_negative() {
        text.push('-');
    }
    text.extend(&digits[begin..]);
}

/// A number with six decimals at most, micrometres and microseconds, without the zeros that end it; in place of the text.
pub fn shortest(value: f64, text: &mut String) -> &str {
    text.clear();
    push_fixed(text, value, 6);
    let kept = text.trim_end_matches('0').trim_end_matches('.').len();
    text.truncate(kept);
    if text == "-0" { "0" } else { text }
}

/// A number in a sentence, as people write it: [`shortest`].
#[derive(Clone, Copy, Debug)]
pub struct Written(pub f64);

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(shortest(self.0, &mut String::new()))
    }
}

#[cfg(test)]
mod tests {
    use crate::util::decimal::*;
    use proptest::prelude::*;

    fn fixed(value: f64, decimals: usize) -> String {
        let mut text = String::new();
        push_fixed(&mut text, value, decimals);
        text
    }

    /// Numbers of all sizes, and those in the middle between two decimals, which binary fractions hit exactly.
    fn any_number() -> impl Strategy<Value = f64> {
        let middle =
            (-1_000_000_i64..1_000_000, 0..12).prop_map(|(count, halvings)| count as f64 / f64::from(1 << halvings));
        prop_oneof![any::<f64>(), -1e4..1e4, -1e8..1e8, middle, Just(f64::NAN), Just(f64::NEG_INFINITY)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn the_bytes_are_those_of_the_standard_library(value in any_number(), decimals in 0_usize..=6) {
            prop_assert_eq!(fixed(value, decimals), format!("{value:.decimals$}"));
        }
    }

    #[test]
    fn zeros_keep_their_sign_and_halves_round_to_even() {
        assert_eq!(
            [fixed(-0.0, 2), fixed(-0.001, 2), fixed(0.125, 2), fixed(0.375, 2)],
            ["-0.00", "-0.00", "0.12", "0.38"]
        );
    }

    #[test]
    fn the_shortest_has_six_decimals_at_most() {
        let text = |value| shortest(value, &mut String::new()).to_owned();
        assert_eq!(
            [text(1.0), text(0.1 + 0.2), text(-1e-9), text(-12.25), text(100.0)],
            ["1", "0.3", "0", "-12.25", "100"]
        );
    }

    #[test]
    fn a_time_that_adds_up_steps_is_written_without_their_rounding() {
        assert_eq!(Written(109.699_999_999_999_99).to_string(), "109.7");
        assert_eq!([Written(1e300).to_string().len(), Written(-0.25).to_string().len()], [301, 5]);
    }
}
