//! Rates of conflicts and their 95 % intervals.
//!
//! With several runs (seeds), the runs are the sample: the rate is the ratio estimator Σ conflicts / Σ traffic, and its
//! interval the t-interval of the linearised residuals (Cochran 1977, *Sampling Techniques*, § 6.4). If all runs have
//! the same traffic, this is the ordinary t-interval of the mean. Conflicts come in clusters, so a single run shows little
//! of their variance. For a single run, or for runs that do not differ, the interval is Poisson's exact one (Garwood
//! 1936), which assumes that conflicts are independent.

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF, Gamma, StudentsT};

/// The probability that an interval covers.
pub const CONFIDENCE: f64 = 0.95;
/// The probability below an interval, and above it.
pub(crate) const TAIL: f64 = (1.0 - CONFIDENCE) / 2.0;

/// Runs whose rates spread by less than this, relatively, are equal: the order of a sum changes its last digits.
pub(super) const EQUAL: f64 = 1e-9;

/// How an interval was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IntervalMethod {
    /// Student's t over runs.
    TOverRuns,
    /// Student's t over pairs of runs with the same seed.
    TOverPairs,
    /// Poisson's exact interval of the count.
    PoissonExact,
    /// That of a sum of independent rare events, each with its weight.
    WeightedEvents,
}

/// A rate and its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// Conflicts per unit of traffic.
    pub value: f64,
    /// The interval's lower end, at least 0.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
    /// How the interval was computed.
    pub method: IntervalMethod,
}

impl Rate {
    /// The rate in another unit.
    pub(super) fn times(self, factor: f64) -> Self {
        Self { value: factor * self.value, low: factor * self.low, high: factor * self.high, ..self }
    }
}

/// The rate of `counts` per `traffic`, one entry of each per run; none without traffic.
pub fn rate(counts: &[f64], traffic: &[f64]) -> Option<Rate> {
    let count = counts.iter().sum::<f64>();
    let total = traffic.iter().sum::<f64>();
    if total <= 0.0 {
        return None;
    }
    let value = count / total;
    let rate = match relative_spread(counts, traffic) {
        Some(spread) if spread > EQUAL => {
            let reach = t_quantile(counts.len() as f64 - 1.0)? * spread * value;
            Rate { value, low: (value - reach).max(0.0), high: value + reach, method: IntervalMethod::TOverRuns }
        }
        _ => {
            let (low, high) = poisson_interval(count)?;
            Rate { value, low: low / total, high: high / total, method: IntervalMethod::PoissonExact }
        }
    };
    Some(rate)
}

/// The standard error of a rate over runs, divided by the rate; none with a single run or without conflicts.
fn relative_spread(counts: &[f64], traffic: &[f64]) -> Option<f64> {
    let deviations = relative_deviations(counts, traffic)?;
    let runs = deviations.len() as f64;
    let squares = deviations.iter().map(|deviation| deviation.powi(2)).sum::<f64>();
    Some((squares / (runs - 1.0) / runs).sqrt())
}

/// What each run's count differs from that of its traffic at the common rate, divided by the mean count; none with a single
/// run, without conflicts or without traffic, and for equal counts, whose traffic alone would tell how exact they are.
pub(super) fn relative_deviations(counts: &[f64], traffic: &[f64]) -> Option<Vec<f64>> {
    let count = counts.iter().sum::<f64>();
    let total = traffic.iter().sum::<f64>();
    if counts.len() < 2 || count <= 0.0 || total <= 0.0 {
        return None;
    }
    let mean = count / counts.len() as f64;
    if counts.iter().all(|one| (one / mean - 1.0).abs() < EQUAL) {
        return None;
    }
    let value = count / total;
    Some(counts.iter().zip(traffic).map(|(count, traffic)| (count - value * traffic) / mean).collect())
}

