//! Golden-section search for the maximum of a function with one peak (Kiefer 1953).

/// The golden ratio's inverse: the share of the bracket that each step keeps.
const KEPT: f64 = 0.618_033_988_749_894_9;

/// The bracket of the peak between `low` and `high` after this many `steps`, each of which evaluates once.
///
/// Where both inner points have the same value, the search goes on below them.
pub fn golden_section(mut value: impl FnMut(f64) -> f64, low: f64, high: f64, steps: u32) -> (f64, f64) {
    let (mut low, mut high) = (low, high);
    let mut left = high - KEPT * (high - low);
    let mut right = low + KEPT * (high - low);
    let mut at_left = value(left);
    let mut at_right = value(right);
    for _ in 0..steps {
        if at_left < at_right {
            (low, left, at_left) = (left, right, at_right);
            right = low + KEPT * (high - low);
            at_right = value(right);
        } else {
            (high, right, at_right) = (right, left, at_left);
            left = high - KEPT * (high - low);
            at_left = value(left);
        }
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use crate::util::golden_section::*;

    #[test]
    fn the_bracket_closes_around_the_peak() {
        let mut evaluations = 0;
        let parabola = |x: f64| {
            evaluations += 1;
            -(x - 0.3).powi(2)
        };
        let (low, high) = golden_section(parabola, -1.0, 1.0, 30);
        assert!(low <= 0.3 && 0.3 <= high && high - low < 1.1e-6, "{low} to {high}");
        assert_eq!(evaluations, 32);
    }

    #[test]
    fn a_plateau_is_left_downwards() {
        let (low, high) = golden_section(|x| if x < 0.25 { x } else { 0.0 }, 0.0, 1.0, 30);
        assert!(low <= 0.25 && 0.25 <= high + 1e-6, "{low} to {high}");
    }
}
