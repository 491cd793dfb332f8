//! The observed order of convergence and the value at a step of 0, from the three finest steps (Richardson 1911).
//!
//! With f(h) = f₀ + C hᵖ and steps h₁ < h₂ < h₃ in any ratio,
//!
//! ```text
//! (f₃ − f₂) / (f₂ − f₁) = (h₃ᵖ − h₂ᵖ) / (h₂ᵖ − h₁ᵖ)
//! ```
//!
//! which grows with p. A sequence that turns, or whose changes do not shrink, has no order; nor has one whose order or limit
//! is known to no better than its own size, or whose limit is negative although the measure cannot be.

use super::estimate::mean;
use crate::statistics::t_quantile;

/// Changes that shrink faster than this order are a jump, not convergence: SUMO's integration is of order 1 or 2.
const MOST: f64 = 6.0;
/// The factor of safety of the grid convergence index with three grids (Roache 1994; ASME V&V 20-2009).
const SAFETY: f64 = 1.25;
/// The same without an observed order, with which convergence of order 1 is assumed (Roache 1994).
const SAFETY_WITHOUT_ORDER: f64 = 3.0;

/// What the three finest steps tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Convergence {
    /// The order, the value at a step of 0, and half the width of its 95 % interval.
    Order { order: f64, limit: f64, half_width: f64 },
    /// The three finest do not differ beyond the noise over seeds.
    WithinNoise,
    /// The changes have both signs.
    NotMonotone,
    /// The changes do not shrink fast enough for a limit, or not like those of a power of the step.
    NoPower,
    /// The seeds do not agree on an order.
    SeedsDisagree,
    /// The order or the limit has an error larger than its value.
    Uncertain,
    /// The limit is below 0, where the measure cannot be.
    Negative,
    /// There are less than three steps.
    TooFew,
}

impl Convergence {
    /// In words, where no order is found.
    pub(crate) fn why_none(&self) -> &'static str {
        match self {
            Self::Order { .. } => "",
            Self::WithinNoise => "none: the three finest differ by no more than the seeds' noise",
            Self::NotMonotone => "none: not monotone",
            Self::NoPower => "none: the changes do not shrink like a power of the step",
            Self::SeedsDisagree => "none: the seeds do not agree on one",
            Self::Uncertain => "none: its error is larger than its value",
            Self::Negative => "none: it would end below 0",
            Self::TooFew => "none: it takes three steps",
        }
    }
}

/// The convergence over steps, the finest first, each with one value per seed in the same order.
///
/// The interval of the limit joins two errors as independent: 1.25 times the change from the finest step to the limit, and
/// the jackknife's over seeds.
pub(crate) fn convergence(steps: &[f64], runs: &[Vec<f64>], may_be_negative: bool) -> Convergence {
    let ([one, two, three, ..], [first, second, third, ..]) = (steps, runs) else { return Convergence::TooFew };
    let (steps, runs) = ([*one, *two, *three], [first, second, third]);
    let seeds = first.len().min(second.len()).min(third.len());
    let differ = |a: &[f64], b: &[f64]| {
        let changes = a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
        mean(&changes).is_some_and(|change| change.value != 0.0 && !change.may_be_zero())
    };
    if !differ(first, second) && !differ(second, third) && !differ(first, third) {
        return Convergence::WithinNoise;
    }
    let without = |left_out: Option<usize>| {
        runs.map(|of| {
            let kept = of[..seeds].iter().enumerate().filter(|(seed, _)| Some(*seed) != left_out);
            kept.clone().map(|(_, value)| value).sum::<f64>() / kept.count() as f64
        })
    };
    let values = without(None);
    let order = match order(steps, values) {
        Ok(order) => order,
        Err(none) => return none,
    };
    let limit = limit(steps, values, order);
    let [mut order_noise, mut noise] = [0.0; 2];
    if seeds > 1 {
        let (mut orders, mut limits) = (Vec::with_capacity(seeds), Vec::with_capacity(seeds));
        for seed in 0..seeds {
            let values = without(Some(seed));
            let Ok(order) = self::order(steps, values) else { return Convergence::SeedsDisagree };
            orders.push(order);
            limits.push(self::limit(steps, values, order));
        }
        (order_noise, noise) = (jackknife(&orders), jackknife(&limits));
    }
    let half_width = noise.hypot(SAFETY * (limit - values[0]));
    if limit < 0.0 && !may_be_negative {
        Convergence::Negative
    } else if order_noise > order || half_width > limit.abs() {
        Convergence::Uncertain
    } else {
        Convergence::Order { order, limit, half_width }
    }
}

