//! Which of two conflicts is worse: one order for the end of a run, the statistics, the report and the pictures.

use std::cmp::Ordering;

use super::schema::LoggedConflict;
use crate::detection::kind::Severity;
use crate::events::Conflict;
use crate::util::units::{Metre, Second};

/// How bad a conflict is; the larger, the worse. A collision is worst, then the severity decides, then the TTC, then the
/// margin.
#[derive(Clone, Copy, Debug)]
pub struct Badness {
    collision: bool,
    severity: Severity,
    /// Infinite where there is none.
    ttc: Second,
    margin: Metre,
}

impl Ord for Badness {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.collision, self.severity)
            .cmp(&(other.collision, other.severity))
            .then_with(|| other.ttc.total_cmp(&self.ttc))
            .then_with(|| other.margin.total_cmp(&self.margin))
    }
}

impl PartialOrd for Badness {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Badness {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Badness {}

impl From<&Conflict> for Badness {
    fn from(conflict: &Conflict) -> Self {
        let Conflict { collision, severity, ttc, margin, .. } = *conflict;
        Self { collision, severity, ttc: ttc.unwrap_or(Second::INFINITY), margin }
    }
}

impl From<&LoggedConflict> for Badness {
    fn from(conflict: &LoggedConflict) -> Self {
        let LoggedConflict { collision, severity, ttc, margin, .. } = *conflict;
        Self { collision, severity, ttc: ttc.unwrap_or(Second::INFINITY), margin }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collisions_are_worst_then_severity_then_ttc_then_margin() {
        let of = |collision, severity, ttc, margin| Badness { collision, severity, ttc, margin };
        let milder_first = [
            of(false, Severity::Caution, f64::INFINITY, -9.0),
            of(false, Severity::Serious, 1.0, -1.0),
            of(false, Severity::Serious, 0.5, -1.0),
            of(false, Severity::Serious, 0.5, -2.0),
            of(false, Severity::Critical, 2.0, 0.0),
            of(true, Severity::Critical, 0.0, 0.0),
        ];
        assert!(milder_first.is_sorted_by(|a, b| a < b));
    }
}
