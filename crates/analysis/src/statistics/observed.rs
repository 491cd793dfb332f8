//! Crashes in one set of runs, from those observed in reality for the other set.
//!
//! Simulated conflicts do not give a number of crashes, but the ratio of two plans' conflicts can be applied to an observed
//! number: crashes of B per year = crashes of A per year · (conflicts of B / conflicts of A)ᵖ. The crashes of A are Poisson;
//! with Jeffreys' prior their frequency is gamma distributed with shape k + ½ and the years as rate (the Gamma–Poisson model:
//! Hauer 1997, *Observational Before–After Studies in Road Safety*). The ratio is lognormal with the width of its own interval.
//! The power p is 1 unless crashes and conflicts grow differently, which is unknown here: 0.5 and 1.5 show how much it matters.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Gamma, Normal};

use super::rate::{Ratio, TAIL};

/// The powers of the ratio: the first is the answer, the others the sensitivity.
const POWERS: [f64; 3] = [1.0, 0.5, 1.5];
/// Equally likely places of the frequency, and of the ratio.
const PLACES: usize = 400;

/// Crashes observed in reality.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// Their number.
    pub crashes: u64,
    /// The years in which they were observed.
    pub years: f64,
}

/// A frequency with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerYear {
    /// Crashes per year: the median.
    pub value: f64,
    /// The interval's lower end.
    pub low: f64,
    /// The interval's upper end.
    pub high: f64,
}

/// What is to be expected in the other plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Transferred {
    /// The crashes that were observed.
    pub observed: u64,
    /// The years in which they were.
    pub years: f64,
    /// The frequency there.
    pub against: PerYear,
    /// The frequency of the first set, for each power of the ratio.
    pub powers: Vec<PowerOfRatio>,
    /// Its interval if only the observed number were uncertain.
    pub by_observed: PerYear,
    /// Its interval if only the ratio were.
    pub by_ratio: PerYear,
}

/// The frequency with one power of the ratio.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PowerOfRatio {
    /// The power.
    pub power: f64,
    /// The frequency.
    #[serde(flatten)]
    pub per_year: PerYear,
}

/// Applies a ratio of conflicts to observed crashes; none where the ratio has no finite interval.
pub(crate) fn transfer(observed: Observed, ratio: &Ratio) -> Option<Transferred> {
    let (value, high) = (ratio.value?, ratio.high?);
    if value <= 0.0 || ratio.low <= 0.0 || observed.years <= 0.0 {
        return None;
    }
    let frequencies = Gamma::new(observed.crashes as f64 + 0.5, observed.years).ok()?;
    let normal = Normal::standard();
    let spread = (high / ratio.low).ln() / 2.0 / normal.inverse_cdf(1.0 - TAIL);
    let places = (0..PLACES).map(|place| (place as f64 + 0.5) / PLACES as f64);
    let of_observed = places.clone().map(|place| frequencies.inverse_cdf(place)).collect::<Vec<_>>();
    let of_ratio = places.map(|place| value.ln() + spread * normal.inverse_cdf(place)).collect::<Vec<_>>();
    let [middle, middle_ratio] = [vec![frequencies.inverse_cdf(0.5)], vec![value.ln()]];
    let per_year = |frequencies: &[f64], ratios: &[f64], power: f64| {
        let products = frequencies.iter().flat_map(|one| ratios.iter().map(move |ratio| one * (power * ratio).exp()));
        quantiles(products.collect())
    };
    Some(Transferred {
        observed: observed.crashes,
        years: observed.years,
        against: quantiles(of_observed.clone()),
        powers: POWERS.map(|power| PowerOfRatio { power, per_year: per_year(&of_observed, &of_ratio, power) }).to_vec(),
        by_observed: per_year(&of_observed, &middle_ratio, 1.0),
        by_ratio: per_year(&middle, &of_ratio, 1.0),
    })
}

fn quantiles(mut values: Vec<f64>) -> PerYear {
    values.sort_unstable_by(f64::total_cmp);
    let at = |share| super::quantiles::quantile(&values, share).unwrap_or_default();
    PerYear { value: at(0.5), low: at(TAIL), high: at(1.0 - TAIL) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::rate::IntervalMethod;

    fn ratio(value: f64, factor: f64) -> Ratio {
        Ratio { value: Some(value), low: value / factor, high: Some(value * factor), method: IntervalMethod::TOverRuns }
    }

    fn near(found: f64, wanted: f64) {
        assert!((found / wanted - 1.0).abs() < 0.02, "{found}, not {wanted}");
    }

    const OBSERVED: Observed = Observed { crashes: 14, years: 5.0 };

    #[test]
    fn a_certain_ratio_leaves_the_interval_of_the_observed_number() {
        let found = transfer(OBSERVED, &ratio(0.5, 1.0 + 1e-9)).unwrap();
        // scipy.stats.gamma.ppf([0.025, 0.5, 0.975], 14.5) / 5
        for (found, wanted) in
            [(found.against.low, 1.60471), (found.against.value, 2.83367), (found.against.high, 4.57223)]
        {
            near(found, wanted);
        }
        near(found.powers[0].per_year.low, 0.5 * found.against.low);
        near(found.powers[1].per_year.value, 0.5_f64.sqrt() * found.against.value);
        near(found.by_ratio.high, found.by_ratio.low);
    }

    #[test]
    fn the_variances_of_both_sources_add() {
        let found = transfer(Observed { crashes: 400, years: 1.0 }, &ratio(0.5, 1.4)).unwrap();
        let width = |of: PerYear| (of.high / of.low).ln();
        near(width(found.powers[0].per_year), width(found.by_observed).hypot(width(found.by_ratio)));
        near(width(found.by_ratio), 2.0 * 1.4_f64.ln());
        assert!(width(found.powers[1].per_year) < width(found.powers[2].per_year));
    }

    #[test]
    fn a_ratio_without_an_end_transfers_nothing() {
        let open = Ratio { high: None, ..ratio(0.5, 2.0) };
        assert_eq!(transfer(OBSERVED, &open), None);
        assert_eq!(transfer(OBSERVED, &Ratio { value: Some(0.0), low: 0.0, ..ratio(0.5, 2.0) }), None);
        assert!(transfer(Observed { crashes: 0, years: 5.0 }, &ratio(0.5, 2.0)).is_some());
    }
}
