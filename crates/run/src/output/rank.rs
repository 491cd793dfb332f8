//! Which of two conflicts is worse: one order for the end of a run, the statistics, the report and the pictures.

use std::cmp::Ordering;

use super::schema::LoggedConflict;
use closecall::detection::kind::Severity;
use closecall::events::Conflict;
use closecall::util::units::{Metre, MetrePerSecond, Second};

/// How bad a conflict is; the larger, the worse. Artefacts come last, collisions first, by ΔV. Between others the severity
/// decides, then the crash probability, then the TTC, then the margin.
#[derive(Clone, Copy, Debug)]
pub struct Rank {
    is_traffic: bool,
    collision: bool,
    severity: Severity,
    /// The larger of both in a collision, otherwise 0.
    delta_v: MetrePerSecond,
    /// 0 where it is not known.
    crash_probability: f64,
    /// Infinite where there is none.
    ttc: Second,
    margin: Metre,
}

impl Rank {
    fn new(
        (is_traffic, collision, severity): (bool, bool, Severity),
        delta_v: MetrePerSecond,
        crash_probability: f64,
        ttc: Option<Second>,
        margin: Metre,
    ) -> Self {
        let delta_v = if collision { delta_v } else { 0.0 };
        Self {
            is_traffic,
            collision,
            severity,
            delta_v,
            crash_probability,
            ttc: ttc.unwrap_or(Second::INFINITY),
            margin,
        }
    }
}

impl Ord for Rank {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.is_traffic, self.collision, self.severity)
            .cmp(&(other.is_traffic, other.collision, other.severity))
            .then_with(|| self.delta_v.total_cmp(&other.delta_v))
            .then_with(|| self.crash_probability.total_cmp(&other.crash_probability))
            .then_with(|| other.ttc.total_cmp(&self.ttc))
            .then_with(|| other.margin.total_cmp(&self.margin))
    }
}

impl PartialOrd for Rank {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Rank {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Rank {}

impl From<&Conflict> for Rank {
    fn from(conflict: &Conflict) -> Self {
        let Conflict { collision, severity, values, margin, ego_delta_v, foe_delta_v, .. } = *conflict;
        let is_traffic = conflict.artefact.is_none();
        Self::new(
            (is_traffic, collision, severity),
            ego_delta_v.max(foe_delta_v),
            values.crash_probability().unwrap_or_default(),
            values.ttc(),
            margin,
        )
    }
}

impl From<&LoggedConflict> for Rank {
    fn from(conflict: &LoggedConflict) -> Self {
        let LoggedConflict { collision, severity, ttc, margin, crash_probability, .. } = *conflict;
        let is_traffic = conflict.artefact.is_empty();
        Self::new(
            (is_traffic, collision, severity),
            conflict.delta_v(),
            crash_probability.unwrap_or_default(),
            ttc,
            margin,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collisions_are_worst_then_severity_then_probability_then_ttc() {
        let [caution, serious, critical] = Severity::ALL.map(|severity| (true, false, severity));
        let collision = (true, true, Severity::Critical);
        let milder_first = [
            Rank::new((false, true, Severity::Critical), 9.0, 1.0, Some(0.0), -9.0),
            Rank::new(caution, 9.0, 0.0, None, -9.0),
            Rank::new(serious, 9.0, 0.2, Some(1.0), -1.0),
            Rank::new(serious, 1.0, 0.2, Some(0.5), -1.0),
            Rank::new(serious, 0.0, 0.2, Some(0.5), -2.0),
            Rank::new(serious, 0.0, 0.3, Some(2.0), 0.0),
            Rank::new(critical, 0.0, 0.1, Some(2.0), 0.0),
            Rank::new(collision, 1.0, 1.0, Some(0.0), -9.0),
            Rank::new(collision, 8.0, 1.0, Some(0.0), 0.0),
        ];
        assert!(milder_first.is_sorted_by(|a, b| a < b));
    }
}
