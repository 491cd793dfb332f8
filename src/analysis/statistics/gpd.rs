//! The generalised Pareto distribution of excesses over a threshold: maximum likelihood and goodness of fit.
//!
//! No crate has the fit. With θ = ξ/σ the likelihood has a maximum over ξ in closed form, ξ(θ) = mean ln(1 + θ y), so
//! that one dimension is left to search (Davison 1984; Grimshaw 1993). For ξ < −1 the likelihood has no maximum; the
//! search ends there, as usual.

/// Shape ξ and scale σ: P(Y > y) = (1 + ξ y / σ)^(−1/ξ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gpd {
    /// ξ; below 0 the excess is at most −σ/ξ.
    pub shape: f64,
    /// σ, above 0.
    pub scale: f64,
}

/// Below this a shape counts as 0: the exponential distribution.
const NO_SHAPE: f64 = 1e-9;
/// Points of the search's first, coarse pass on each side of θ = 0.
const COARSE: i32 = 16;
/// Steps of the golden section: the bracket's last width is 10⁻⁷ of its first.
const FINE: i32 = 34;

impl Gpd {
    /// The likeliest distribution of these excesses, all ≥ 0; none where they are all 0.
    pub fn fit(excesses: &[f64]) -> Option<Self> {
        let most = excesses.iter().copied().fold(0.0, f64::max);
        let mean = excesses.iter().sum::<f64>() / excesses.len() as f64;
        if !(most > 0.0 && most.is_finite()) {
            return None;
        }
        // θ at a place of the search: from −1/most, where the support would end, to far above 0.
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
        let (mut low, mut high) = (best - 1.0, best + 1.0);
        let golden = (5_f64.sqrt() - 1.0) / 2.0;
        let (mut left, mut right) = (high - golden * (high - low), low + golden * (high - low));
        let (mut at_left, mut at_right) = (likelihood(left), likelihood(right));
        for _ in 0..FINE {
            if at_left > at_right {
                (high, right, at_right) = (right, left, at_left);
                left = high - golden * (high - low);
                at_left = likelihood(left);
            } else {
                (low, left, at_left) = (left, right, at_right);
                right = low + golden * (high - low);
                at_right = likelihood(right);
            }
        }
        let theta = theta((low + high) / 2.0);
        let shape = shape_of(excesses, theta);
        if shape.abs() < NO_SHAPE {
            return Some(Self { shape: 0.0, scale: mean });
        }
        // On the bound ξ = −1 the likeliest scale is the largest excess: the uniform distribution.
        let bounded = profile(excesses, theta, mean) < -most.ln() || shape < -1.0;
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
    pub fn anderson_darling(&self, sorted: &[f64]) -> f64 {
        let count = sorted.len() as f64;
        // A value on the end of the support has probability 0; its logarithm must stay finite.
        let tail = |y: f64| self.survival(y).clamp(1e-300, 1.0 - 1e-16);
        let pairs = sorted.iter().zip(sorted.iter().rev()).enumerate();
        let sum = pairs.map(|(i, (up, down))| (2.0 * i as f64 + 1.0) * ((-tail(*up)).ln_1p() + tail(*down).ln()));
        -count - sum.sum::<f64>() / count
    }

    /// The probability of an A² at least as large as that of these excesses, in ascending order, if they are of this
    /// distribution: by drawing samples from it and fitting each (Stute, Gonzáles-Manteiga and Presedo-Quindimil
    /// 1993).
    pub fn fits(&self, sorted: &[f64], draws: usize, random: &mut fastrand::Rng) -> f64 {
        let found = self.anderson_darling(sorted);
        let mut sample = vec![0.0; sorted.len()];
        let mut worse = 0;
        for _ in 0..draws {
            sample.fill_with(|| self.exceeded(1.0 - random.f64()));
            sample.sort_unstable_by(f64::total_cmp);
            let refit = Self::fit(&sample).unwrap_or(*self);
            worse += usize::from(refit.anderson_darling(&sample) >= found);
        }
        (worse + 1) as f64 / (draws + 1) as f64
    }
}

/// ξ(θ), its maximum-likelihood value.
fn shape_of(excesses: &[f64], theta: f64) -> f64 {
    excesses.iter().map(|y| (theta * y).ln_1p()).sum::<f64>() / excesses.len() as f64
}

/// The log-likelihood at θ and ξ(θ), divided by the number of excesses; −∞ where ξ < −1.
fn profile(excesses: &[f64], theta: f64, mean: f64) -> f64 {
    let shape = shape_of(excesses, theta);
    if shape.abs() < NO_SHAPE {
        return -mean.ln() - 1.0;
    }
    if shape < -1.0 { f64::NEG_INFINITY } else { -(shape / theta).ln() - shape - 1.0 }
}

#[cfg(test)]
mod tests {
    use crate::analysis::statistics::gpd::*;

    fn sample(true_one: Gpd, count: usize, random: &mut fastrand::Rng) -> Vec<f64> {
        let mut sample = (0..count).map(|_| true_one.exceeded(1.0 - random.f64())).collect::<Vec<_>>();
        sample.sort_unstable_by(f64::total_cmp);
        sample
    }

    #[test]
    fn a_large_sample_gives_back_its_distribution() {
        let mut random = fastrand::Rng::with_seed(1);
        for shape in [-0.4, -0.2, 0.0, 0.2, 0.5] {
            let found = Gpd::fit(&sample(Gpd { shape, scale: 2.0 }, 20_000, &mut random)).unwrap();
            assert!((found.shape - shape).abs() < 0.03 && (found.scale - 2.0).abs() < 0.06, "{found:?}, not {shape}");
        }
    }

    #[test]
    fn nothing_near_is_likelier() {
        let excesses = sample(Gpd { shape: -0.3, scale: 1.0 }, 60, &mut fastrand::Rng::with_seed(2));
        let likelihood = |gpd: Gpd| {
            excesses
                .iter()
                .map(|y| -gpd.scale.ln() - (1.0 / gpd.shape + 1.0) * (gpd.shape * y / gpd.scale).ln_1p())
                .sum::<f64>()
        };
        let found = Gpd::fit(&excesses).unwrap();
        for (shape, scale) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3), (1e-3, -1e-3), (-1e-3, 1e-3)] {
            let near = Gpd { shape: found.shape + shape, scale: found.scale + scale };
            // NaN: outside the support.
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
        assert!(Gpd::fit(&other).unwrap().fits(&other, 99, &mut random) < 0.02);
    }

    #[test]
    fn the_p_value_of_an_own_sample_is_uniform() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut p_values = (0..60)
            .map(|_| {
                let own = sample(Gpd { shape: -0.2, scale: 1.0 }, 100, &mut random);
                Gpd::fit(&own).unwrap().fits(&own, 99, &mut random)
            })
            .collect::<Vec<_>>();
        p_values.sort_unstable_by(f64::total_cmp);
        let furthest =
            p_values.iter().enumerate().map(|(i, p)| (p - (i as f64 + 0.5) / 60.0).abs()).fold(0.0, f64::max);
        // Kolmogorov's bound for 60 at 1 %.
        assert!(furthest < 0.21, "{furthest}: {p_values:?}");
    }

    #[test]
    fn equal_excesses_of_0_are_no_sample() {
        assert_eq!(Gpd::fit(&[0.0, 0.0]), None);
        assert_eq!(Gpd::fit(&[]), None);
    }
}