/// The ratio of two rates, first / second, of runs in pairs: each of the first has the seed of the other in its place.
///
/// The interval is the t-interval of the logarithm over pairs, which takes out what the two runs of a seed have in common.
/// Where the pairs do not differ among themselves, it is that of [`rate_ratio`].
pub fn paired_ratio(first: (&[f64], &[f64]), second: (&[f64], &[f64])) -> Option<Ratio> {
    let deviations = [relative_deviations(first.0, first.1), relative_deviations(second.0, second.1)];
    if let [Some(one), Some(two)] = deviations {
        let pairs = one.len() as f64;
        let squares = one.iter().zip(&two).map(|(one, two)| (one - two).powi(2)).sum::<f64>();
        let spread = (squares / (pairs - 1.0) / pairs).sqrt();
        if spread > EQUAL {
            let [rate, other] =
                [first, second].map(|(counts, traffic)| counts.iter().sum::<f64>() / traffic.iter().sum::<f64>());
            let (value, reach) = (rate / other, t_quantile(pairs - 1.0)? * spread);
            let high = Some(value * reach.exp());
            let method = IntervalMethod::TOverPairs;
            return Some(Ratio { value: Some(value), low: value * (-reach).exp(), high, method });
        }
    }
    rate_ratio(first, second)
}

/// The ratio of two rates, first / second, with its 95 % interval.
///
/// The interval is the t-interval of the logarithm over runs. If either set has one run or no conflict, it is the interval
/// of two Poisson counts given their sum (Clopper and Pearson 1934). None if neither set has a conflict.
pub fn rate_ratio(first: (&[f64], &[f64]), second: (&[f64], &[f64])) -> Option<Ratio> {
    let [(count, total), (other, other_total)] =
        [first, second].map(|(counts, traffic)| (counts.iter().sum::<f64>(), traffic.iter().sum::<f64>()));
    if total <= 0.0 || other_total <= 0.0 || count + other <= 0.0 {
        return None;
    }
    let value = if other > 0.0 { Some((count / total) / (other / other_total)) } else { None };
    let spreads = [relative_spread(first.0, first.1), relative_spread(second.0, second.1)];
    if let ([Some(one), Some(two)], Some(value)) = (spreads, value)
        && one + two > EQUAL
    {
        let reach = t_quantile((first.0.len() + second.0.len() - 2) as f64)? * one.hypot(two);
        return Some(Ratio {
            value: Some(value),
            low: value * (-reach).exp(),
            high: Some(value * reach.exp()),
            method: IntervalMethod::TOverRuns,
        });
    }
    let share = |probability: f64| other_total / total * probability / (1.0 - probability);
    let low = if count > 0.0 { share(Beta::new(count, other + 1.0).ok()?.inverse_cdf(TAIL)) } else { 0.0 };
    let high =
        if other > 0.0 { Some(share(Beta::new(count + 1.0, other).ok()?.inverse_cdf(1.0 - TAIL))) } else { None };
    Some(Ratio { value, low, high, method: IntervalMethod::PoissonExact })
}

/// A ratio of two rates and its 95 % interval; a value or upper end that is none is infinite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ratio {
    /// First rate / second rate.
    pub value: Option<f64>,
    /// The interval's lower end.
    pub low: f64,
    /// The interval's upper end.
    pub high: Option<f64>,
    /// How the interval was computed.
    pub method: IntervalMethod,
}

/// The factor of a standard error with this many degrees of freedom that gives half its interval; none below one.
pub fn t_quantile(freedom: f64) -> Option<f64> {
    Some(StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(1.0 - TAIL))
}

/// Poisson's exact interval of a count (Garwood 1936).
pub(crate) fn poisson_interval(count: f64) -> Option<(f64, f64)> {
    let low = if count > 0.0 { Gamma::new(count, 1.0).ok()?.inverse_cdf(TAIL) } else { 0.0 };
    Some((low, Gamma::new(count + 1.0, 1.0).ok()?.inverse_cdf(1.0 - TAIL)))
}

#[cfg(test)]
mod tests {
    use crate::statistics::rate::*;

    fn near(found: f64, wanted: f64) {
        assert!((found - wanted).abs() < 1e-4 * wanted.abs().max(1.0), "{found}, not {wanted}");
    }