/// Half the 95 % interval of an estimate, from those that leave out one seed each.
fn jackknife(without_one: &[f64]) -> f64 {
    let count = without_one.len() as f64;
    let middle = without_one.iter().sum::<f64>() / count;
    let squares = without_one.iter().map(|one| (one - middle).powi(2)).sum::<f64>();
    t_quantile(count - 1.0).unwrap_or_default() * (squares * (count - 1.0) / count).sqrt()
}

/// What the finest step itself may be off by, relative to its value: half the limit's interval where there is an order; else
/// three times the change that an order of 1 leaves, by the next step or the one after it, whichever says more. None with a
/// single step, or with nothing at the finest.
pub(crate) fn own_error(steps: &[f64], means: &[f64], convergence: Convergence) -> Option<f64> {
    let (finest, value) = (*steps.first()?, means.first().copied().filter(|value| *value != 0.0)?);
    if let Convergence::Order { half_width, .. } = convergence {
        return Some(half_width / value.abs());
    }
    let left = |(step, mean): (&f64, &f64)| SAFETY_WITHOUT_ORDER * (mean - value).abs() / (step / finest - 1.0);
    let others = steps.iter().zip(means).skip(1).take(2).map(left);
    others.max_by(f64::total_cmp).map(|left| left / value.abs())
}

