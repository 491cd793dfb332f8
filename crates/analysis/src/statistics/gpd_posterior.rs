//! The crash frequency from a sample of excesses: the posterior of Jeffreys' prior, as three quantiles.
//!
//! The prior of the generalised Pareto distribution is 1 / (σ (1 + ξ) √(1 + 2ξ)) with ξ > −1/2 (Castellanos and Cabras 2007,
//! *A default Bayesian procedure for the generalized Pareto distribution*), that of the number of excesses Λ^(−1/2). The
//! interval covers like one of profile likelihood, and its median is less biased than the plug-in of maximum likelihood,
//! which is low: P(excess > threshold) is 0 as soon as the fitted distribution ends before the threshold.
//! docs/statistics_how.md has the coverage that `closecall study` measures.
//!
//! In θ = ξ/σ and σ the posterior has a closed form over σ: with m excesses below the bound, A(θ) the sum of their
//! ln(1 + θ y) and B(θ) that of all ln(1 + θ y) / θ it is
//!
//! ```text
//! e^−A(θ) · σ^−m e^(−B(θ)/σ) / ( (1 + θσ) √(1 + 2θσ) )
//! ```
//!
//! The last factor apart, σ has an inverse gamma distribution; so σ and Λ are taken at equally likely places of theirs, and θ
//! at equal distances of ln(1 + θ · largest excess).

use statrs::distribution::{ContinuousCDF, Gamma};

use super::gpd::Excesses;
use super::rate::TAIL;

/// The search for where the posterior is: from −this to this in ln(1 + θ · largest excess).
const FAR: f64 = 40.0;
/// Its steps.
const COARSE: f64 = 0.25;
/// Places whose posterior is less than e to the minus this of the largest are left out.
const NEGLIGIBLE: f64 = 18.0;
/// The number of places of θ, σ and Λ.
const THETAS: usize = 120;
const SCALES: usize = 16;
const NUMBERS: usize = 32;
/// The places of σ and Λ are shifted from θ to θ, by this many parts of their distance: so all of them together are dense.
const SHIFTS: usize = 16;

/// The 2.5, 50 and 97.5 % quantiles of the frequency of excesses of at least `threshold`, from a sample of `hours`.
pub(crate) fn crash_frequency(excesses: Excesses, threshold: f64, hours: f64) -> Option<[f64; 3]> {
    let count = excesses.within.len() as f64;
    let theta = |place: f64| place.exp_m1() / excesses.most;
    // The logarithm of the posterior of a place, over all σ and without the prior of ξ.
    let of_place = |place: f64| {
        let theta = theta(place);
        let [within, _] = excesses.logarithms(theta);
        let density = place - within - (count - 1.0) * excesses.slope(theta).ln();
        if density.is_nan() { f64::NEG_INFINITY } else { density }
    };
    let steps = (2.0 * FAR / COARSE) as usize;
    let coarse = (0..=steps).map(|step| -FAR + COARSE * step as f64).map(|place| (place, of_place(place)));
    let coarse = coarse.collect::<Vec<_>>();
    let most = coarse.iter().map(|(_, density)| *density).fold(f64::NEG_INFINITY, f64::max);
    let mut likely = coarse.iter().filter(|(_, density)| *density > most - NEGLIGIBLE).map(|(place, _)| *place);
    let first = likely.next()?;
    let (low, high) = (first - COARSE, likely.next_back().unwrap_or(first) + COARSE);
    let inverse_scales = quantiles(count - 1.0, SHIFTS * SCALES)?;
    let numbers = quantiles(count + excesses.censored + 0.5, SHIFTS * NUMBERS)?;
    let mut weighted = Vec::with_capacity(THETAS * SCALES * NUMBERS);
    for at in 0..THETAS {
        let place = low + (high - low) * (at as f64 + 0.5) / THETAS as f64;
        // Two odd factors, so that neighbours are far apart and σ and Λ are not shifted alike.
        let [shift, other_shift] = [5, 7].map(|factor| at * factor % SHIFTS);
        let theta = theta(place);
        let slope = excesses.slope(theta);
        let likelihood = (of_place(place) - most).exp();
        for inverse in inverse_scales.iter().skip(shift).step_by(SHIFTS) {
            let scale = slope / inverse;
            let shape = theta * scale;
            let weight = likelihood / ((1.0 + shape) * (1.0 + 2.0 * shape).sqrt());
            // NaN where ξ ≤ −1/2.
            if weight > 0.0 && weight.is_finite() {
                let share = survival(theta, scale, threshold);
                let numbers = numbers.iter().skip(other_shift).step_by(SHIFTS);
                weighted.extend(numbers.map(|number| (number * share / hours, weight)));
            }
        }
    }
    weighted_quantiles(weighted, [TAIL, 0.5, 1.0 - TAIL])
}

