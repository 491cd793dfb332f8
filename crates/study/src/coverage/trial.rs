//! One method on one known process, and its result on a sample.

use crate::reference::chance::Chance;

/// The level of tests.
pub(super) const LEVEL: f64 = 0.05;

/// What one sample told.
pub(super) enum Told {
    /// An interval, an estimate, and the truth.
    Interval { low: f64, high: f64, estimate: f64, truth: f64 },
    /// Whether a test rejected, where it had reason to, and the power that it says it has.
    Rejected(bool, Option<f64>),
    /// The method refused.
    Refused,
}

/// One method on one process.
pub(super) struct Case {
    pub method: &'static str,
    pub process: String,
    pub samples: usize,
    pub draw: Box<dyn Fn(&mut Chance) -> Told + Sync>,
}

/// A case of this method.
pub(super) fn case(
    method: &'static str,
    process: String,
    samples: usize,
    draw: impl Fn(&mut Chance) -> Told + Sync + 'static,
) -> Case {
    Case { method, process, samples, draw: Box::new(draw) }
}
