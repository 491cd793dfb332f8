//! Random numbers that are the same on every machine.

/// A stream of random numbers.
pub struct Chance(fastrand::Rng);

impl Chance {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(fastrand::Rng::with_seed(seed))
    }

    /// A number from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// A number from `low` to `high`, both above 0, each order of magnitude equally likely.
    pub(crate) fn magnitude(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln()).exp()).clamp(low, high)
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.usize(..count.max(1))
    }

    /// A whole number from −`most` to `most`.
    pub fn around(&mut self, most: i32) -> i32 {
        self.0.i32(-most..=most)
    }

    /// One of these; `T::default()` if there are none.
    pub(crate) fn pick<T: Copy + Default>(&mut self, from: &[T]) -> T {
        from.get(self.below(from.len())).copied().unwrap_or_default()
    }

    /// A standard normal number (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.between(f64::MIN_POSITIVE, 1.0).ln()).sqrt();
        radius * self.between(0.0, 2.0 * std::f64::consts::PI).cos()
    }

    /// An angle, −π to π.
    pub fn angle(&mut self) -> f64 {
        self.between(-std::f64::consts::PI, std::f64::consts::PI)
    }
}