/// P(Y > y) of θ and σ.
fn survival(theta: f64, scale: f64, y: f64) -> f64 {
    if theta * y <= -1.0 {
        return 0.0;
    }
    if theta == 0.0 { (-y / scale).exp() } else { (-(theta * y).ln_1p() / (theta * scale)).exp() }
}

/// Equally likely places of a gamma distribution of this shape and scale 1.
fn quantiles(shape: f64, places: usize) -> Option<Vec<f64>> {
    let gamma = Gamma::new(shape, 1.0).ok()?;
    Some((0..places).map(|place| gamma.inverse_cdf((place as f64 + 0.5) / places as f64)).collect())
}

/// The values below which these shares of the weight are.
fn weighted_quantiles(mut weighted: Vec<(f64, f64)>, shares: [f64; 3]) -> Option<[f64; 3]> {
    weighted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let all = weighted.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut values = weighted.into_iter();
    let (mut found, mut below) = values.next()?;
    Some(shares.map(|share| {
        while below < share * all {
            let Some((value, weight)) = values.next() else { break };
            (found, below) = (value, below + weight);
        }
        found
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_exponential_excesses_give_their_frequency_with_the_error_of_both_numbers() {
        // The quantiles of an exponential distribution of scale 1, to a tenth of one crash.
        let sorted = (0..1000).map(|place| -(1.0 - (f64::from(place) + 0.5) / 1000.0).ln()).collect::<Vec<_>>();
        let [low, middle, high] = crash_frequency(Excesses::of(&sorted, f64::INFINITY), 5.0, 2.0).unwrap();
        let truth = 500.0 * (-5.0_f64).exp();
        assert!((middle / truth - 1.0).abs() < 0.2, "{middle}, not {truth}");
        // The error of ln P(Y > 5) at ξ = 0 by the delta method: Var ξ = 1/n, Var ln σ = 2/n, Cov = −1/n, slopes 12.5 and 5.
        let error = ((12.5_f64.powi(2) + 2.0 * 25.0 - 2.0 * 62.5 + 1.0) / 1000.0).sqrt();
        assert!(((high / low).ln() / (2.0 * 1.96 * error) - 1.0).abs() < 0.25, "{low} {high} {error}");
    }

    #[test]
    fn a_distribution_that_ends_before_the_threshold_allows_no_crash() {
        let sorted = (0..200).map(|place| 1.0 - (1.0 - (f64::from(place) + 0.5) / 200.0).powf(0.4)).collect::<Vec<_>>();
        let found = crash_frequency(Excesses::of(&sorted, f64::INFINITY), 3.0, 1.0).unwrap();
        assert!(found[..2] == [0.0; 2] && found[2] < 1.0, "{found:?}");
    }

    #[test]
    fn quantiles_are_where_the_weight_is() {
        let values = vec![(3.0, 1.0), (1.0, 0.5), (2.0, 100.0)];
        assert_eq!(weighted_quantiles(values, [0.001, 0.5, 0.999]), Some([1.0, 2.0, 3.0]));
        assert_eq!(weighted_quantiles(vec![], [0.1, 0.5, 0.9]), None);
    }
}
