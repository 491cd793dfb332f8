//! Numbers as SUMO writes them, "-123.45", to the same bits as `str::parse`, several times as fast.

/// Powers of ten that an f64 holds exactly.
const TENS: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
/// With so many digits at most, their whole number is below 2⁵³: an f64 holds it exactly.
const DIGITS: usize = 15;

/// The number in a text; none where it is no number.
///
/// A short decimal is a whole number over a power of ten. Both are exact, and one division rounds once, so this is the
/// nearest f64: what `str::parse` gives. All other texts are left to it.
#[inline]
pub fn number(text: &[u8]) -> Option<f64> {
    let (negative, digits) = match text {
        [b'-', digits @ ..] => (true, digits),
        digits => (false, digits),
    };
    let (mut whole, mut decimals) = (0_u64, None);
    if digits.is_empty() || digits.len() > DIGITS + 1 {
        return slowly(text);
    }
    for (at, byte) in digits.iter().enumerate() {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            whole = whole * 10 + u64::from(digit);
        } else if *byte == b'.' && decimals.is_none() {
            decimals = Some(digits.len() - 1 - at);
        } else {
            return slowly(text);
        }
    }
    // Sixteen digits without a point are too many; a point alone is no number.
    if digits.len() - usize::from(decimals.is_some()) > DIGITS || digits == b"." {
        return slowly(text);
    }
    let size = whole as f64 / TENS[decimals.unwrap_or(0)];
    Some(if negative { -size } else { size })
}

#[cold]
fn slowly(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn is_what_std_says(text: &str) {
        let expected = text.parse::<f64>().ok().map(f64::to_bits);
        assert_eq!(number(text.as_bytes()).map(f64::to_bits), expected, "{text}");
    }

    #[test]
    fn unusual_texts_are_read_as_std_reads_them() {
        for text in [
            "",
            "-",
            ".",
            "-.",
            "5.",
            ".5",
            "-0",
            "-0.00",
            "+1.5",
            "1e5",
            "1.5e-3",
            "inf",
            "nan",
            "NaN",
            "1.2.3",
            " 1",
            "1 ",
            "0x1",
            "123456789012345",
            "1234567890123456",
            "9007199254740993",
            "0.123456789012345",
            "12345678901234.5",
            "999999999999999",
            "99999999999999.9",
            "000000000000000000001.5",
            "１",
            "1_000",
        ] {
            is_what_std_says(text);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn decimals_have_the_bits_of_std(text in "-?[0-9]{0,12}(\\.[0-9]{0,9})?") {
            is_what_std_says(&text);
        }

        #[test]
        fn any_text_is_read_as_std_reads_it(text in "[-+0-9.eEinfa ]{0,20}") {
            is_what_std_says(&text);
        }

        #[test]
        fn every_double_comes_back(value in proptest::num::f64::NORMAL) {
            is_what_std_says(&value.to_string());
        }
    }
}
