//! A run of steps of one pair: its extremes and, on request, each of its steps.

use super::event::Conflict;
use super::extremes::{Extremes, Observation};
use super::why::Artefact;
use crate::detection::measures::pet::Pet;
use crate::options::thresholds::SeverityThresholds;
use crate::traffic::roster::Roster;
use crate::util::units::Second;

/// A run of steps.
#[derive(Debug)]
pub(super) struct Span {
    pub extremes: Extremes,
    /// Each step as a conflict of its own, without paths; none unless they are kept.
    steps: Option<Vec<Conflict>>,
}

impl Span {
    /// Starts a span.
    pub fn of(seen: &Observation, keeps_steps: bool) -> Self {
        Self { extremes: Extremes::of(seen, true), steps: keeps_steps.then(|| vec![step(seen)]) }
    }

    /// Adds a later step.
    pub fn take(&mut self, seen: &Observation) {
        self.extremes.take(seen);
        if let Some(steps) = &mut self.steps {
            steps.push(step(seen));
        }
    }

    /// Marks whether SUMO reports a collision of the two in this step.
    pub fn mark(&mut self, is_reported: bool) {
        let known = &mut self.extremes.collision_sumo;
        *known = Some(is_reported || *known == Some(true));
    }

    /// Notes that one of [`Extremes::standing`] stood in the last step, at this time, at a scheduled stop.
    pub fn stood(&mut self, time: Second) {
        let Extremes { worst, why, .. } = &mut self.extremes;
        if worst.time == time {
            why.causes = why.causes.with_stops(why.manoeuvre);
        }
        if let Some(step) = self.steps.as_mut().and_then(|steps| steps.last_mut()) {
            step.causes = step.causes.with_stops(step.manoeuvre);
        }
    }

    /// The conflict so far, with the PET of its event.
    pub fn conflict(&self, pet: Option<Pet>, roster: &Roster, rule: SeverityThresholds) -> Conflict {
        let mut conflict = Conflict::of(&self.extremes, pet, roster, rule);
        if self.extremes.is_a_bad_frame() {
            conflict.artefact = Some(Artefact::Tracking);
        }
        Conflict { steps: self.steps.clone().unwrap_or_default(), ..conflict }
    }
}

fn step(seen: &Observation) -> Conflict {
    // What is seen of a passing is known only at its end.
    Conflict::of(&Extremes::of(seen, false), None, seen.roster, SeverityThresholds::Levels)
}
