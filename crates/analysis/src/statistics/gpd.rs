//! The generalised Pareto distribution of excesses over a threshold: maximum likelihood and goodness of fit.
//!
//! An excess that reaches a bound is censored there. No crate offers the fit. With θ = ξ/σ, m excesses below the bound and k at
//! it, the likelihood's maximum over ξ has a closed form,
//!
//! ```text
//! ξ(θ) = ( Σ ln(1 + θ y) + k ln(1 + θ bound) ) / m
//! ```
//!
//! and only one dimension is left to search (Davison 1984; Grimshaw 1993). For ξ < −1 the likelihood is unbounded; the
//! search ends there, as is usual.

use closecall::util::golden_section::golden_section;

/// Shape ξ and scale σ: P(Y > y) = (1 + ξ y / σ)^(−1/ξ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gpd {
    /// ξ; below 0 the excess is at most −σ/ξ.
    pub shape: f64,
    /// σ, above 0.
    pub scale: f64,
}

/// A shape smaller than this counts as 0: the exponential distribution.
const NO_SHAPE: f64 = 1e-9;
/// The number of points of the coarse search on each side of θ = 0.
const COARSE: i32 = 16;
/// Steps of the golden section: the bracket's last width is 10⁻⁷ of its first.
const FINE: u32 = 34;
/// A test of fit ends after this many samples that fit worse: with at most 199 it decides at 0.1 as all of them would.
const ENOUGH: usize = 20;

impl Gpd {
    /// The maximum-likelihood distribution of these excesses, all ≥ 0; none if they are all 0.
    pub fn fit(excesses: Excesses) -> Option<Self> {
        let Excesses { within, most, .. } = excesses;
        if !(most > 0.0 && most.is_finite()) || within.is_empty() {
            return None;
        }
        let mean = excesses.slope(0.0) / within.len() as f64;
        // θ as a function of the search's variable: from −1/most, where the support would end, to far above 0.
        let theta = |place: f64| {
            if place < 0.0 {
                -(1.0 - 10_f64.powf(-0.5 * -place)) / most
            } else {
                (10_f64.powf(0.25 * place) - 1.0) / mean
            }
        };
        let likelihood = |place: f64| profile(excesses, theta(place), mean);
        let places = (-COARSE..=COARSE).map(f64::from);
        let best = places.max_by(|a, b| likelihood(*a).total_cmp(&likelihood(*b)))?;
        // Mirrored: on a tie the search must go towards larger places, away from where the likelihood is −∞.
        let (low, high) = golden_section(|place| likelihood(-place), -best - 1.0, -best + 1.0, FINE);
        let theta = theta(-(low + high) / 2.0);
        let (shape, _) = shape_of(excesses, theta);
        if shape.abs() < NO_SHAPE {
            return Some(Self { shape: 0.0, scale: mean });
        }
        // At the bound ξ = −1 the maximum-likelihood scale is the largest excess: the uniform distribution, which no
        // censored excess passes.
        let bounded = excesses.censored == 0.0 && (profile(excesses, theta, mean) < -most.ln() || shape < -1.0);
        Some(if bounded { Self { shape: -1.0, scale: most } } else { Self { shape, scale: shape / theta } })
    }

    /// P(Y > y).
    pub fn survival(&self, y: f64) -> f64 {
        if self.shape.abs() < NO_SHAPE {
            return (-y / self.scale).exp();
        }
        (1.0 + self.shape * y / self.scale).max(0.0).powf(-1.0 / self.shape)
    }

    /// The excess that is exceeded with this probability.
    pub fn exceeded(&self, probability: f64) -> f64 {
        if self.shape.abs() < NO_SHAPE {
            return -self.scale * probability.ln();
        }
        self.scale * (probability.powf(-self.shape) - 1.0) / self.shape
    }

