//! Times as SUMO writes them: seconds, or (`--human-readable-time`) hours, minutes and seconds, with days before them.

use super::number::number;
use closecall::util::units::Second;

/// Seconds in a minute, an hour and a day.
const UNITS: [u64; 3] = [60, 3600, 86_400];

/// The time in a text: "7.30", "00:00:07.30" or "1:02:03:04"; none if it is not a time.
pub(super) fn time(text: &[u8]) -> Option<Second> {
    if !text.contains(&b':') {
        return number(text);
    }
    let text = std::str::from_utf8(text).ok()?;
    let mut parts = text.rsplit(':');
    let seconds = parts.next()?;
    let (whole, fraction) = seconds.split_once('.').unwrap_or((seconds, "0"));
    let mut units = UNITS.iter();
    let mut total = digits(whole)?;
    for part in parts {
        total = total.checked_add(digits(part)?.checked_mul(*units.next()?)?)?;
    }
    digits(fraction)?;
    // Joined as text, it has the bits that the same time in seconds has. SUMO writes no time of minutes and seconds alone.
    if units.len() > 1 { None } else { number(format!("{total}.{fraction}").as_bytes()) }
}

fn digits(text: &str) -> Option<u64> {
    if text.bytes().all(|byte| byte.is_ascii_digit()) { text.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use crate::input::replay::clock::*;

    #[test]
    fn a_clock_time_has_the_bits_of_its_seconds() {
        for (text, seconds) in [
            ("00:00:07.300", 7.3),
            ("00:01:07.30", 67.3),
            ("1:02:03:04", 93_784.0),
            ("24:00:00.00", 86_400.0),
            ("2:00:00:00.10", 172_800.1),
            ("12.34", 12.34),
            ("-1", -1.0),
        ] {
            assert_eq!(time(text.as_bytes()).map(f64::to_bits), Some(f64::to_bits(seconds)), "{text}");
        }
    }

    #[test]
    fn what_is_no_time_is_none() {
        let huge = format!("{}:00:00", u64::MAX);
        for text in ["", ":", "00:07", "1:2:3:4:5", "00:00:", "00::07", "00:-1:07", "00:00:7.1e1", "a:b:c", &huge] {
            assert_eq!(time(text.as_bytes()), None, "{text}");
        }
    }
}
