//! The observed order of convergence and the value at a step of 0, from the three finest steps (Richardson 1911).
//!
//! With f(h) = f₀ + C hᵖ and steps h₁ < h₂ < h₃ in any ratio,
//!
//! ```text
//! (f₃ − f₂) / (f₂ − f₁) = (h₃ᵖ − h₂ᵖ) / (h₂ᵖ − h₁ᵖ)
//! ```
//!
//! which grows with p. A sequence that turns, or whose changes do not shrink, has no order.

use super::estimate::mean;
use crate::analysis::statistics::t_quantile;

/// Changes that shrink faster than this order are a jump, not convergence: SUMO's integration is of order 1 or 2.
const MOST: f64 = 6.0;
/// The factor of safety of the grid convergence index with three grids (Roache 1994; ASME V&V 20-2009).
const SAFETY: f64 = 1.25;

/// What the three finest steps tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Convergence {
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
    /// There are less than three steps.
    TooFew,
}

impl Convergence {
    /// In words, where no order is found.
    pub fn why_none(&self) -> &'static str {
        match self {
            Self::Order { .. } => "",
            Self::WithinNoise => "none: the three finest differ by no more than the seeds' noise",
            Self::NotMonotone => "none: not monotone",
            Self::NoPower => "none: the changes do not shrink like a power of the step",
            Self::SeedsDisagree => "none: the seeds do not agree on one",
            Self::TooFew => "none: it takes three steps",
        }
    }
}

/// The convergence over steps, the finest first, each with one value per seed in the same order.
///
/// The interval of the limit joins two errors as independent: 1.25 times the change from the finest step to the limit, and
/// the jackknife's standard error over seeds.
pub fn convergence(steps: &[f64], runs: &[Vec<f64>]) -> Convergence {
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
    let mut noise = 0.0;
    if seeds > 1 {
        let mut limits = Vec::with_capacity(seeds);
        for seed in 0..seeds {
            let values = without(Some(seed));
            match self::order(steps, values) {
                Ok(order) => limits.push(self::limit(steps, values, order)),
                Err(_) => return Convergence::SeedsDisagree,
            }
        }
        let count = seeds as f64;
        let middle = limits.iter().sum::<f64>() / count;
        let squares = limits.iter().map(|limit| (limit - middle).powi(2)).sum::<f64>();
        noise = t_quantile(count - 1.0).unwrap_or_default() * (squares * (count - 1.0) / count).sqrt();
    }
    Convergence::Order { order, limit, half_width: noise.hypot(SAFETY * (limit - values[0])) }
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
        convergence(&steps, &steps.map(|step| vec![value(step)]))
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
        let of_values = |values: [f64; 3]| convergence(&steps, &values.map(|value| vec![value]));
        assert_eq!(of_values([10.0, 12.0, 11.0]), Convergence::NotMonotone);
        assert_eq!(of_values([10.0, 13.0, 15.0]), Convergence::NoPower);
        assert_eq!(of_values([10.0, 10.0, 15.0]), Convergence::NoPower);
        assert_eq!(convergence(&steps[..2], &[vec![1.0], vec![2.0]]), Convergence::TooFew);
    }

    #[test]
    fn noise_over_seeds_widens_the_limit_or_denies_it() {
        let steps = [0.1, 0.2, 0.4];
        let with = |noise: [f64; 4]| {
            let of = |step: f64, sign: f64| noise.map(|noise| 50.0 + 100.0 * step + sign * noise).to_vec();
            convergence(&steps, &[of(0.1, 1.0), of(0.2, -1.0), of(0.4, 0.5)])
        };
        let Convergence::Order { limit, half_width, .. } = with([0.5, -0.5, 0.5, -0.5]) else { panic!() };
        assert!((limit - 50.0).abs() < 1e-6 && half_width > 1.25 * 10.0 && half_width < 20.0, "{half_width}");
        // Neighbours that differ by less than the noise, in a row that does not.
        let slow = [[0.0, 6.0, 0.0, 6.0], [5.0, 5.0, 5.0, 9.0], [8.0, 13.0, 5.0, 12.0]].map(|values| values.to_vec());
        assert_eq!(convergence(&steps, &slow), Convergence::SeedsDisagree);
        assert_eq!(with([300.0, -300.0, 300.0, -300.0]), Convergence::WithinNoise);
        assert_eq!(with([0.0; 4]), of(steps, |step| 50.0 + 100.0 * step));
    }

    #[test]
    fn equal_values_are_converged_within_noise() {
        assert_eq!(convergence(&[0.1, 0.2, 0.4], &[vec![3.0], vec![3.0], vec![3.0]]), Convergence::WithinNoise);
    }
}