/// The order p of f(h) = f₀ + C hᵖ through three values at three steps, the finest first.
fn order(steps: [f64; 3], values: [f64; 3]) -> Result<f64, Convergence> {
    let [finer, coarser] = [values[1] - values[0], values[2] - values[1]];
    if finer * coarser < 0.0 {
        return Err(Convergence::NotMonotone);
    }
    let wanted = coarser / finer;
    let excess = |order: f64| growth(steps, order) - wanted;
    let (mut low, mut high) = (1e-3, MOST);
    // NaN where nothing changes at all.
    if excess(low).is_nan() || excess(low) > 0.0 || excess(high) < 0.0 {
        return Err(Convergence::NoPower);
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

/// How many times the change between the coarser two steps is that between the finer two.
fn growth([one, two, three]: [f64; 3], order: f64) -> f64 {
    // In units of the middle step, so that no power overflows.
    ((three / two).powf(order) - 1.0) / (1.0 - (one / two).powf(order))
}

fn limit(steps: [f64; 3], values: [f64; 3], order: f64) -> f64 {
    values[0] - (values[1] - values[0]) / ((steps[1] / steps[0]).powf(order) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(steps: [f64; 3], value: impl Fn(f64) -> f64) -> Convergence {
        convergence(&steps, &steps.map(|step| vec![value(step)]), true)
    }

    #[test]
    fn a_known_order_is_found_with_any_ratio_of_steps() {
        for steps in [[0.1, 0.2, 0.4], [0.05, 0.1, 0.2], [0.1, 0.2, 0.5], [0.2, 0.5, 1.0]] {
            for wanted in [0.5, 1.0, 2.0, 4.0] {
                for factor in [-3.0, 70.0] {
                    let Convergence::Order { order, limit, half_width } =
                        of(steps, |step| 50.0 + factor * step.powf(wanted))
                    else {
                        panic!("{steps:?} {wanted}")
                    };
                    assert!((order - wanted).abs() < 1e-6 && (limit - 50.0).abs() < 1e-6, "{order} {limit}");
                    let error = factor * steps[0].powf(wanted);
                    assert!((half_width - 1.25 * error.abs()).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn a_sequence_that_turns_or_does_not_shrink_has_no_order() {
        let steps = [0.1, 0.2, 0.4];
        let of_values = |values: [f64; 3]| convergence(&steps, &values.map(|value| vec![value]), true);
        assert_eq!(of_values([10.0, 12.0, 11.0]), Convergence::NotMonotone);
        assert_eq!(of_values([10.0, 13.0, 15.0]), Convergence::NoPower);
        assert_eq!(of_values([10.0, 10.0, 15.0]), Convergence::NoPower);
        assert_eq!(convergence(&steps[..2], &[vec![1.0], vec![2.0]], true), Convergence::TooFew);
    }

    #[test]
    fn noise_over_seeds_widens_the_limit_or_denies_it() {
        let steps = [0.1, 0.2, 0.4];
        let with = |noise: [f64; 4]| {
            let of = |step: f64, sign: f64| noise.map(|noise| 50.0 + 100.0 * step + sign * noise).to_vec();
            convergence(&steps, &[of(0.1, 1.0), of(0.2, -1.0), of(0.4, 0.5)], true)
        };
        let Convergence::Order { limit, half_width, .. } = with([0.5, -0.5, 0.5, -0.5]) else { panic!() };
        assert!((limit - 50.0).abs() < 1e-6 && half_width > 1.25 * 10.0 && half_width < 20.0, "{half_width}");
        // Neighbours that differ by less than the noise, in a row that does not.
        let slow = [[0.0, 6.0, 0.0, 6.0], [5.0, 5.0, 5.0, 9.0], [8.0, 13.0, 5.0, 12.0]].map(|values| values.to_vec());
        assert_eq!(convergence(&steps, &slow, true), Convergence::SeedsDisagree);
        assert_eq!(with([300.0, -300.0, 300.0, -300.0]), Convergence::WithinNoise);
        assert_eq!(with([0.0; 4]), of(steps, |step| 50.0 + 100.0 * step));
    }

    /// The steps and values f₀ + C hᵖ of a slow convergence, with a little noise over three seeds.
    fn slow(limit: f64, order: f64, noise: f64) -> ([f64; 3], [Vec<f64>; 3]) {
        let steps = [0.05_f64, 0.1, 0.2];
        let of = |step: f64| limit + (48.0 - limit) * (step / 0.05).powf(order);
        (steps, steps.map(|step| [-1.0, 0.0, 1.0].map(|sign| of(step) + sign * noise * step).to_vec()))
    }

    #[test]
    fn an_order_whose_error_is_larger_than_its_value_is_none() {
        // 48.0 conflicts per vehicle-hour at 0.05 s, extrapolated to 9.48 ± 303; of rear-end ones to −7.6 ± 219.
        for (limit, wanted) in [(9.48, Convergence::Uncertain), (-7.6, Convergence::Negative)] {
            let (steps, runs) = slow(limit, 0.3, 1.0);
            assert_eq!(convergence(&steps, &runs, false), wanted);
        }
        // A margin may be negative.
        let (steps, runs) = slow(-30.0, 1.0, 0.0);
        assert!(matches!(convergence(&steps, &runs, true), Convergence::Uncertain));
        let (steps, runs) = slow(45.1, 1.0, 0.1);
        assert!(matches!(convergence(&steps, &runs, false), Convergence::Order { .. }));
    }

    #[test]
    fn the_finest_step_has_an_error_of_its_own() {
        // 0.1 s is off by −3.0 % against 0.05 s, which is itself off by −8.7 % against 0.02 s.
        let off = own_error(&[0.05, 0.1], &[100.0, 97.0], Convergence::TooFew).unwrap();
        assert!((0.087..0.1).contains(&off), "{off}");
        // Two finest steps that agree by chance.
        let off = own_error(&[0.05, 0.1, 0.2], &[100.0, 100.0, 80.0], Convergence::NotMonotone).unwrap();
        assert!((off - 0.2).abs() < 1e-12, "{off}");
        let found = Convergence::Order { order: 1.0, limit: 45.1, half_width: 4.0 };
        assert_eq!(own_error(&[0.05, 0.1, 0.2], &[50.0, 55.0, 65.0], found), Some(0.08));
        assert_eq!(own_error(&[0.05], &[100.0], Convergence::TooFew), None);
        assert_eq!(own_error(&[0.05, 0.1], &[0.0, 1.0], Convergence::TooFew), None);
    }

    #[test]
    fn equal_values_are_converged_within_noise() {
        assert_eq!(convergence(&[0.1, 0.2, 0.4], &[vec![3.0], vec![3.0], vec![3.0]], true), Convergence::WithinNoise);
    }
}
