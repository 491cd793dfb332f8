//! Quantiles of a measure, and the overlap of two samples.

use serde::Serialize;

/// Quantiles of one measure; all none if no conflict has it.
///
/// They are linear between order statistics, as in R's type 7 and numpy's default (Hyndman and Fan 1996).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// The number of conflicts that have the measure.
    pub count: u64,
    /// 5 % are below.
    pub q05: Option<f64>,
    /// 25 % are below.
    pub q25: Option<f64>,
    /// The median.
    pub q50: Option<f64>,
    /// 75 % are below.
    pub q75: Option<f64>,
    /// 95 % are below.
    pub q95: Option<f64>,
}

impl Quantiles {
    /// The quantiles of values, whose order changes.
    pub fn of(values: &mut [f64]) -> Self {
        const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
        if let Some(last) = values.len().checked_sub(1) {
            let ends = |share: f64| [(share * last as f64).floor() as usize, (share * last as f64).ceil() as usize];
            let mut places = SHARES.map(ends).concat();
            // Of few values the ends of two shares may be the same.
            places.sort_unstable();
            places.dedup();
            settle(values, &places, 0);
        }
        let [q05, q25, q50, q75, q95] = SHARES.map(|share| quantile(values, share));
        Self { count: values.len() as u64, q05, q25, q50, q75, q95 }
    }
}

/// Puts the values at these places, which ascend from `first` on, where sorting would put them.
fn settle(values: &mut [f64], places: &[usize], first: usize) {
    let (before, rest) = places.split_at(places.len() / 2);
    let Some((place, after)) = rest.split_first() else { return };
    let (below, _, above) = values.select_nth_unstable_by(place - first, f64::total_cmp);
    settle(below, before, first);
    settle(above, after, place + 1);
}

/// A quantile of values in ascending order; none without values.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * (sorted.len().checked_sub(1)? as f64);
    let low = sorted[place.floor() as usize];
    let high = sorted[place.ceil() as usize];
    Some(low + (high - low) * place.fract())
}

/// A quantile of values in any order, which changes; none without values. Faster than sorting them.
pub fn select(values: &mut [f64], share: f64) -> Option<f64> {
    let place = share * (values.len().checked_sub(1)? as f64);
    let (_, low, above) = values.select_nth_unstable_by(place.floor() as usize, f64::total_cmp);
    let high = above.iter().copied().min_by(f64::total_cmp).unwrap_or(*low);
    Some(*low + (high - *low) * place.fract())
}

/// Cliff's delta of two samples in ascending order: P(a > b) − P(a < b), from −1 to 1 (Cliff 1993).
pub(crate) fn cliffs_delta(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.is_empty() || b.is_empty() {
        return None;
    }
    let mut below = 0;
    let mut not_above = 0;
    let mut sum = 0.0;
    for value in a {
        while below < b.len() && b[below] < *value {
            below += 1;
        }
        while not_above < b.len() && b[not_above] <= *value {
            not_above += 1;
        }
        sum += below as f64 - (b.len() - not_above) as f64;
    }
    Some(sum / a.len() as f64 / b.len() as f64)
}

#[cfg(test)]
mod tests {
    use crate::statistics::quantiles::*;

    #[test]
    fn quantiles_lie_between_order_statistics() {
        let found = Quantiles::of(&mut [3.0, 1.0, 4.0, 2.0]);
        assert_eq!((found.q25, found.q50, found.q95), (Some(1.75), Some(2.5), Some(3.8499999999999996)));
        assert_eq!(Quantiles::of(&mut []), Quantiles::default());
        assert_eq!(quantile(&[7.0], 0.95), Some(7.0));
    }

    proptest::proptest! {
        #[test]
        fn selected_quantiles_are_those_of_sorted_values(
            mut values in proptest::collection::vec(-5.0..5.0_f64, 0..40),
            share in 0.0..=1.0_f64,
        ) {
            let selected = select(&mut values, share);
            values.sort_unstable_by(f64::total_cmp);
            proptest::prop_assert_eq!(selected, quantile(&values, share));
        }

        #[test]
        fn quantiles_together_are_those_of_sorted_values(
            mut values in proptest::collection::vec(-5.0..5.0_f64, 0..400),
        ) {
            let Quantiles { q05, q25, q50, q75, q95, .. } = Quantiles::of(&mut values);
            values.sort_unstable_by(f64::total_cmp);
            let sorted = [0.05, 0.25, 0.5, 0.75, 0.95].map(|share| quantile(&values, share));
            proptest::prop_assert_eq!([q05, q25, q50, q75, q95], sorted);
        }
    }

    #[test]
    fn cliffs_delta_counts_pairs() {
        assert_eq!(cliffs_delta(&[1.0, 2.0], &[3.0, 4.0]), Some(-1.0));
        assert_eq!(cliffs_delta(&[1.0, 2.0, 2.0], &[2.0, 2.0]), Some(-1.0 / 3.0));
        assert_eq!(cliffs_delta(&[], &[1.0]), None);
    }
}
