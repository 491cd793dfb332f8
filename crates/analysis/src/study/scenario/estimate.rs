//! Means over seeds, and errors against a reference in pairs of runs with the same seed.

use crate::statistics::t_quantile;

/// A value, and its 95 % interval over seeds; none with a single seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The interval's ends.
    pub interval: Option<[f64; 2]>,
}

impl Estimate {
    /// A value with the standard error that these deviations of single runs have.
    fn around(value: f64, deviations: impl ExactSizeIterator<Item = f64>) -> Self {
        let runs = deviations.len() as f64;
        let squares = deviations.map(|deviation| deviation.powi(2)).sum::<f64>();
        let reach = t_quantile(runs - 1.0).map(|quantile| quantile * (squares / (runs - 1.0) / runs).sqrt());
        Self { value, interval: reach.map(|reach| [value - reach, value + reach]) }
    }

    /// Widened by an independent error of this size to either side; without an interval as it was.
    pub(crate) fn widened(self, error: f64) -> Self {
        let ends = |[low, high]: [f64; 2]| {
            [self.value - error.hypot(self.value - low), self.value + error.hypot(high - self.value)]
        };
        Self { interval: self.interval.map(ends), ..self }
    }

    /// Whether the interval contains 0.
    pub(crate) fn may_be_zero(&self) -> bool {
        self.interval.is_some_and(|[low, high]| low <= 0.0 && high >= 0.0)
    }
}

/// The mean of one value per seed, with Student's t-interval; none without values.
pub fn mean(values: &[f64]) -> Option<Estimate> {
    let value = average(values)?;
    Some(Estimate::around(value, values.iter().map(|one| one - value)))
}

/// The relative error of a mean against that of a reference, Σx / Σr − 1; one value of each per seed.
///
/// The interval is that of the ratio estimator (Cochran 1977, *Sampling Techniques*, § 6.4) over the pairs: what the two
/// runs of a seed share, such as its demand, is not in it. None if the reference is 0 and the values are not.
pub(crate) fn relative_error(values: &[f64], reference: &[f64]) -> Option<Estimate> {
    let (value, wanted) = (average(values)?, average(reference)?);
    if value == wanted && values == reference {
        return Some(Estimate::around(0.0, values.iter().map(|_| 0.0)));
    }
    let ratio = value / wanted;
    let deviations = values.iter().zip(reference).map(|(one, of)| (one - ratio * of) / wanted);
    ratio.is_finite().then(|| Estimate::around(ratio - 1.0, deviations))
}

fn average(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, wanted: f64) {
        assert!((found - wanted).abs() < 1e-6, "{found}, not {wanted}");
    }

    #[test]
    fn a_mean_has_students_interval() {
        let found = mean(&[3.0, 4.0, 5.0, 6.0, 7.0]).unwrap();
        let [low, high] = found.interval.unwrap();
        // scipy.stats.t.interval(0.95, 4, loc=5, scale=sqrt(2.5 / 5))
        near(low, 3.0367568385);
        near(high, 6.9632431615);
        assert_eq!(mean(&[2.0]), Some(Estimate { value: 2.0, interval: None }));
        assert_eq!(mean(&[]), None);
    }

    #[test]
    fn what_the_runs_of_a_seed_share_is_no_noise() {
        let reference = [10.0, 50.0, 200.0];
        let values = reference.map(|value| 1.1 * value);
        let found = relative_error(&values, &reference).unwrap();
        near(found.value, 0.1);
        let [low, high] = found.interval.unwrap();
        assert!(high - low < 1e-9);
        // Unpaired, the same values spread widely.
        let found = relative_error(&[values[2], values[0], values[1]], &reference).unwrap();
        near(found.value, 0.1);
        assert!(found.may_be_zero());
    }

    #[test]
    fn an_independent_error_widens_both_ends() {
        let found = Estimate { value: -0.03, interval: Some([-0.07, -0.0]) }.widened(0.03);
        let [low, high] = found.interval.unwrap();
        near(low, -0.03 - 0.05);
        near(high, -0.03 + 0.03 * 2.0_f64.sqrt());
        assert_eq!(Estimate { value: 1.0, interval: None }.widened(2.0).interval, None);
    }

    #[test]
    fn nothing_is_no_error_of_nothing() {
        assert_eq!(relative_error(&[0.0, 0.0], &[0.0, 0.0]).unwrap().interval, Some([0.0, 0.0]));
        assert_eq!(relative_error(&[1.0], &[0.0]), None);
    }
}
