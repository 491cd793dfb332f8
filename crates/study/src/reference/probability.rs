//! Probabilities by their definition: distributions in high precision, and integrals over many small intervals.

use std::sync::LazyLock;

use super::{BigFloat, nearest, precise};

/// A lognormal distribution.
pub(crate) struct Lognormal {
    centre: BigFloat,
    deviation: BigFloat,
}

impl Lognormal {
    /// The distribution of this mean and standard deviation of its own.
    pub fn new(mean: f64, deviation: f64) -> Self {
        let ratio = precise(deviation) / precise(mean);
        let spread = (precise(1.0) + &ratio * &ratio).ln();
        Self { centre: precise(mean).ln() - &spread / precise(2.0), deviation: spread.sqrt() }
    }

    /// The probability of a value above a limit above 0.
    pub fn above(&self, limit: f64) -> BigFloat {
        normal_above(&((precise(limit).ln() - &self.centre) / &self.deviation))
    }
}

/// The probability of a normal value in a range.
pub(crate) fn normal_between(mean: f64, deviation: f64, low: f64, high: f64) -> BigFloat {
    let above = |value: f64| normal_above(&((precise(value) - precise(mean)) / precise(deviation)));
    above(low) - above(high)
}

/// The probability that a standard normal value is above this: 1/2 − 1/√(2π) Σ (−1)ⁿ x²ⁿ⁺¹ / (2ⁿ n! (2n+1)).
fn normal_above(x: &BigFloat) -> BigFloat {
    /// Further out, less than 1e-23 is left.
    const FAR: f64 = 10.0;
    /// Terms are added until they are this small.
    const LEAST: f64 = 1e-40;
    match nearest(x) {
        x if x > FAR => return precise(0.0),
        x if x < -FAR => return precise(1.0),
        _ => {}
    }
    static ROOT: LazyLock<BigFloat> = LazyLock::new(|| (precise(2.0) * pi()).sqrt());
    let square = x * x;
    let mut power = x.clone();
    let mut sum = precise(0.0);
    for n in 0_u32.. {
        let term = &power / precise(f64::from(2 * n + 1));
        let is_last = f64::from(n) > nearest(&square) && nearest(&term).abs() < LEAST;
        sum += term;
        if is_last {
            break;
        }
        power = -(&power * &square / precise(f64::from(2 * (n + 1))));
    }
    precise(0.5) - sum / &*ROOT
}

/// π by Machin's formula: 16 arctan 1/5 − 4 arctan 1/239.
fn pi() -> BigFloat {
    let arctan = |of: f64| {
        let (mut power, square) = (precise(1.0) / precise(of), precise(of * of));
        let mut sum = precise(0.0);
        for n in 0..140 {
            let term = &power / precise(f64::from(2 * n + 1));
            sum = if n % 2 == 0 { sum + term } else { sum - term };
            power /= &square;
        }
        sum
    };
    precise(16.0) * arctan(5.0) - precise(4.0) * arctan(239.0)
}

/// The mean of a function of a normal value of this mean and standard deviation that is cut to a range: by Simpson's rule
/// over this many intervals, an even number.
pub(crate) fn mean_over_normal([mean, deviation, low, high]: [f64; 4], intervals: u32, of: impl Fn(f64) -> f64) -> f64 {
    let [mut sum, mut weights] = [0.0; 2];
    for index in 0..=intervals {
        let value = low + (high - low) * f64::from(index) / f64::from(intervals);
        let simpson = match index {
            _ if index == 0 || index == intervals => 1.0,
            _ if index % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let weight = simpson * (-((value - mean) / deviation).powi(2) / 2.0).exp();
        sum += weight * of(value);
        weights += weight;
    }
    sum / weights
}

/// 1 / (1 + exp(−x)).
pub(crate) fn logistic(x: &BigFloat) -> BigFloat {
    precise(1.0) / (precise(1.0) + (-x).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_is_that_of_the_tables() {
        // Abramowitz and Stegun 1964, table 26.1.
        for (x, above) in
            [(0.0, 0.5), (1.0, 0.158_655_253_931_457), (2.0, 0.022_750_131_948_179_2), (-2.0, 0.977_249_868_051_820_8)]
        {
            assert!((nearest(&normal_above(&precise(x))) - above).abs() < 1e-14, "{x}");
        }
    }
}
