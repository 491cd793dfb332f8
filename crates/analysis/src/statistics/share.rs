//! The share of trials with an event, and its 95 % interval (Wilson 1927).

use statrs::distribution::{ContinuousCDF, Normal};

use super::rate::TAIL;

/// A share with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Events per trial; 0 without trials.
    pub value: f64,
    /// The interval's lower end.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
}

/// The share of `count` in `all` trials.
pub fn share(count: u64, all: u64) -> Share {
    if all == 0 {
        return Share { value: 0.0, low: 0.0, high: 1.0 };
    }
    let (count, all) = (count as f64, all as f64);
    let z = Normal::standard().inverse_cdf(1.0 - TAIL);
    let middle = (count + z * z / 2.0) / (all + z * z);
    let half = z / (all + z * z) * (count * (all - count) / all + z * z / 4.0).sqrt();
    let low = if count == 0.0 { 0.0 } else { middle - half };
    let high = if count >= all { 1.0 } else { middle + half };
    Share { value: count / all, low, high }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_wilsons() {
        // statsmodels.stats.proportion.proportion_confint(17, 100, method="wilson")
        let found = share(17, 100);
        assert!((found.low - 0.108_936).abs() < 1e-5 && (found.high - 0.255_480).abs() < 1e-5, "{found:?}");
        assert_eq!(share(0, 100).low, 0.0);
        assert!((share(0, 100).high - 0.036_993).abs() < 1e-5);
        assert_eq!(share(100, 100).high, 1.0);
        assert_eq!(share(0, 0), Share { value: 0.0, low: 0.0, high: 1.0 });
    }
}
