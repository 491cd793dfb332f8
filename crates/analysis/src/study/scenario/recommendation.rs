//! Which step a scenario needs.

use super::estimate::Estimate;

/// Whether an error is below a bound, by its interval over seeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The whole interval is below it.
    Shown,
    /// The value is below it, the interval is not.
    Likely,
    /// The value is above it, a part of the interval is not.
    Unlikely,
    /// The whole interval is above it.
    Refuted,
}

/// Whether the size of a relative error is at most `accuracy`.
pub(crate) fn verdict(error: &Estimate, accuracy: f64) -> Verdict {
    let [low, high] = error.interval.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let is_within = error.value.abs() <= accuracy;
    match (is_within, low >= -accuracy && high <= accuracy, low > accuracy || high < -accuracy) {
        (true, true, _) => Verdict::Shown,
        (true, false, _) => Verdict::Likely,
        (false, _, true) => Verdict::Refuted,
        (false, _, false) => Verdict::Unlikely,
    }
}

/// The place of the coarsest step that is within the accuracy and all finer ones are; the errors begin with the finest, which
/// is what they are relative to. A coarse step may be right by chance where a finer one is wrong.
pub(crate) fn coarsest(errors: &[Option<Estimate>], accuracy: f64) -> usize {
    let is_within = |error: &&Option<Estimate>| error.is_some_and(|error| error.value.abs() <= accuracy);
    errors.iter().take_while(is_within).count().saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(value: f64, low: f64, high: f64) -> Estimate {
        Estimate { value, interval: Some([low, high]) }
    }

    #[test]
    fn the_step_is_the_coarsest_before_the_first_that_fails() {
        let errors =
            |values: &[f64]| values.iter().map(|value| Some(error(*value, *value, *value))).collect::<Vec<_>>();
        assert_eq!(coarsest(&errors(&[0.0, 0.02, -0.05, 0.3, 2.0]), 0.05), 2);
        assert_eq!(coarsest(&errors(&[0.0, 0.02, -0.06, 0.01]), 0.05), 1);
        assert_eq!(coarsest(&errors(&[0.0, 0.06]), 0.05), 0);
        assert_eq!(coarsest(&[None, None], 0.05), 0);
    }

    #[test]
    fn an_interval_shows_or_refutes_an_accuracy() {
        let cases = [
            (error(0.01, -0.02, 0.04), Verdict::Shown),
            (error(0.04, -0.02, 0.1), Verdict::Likely),
            (error(-0.08, -0.2, 0.04), Verdict::Unlikely),
            (error(-0.2, -0.3, -0.1), Verdict::Refuted),
            (Estimate { value: 0.01, interval: None }, Verdict::Likely),
        ];
        cases.iter().for_each(|(error, wanted)| assert_eq!(verdict(error, 0.05), *wanted, "{error:?}"));
    }
}