    #[test]
    fn a_rate_is_counts_over_traffic() {
        let found = rate(&[4.0, 6.0, 5.0], &[2.0, 2.0, 2.0]).map(|rate| rate.value);
        assert_eq!(found, Some(2.5));
    }

    #[test]
    fn poisson_intervals_agree_with_published_tables() {
        // scipy.stats.chi2.ppf([0.025, 0.975], [2n, 2n + 2]) / 2
        for (count, low, high) in [(0.0, 0.0, 3.688879), (1.0, 0.025318, 5.571643), (100.0, 81.363861, 121.627303)] {
            let found = poisson_interval(count).unwrap();
            near(found.0, low);
            near(found.1, high);
        }
        let large = poisson_interval(1e7).unwrap();
        near(large.0 / 1e7, 1.0 - 1.96 / 1e7_f64.sqrt());
        near(large.1 / 1e7, 1.0 + 1.96 / 1e7_f64.sqrt());
    }

    #[test]
    fn equal_traffic_gives_the_interval_of_the_mean() {
        // scipy.stats.t.interval(0.95, 4, loc=5, scale=sqrt(2.5 / 5))
        let found = rate(&[3.0, 4.0, 5.0, 6.0, 7.0], &[1.0; 5]).unwrap();
        assert_eq!((found.value, found.method), (5.0, IntervalMethod::TOverRuns));
        near(found.low, 3.036757);
        near(found.high, 6.963243);
    }

    #[test]
    fn one_run_or_equal_runs_get_the_poisson_interval() {
        // The last two traffics are sums of the same numbers in different orders.
        for (counts, traffic) in [
            (&[5.0][..], &[2.0][..]),
            (&[0.0, 0.0], &[1.0, 1.0]),
            (&[3.0, 3.0], &[0.1 + 0.2 + 0.3, 0.3 + 0.2 + 0.1]),
            (&[4.0, 4.0], &[1.0, 1.01]),
        ] {
            assert_eq!(rate(counts, traffic).unwrap().method, IntervalMethod::PoissonExact);
        }
        assert_eq!(rate(&[0.0], &[0.0]), None);
    }

    #[test]
    fn a_ratio_to_zero_has_only_a_lower_end() {
        let ratio = rate_ratio((&[10.0], &[1.0]), (&[0.0], &[1.0])).unwrap();
        assert_eq!((ratio.value, ratio.high), (None, None));
        // 10 of 10: p >= 0.025^(1/10); the ratio is p / (1 - p).
        let least = 0.025_f64.powf(0.1);
        near(ratio.low, least / (1.0 - least));
        assert_eq!(rate_ratio((&[0.0], &[1.0]), (&[0.0], &[1.0])), None);
    }

    #[test]
    fn pairs_take_out_what_two_runs_of_a_seed_share() {
        // Twice as many in every pair but for a little, while the seeds themselves differ tenfold.
        let (first, second) = ([20.0, 101.0, 199.0], [10.0, 50.0, 100.0]);
        let traffic = [1.0; 3];
        let paired = paired_ratio((&first, &traffic), (&second, &traffic)).unwrap();
        let unpaired = rate_ratio((&first, &traffic), (&second, &traffic)).unwrap();
        assert_eq!((paired.value, paired.method), (Some(2.0), IntervalMethod::TOverPairs));
        // The deviations differ by 0, 1/160 · 1.5 and -1/160 · 1.5 of the mean counts 320/3 and 160/3.
        let spread = (2.0 * (1.0_f64 / (320.0 / 3.0)).powi(2) / 2.0 / 3.0).sqrt();
        near(paired.low, 2.0 * (-t_quantile(2.0).unwrap() * spread).exp());
        assert!(unpaired.low < 0.5 && unpaired.high.unwrap() > 10.0, "{unpaired:?}");
    }

    #[test]
    fn pairs_without_any_difference_get_the_interval_of_counts() {
        let equal = ([3.0, 5.0], [1.0, 1.0]);
        let ratio = paired_ratio((&equal.0, &equal.1), (&equal.0, &equal.1)).unwrap();
        assert!(ratio.value == Some(1.0) && ratio.low < 0.9 && ratio.method != IntervalMethod::TOverPairs);
    }
}
