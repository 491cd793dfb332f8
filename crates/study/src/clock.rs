//! Run times of several methods, measured in turns, so that a slow phase of the machine affects all of them.

use std::time::Instant;

/// A method to be timed; its action processes all items once.
pub(super) struct Timed<'a> {
    pub items: usize,
    pub action: Box<dyn FnMut() + 'a>,
}

impl<'a> Timed<'a> {
    pub fn new(items: usize, action: impl FnMut() + 'a) -> Self {
        Self { items, action: Box::new(action) }
    }
}

/// The median time per item of each method in ns, over `rounds` in which each method runs once.
pub(super) fn interleaved(methods: &mut [Timed], rounds: usize) -> Vec<f64> {
    let mut times = vec![Vec::with_capacity(rounds); methods.len()];
    for _ in 0..rounds {
        for (method, times) in methods.iter_mut().zip(&mut times) {
            let started = Instant::now();
            (method.action)();
            times.push(started.elapsed().as_secs_f64() * 1e9 / method.items.max(1) as f64);
        }
    }
    times.iter_mut().map(|times| median(times)).collect()
}

/// The middle value, the upper one of two; NaN if there is none.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