    /// Anderson and Darling's A² of these excesses, in ascending order.
    pub(crate) fn anderson_darling(&self, sorted: &[f64]) -> f64 {
        let count = sorted.len() as f64;
        // A value at the end of the support has probability 0; the clamp keeps its logarithm finite.
        let tail = |y: f64| self.survival(y).clamp(1e-300, 1.0 - 1e-16);
        let pairs = sorted.iter().zip(sorted.iter().rev()).enumerate();
        let sum = pairs.map(|(i, (up, down))| (2.0 * i as f64 + 1.0) * ((-tail(*up)).ln_1p() + tail(*down).ln()));
        -count - sum.sum::<f64>() / count
    }

    /// The p-value of these excesses, in ascending order and censored at a bound: the probability of their A² or a larger
    /// one under this distribution, from at most `draws` samples that are drawn, censored and fitted anew (Stute,
    /// Gonzáles-Manteiga and Presedo-Quindimil 1993). It ends after [`ENOUGH`] larger ones (Besag and Clifford 1991).
    pub(crate) fn fits(&self, sorted: &[f64], bound: f64, draws: usize, random: &mut fastrand::Rng) -> f64 {
        let found = self.anderson_darling(sorted);
        let mut sample = vec![0.0; sorted.len()];
        let mut worse = 0;
        for drawn in 1..=draws {
            sample.fill_with(|| self.exceeded(1.0 - random.f64()).min(bound));
            sample.sort_unstable_by(f64::total_cmp);
            let refit = Self::fit(Excesses::of(&sample, bound)).unwrap_or(*self);
            worse += usize::from(refit.anderson_darling(&sample) >= found);
            if worse == ENOUGH {
                return worse as f64 / drawn as f64;
            }
        }
        (worse + 1) as f64 / (draws + 1) as f64
    }
}

/// Excesses in ascending order, of which those at a bound are censored.
#[derive(Clone, Copy, Debug)]
pub struct Excesses<'a> {
    /// Those below the bound.
    pub within: &'a [f64],
    /// The number of the others.
    pub censored: f64,
    /// The bound.
    pub bound: f64,
    /// The largest excess.
    pub most: f64,
}

impl<'a> Excesses<'a> {
    /// Splits excesses in ascending order at a bound.
    pub fn of(sorted: &'a [f64], bound: f64) -> Self {
        let (within, others) = sorted.split_at(sorted.partition_point(|excess| *excess < bound));
        let most = if others.is_empty() { within.last().copied().unwrap_or_default() } else { bound };
        Self { within, censored: others.len() as f64, bound, most }
    }

    /// Σ ln(1 + θ y) over the excesses below the bound, and that of the censored ones.
    pub(crate) fn logarithms(&self, theta: f64) -> [f64; 2] {
        let censored = if self.censored > 0.0 { self.censored * (theta * self.bound).ln_1p() } else { 0.0 };
        [self.within.iter().map(|y| (theta * y).ln_1p()).sum(), censored]
    }

    /// Σ ln(1 + θ y) / θ over all; at θ = 0 their sum. For an exponential distribution: the scale times m.
    pub fn slope(&self, theta: f64) -> f64 {
        if theta == 0.0 {
            let censored = if self.censored > 0.0 { self.censored * self.bound } else { 0.0 };
            return self.within.iter().sum::<f64>() + censored;
        }
        self.logarithms(theta).iter().sum::<f64>() / theta
    }
}

/// ξ(θ), the maximum-likelihood shape for a given θ, and the mean of ln(1 + θ y) over the excesses below the bound.
fn shape_of(excesses: Excesses, theta: f64) -> (f64, f64) {
    let count = excesses.within.len() as f64;
    let [within, censored] = excesses.logarithms(theta);
    ((within + censored) / count, within / count)
}

/// The log-likelihood at θ and ξ(θ), divided by the number of excesses below the bound; −∞ if ξ < −1.
fn profile(excesses: Excesses, theta: f64, mean: f64) -> f64 {
    let (shape, logarithm) = shape_of(excesses, theta);
    if shape.abs() < NO_SHAPE {
        return -mean.ln() - 1.0;
    }
    if shape < -1.0 { f64::NEG_INFINITY } else { -(shape / theta).ln() - logarithm - 1.0 }
}

#[cfg(test)]
mod tests {
    use crate::statistics::gpd::*;

    fn sample(true_one: Gpd, count: usize, random: &mut fastrand::Rng) -> Vec<f64> {
        let mut sample = (0..count).map(|_| true_one.exceeded(1.0 - random.f64())).collect::<Vec<_>>();
        sample.sort_unstable_by(f64::total_cmp);
        sample
    }

    fn fit(sorted: &[f64]) -> Option<Gpd> {
        Gpd::fit(Excesses::of(sorted, f64::INFINITY))
    }

    #[test]
    fn censored_excesses_do_not_bend_the_fit() {
        let mut random = fastrand::Rng::with_seed(4);
        for shape in [-0.2, 0.0, 0.3] {
            let whole = sample(Gpd { shape, scale: 2.0 }, 20_000, &mut random);
            // One in ten or more is beyond this bound.
            let cut = whole.iter().map(|excess| excess.min(3.0)).collect::<Vec<_>>();
            let found = Gpd::fit(Excesses::of(&cut, 3.0)).unwrap();
            assert!((found.shape - shape).abs() < 0.06 && (found.scale - 2.0).abs() < 0.1, "{found:?}, not {shape}");
            // Taken for what they are not, they end the distribution near the bound.
            assert!(fit(&cut).unwrap().shape < shape - 0.2);
        }
    }

    #[test]
    fn the_fit_of_a_large_sample_recovers_its_distribution() {
        let mut random = fastrand::Rng::with_seed(1);
        for shape in [-0.4, -0.2, 0.0, 0.2, 0.5] {
            let found = fit(&sample(Gpd { shape, scale: 2.0 }, 20_000, &mut random)).unwrap();
            assert!((found.shape - shape).abs() < 0.03 && (found.scale - 2.0).abs() < 0.06, "{found:?}, not {shape}");
        }
    }

    #[test]
    fn no_distribution_nearby_is_likelier() {
        let excesses = sample(Gpd { shape: -0.3, scale: 1.0 }, 60, &mut fastrand::Rng::with_seed(2));
        let likelihood = |gpd: Gpd| {
            excesses
                .iter()
                .map(|y| -gpd.scale.ln() - (1.0 / gpd.shape + 1.0) * (gpd.shape * y / gpd.scale).ln_1p())
                .sum::<f64>()
        };
        let found = fit(&excesses).unwrap();
        for (shape, scale) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3), (1e-3, -1e-3), (-1e-3, 1e-3)] {
            let near = Gpd { shape: found.shape + shape, scale: found.scale + scale };
            // Outside the support the likelihood is NaN.
            let near_likelihood = likelihood(near);
            assert!(near_likelihood.is_nan() || near_likelihood <= likelihood(found), "{near:?}, not {found:?}");
        }
    }

    #[test]
    fn a_sample_of_another_distribution_does_not_fit() {
        let mut random = fastrand::Rng::with_seed(3);
        // Two lumps.
        let mut other = (0..300)
            .map(|i| if i % 2 == 0 { 1.0 + random.f64() * 0.1 } else { random.f64() * 0.1 })
            .collect::<Vec<_>>();
        other.sort_unstable_by(f64::total_cmp);
        assert!(fit(&other).unwrap().fits(&other, f64::INFINITY, 99, &mut random) < 0.02);
    }

    #[test]
    fn the_p_value_of_an_own_sample_is_uniform() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut p_values = (0..60)
            .map(|_| {
                let own = sample(Gpd { shape: -0.2, scale: 1.0 }, 100, &mut random);
                fit(&own).unwrap().fits(&own, f64::INFINITY, 99, &mut random)
            })
            .collect::<Vec<_>>();
        p_values.sort_unstable_by(f64::total_cmp);
        let furthest =
            p_values.iter().enumerate().map(|(i, p)| (p - (i as f64 + 0.5) / 60.0).abs()).fold(0.0, f64::max);
        // Kolmogorov's bound for 60 at 1 %.
        assert!(furthest < 0.21, "{furthest}: {p_values:?}");
    }

    #[test]
    fn excesses_that_are_all_0_have_no_fit() {
        assert_eq!(fit(&[0.0, 0.0]), None);
        assert_eq!(fit(&[]), None);
    }
}
