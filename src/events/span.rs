//! A run of steps of one pair: its extremes and, on request, each of its steps.

use super::event::Conflict;
use super::extremes::{Extremes, Observation};
use crate::detection::measures::pet::Pet;
use crate::geometry::Point;
use crate::traffic::roster::Roster;

/// A run of steps.
#[derive(Debug)]
pub(super) struct Span {
    pub extremes: Extremes,
    /// Each step as a conflict of its own, without paths; none unless they are kept.
    steps: Option<Vec<Conflict>>,
}

impl Span {
    /// That of a first step; `path` has the path of a row's front bumper.
    pub fn of(seen: &Observation, path: &impl Fn(u32) -> Vec<Point>, keeps_steps: bool) -> Self {
        Self { extremes: Extremes::of(seen, path), steps: keeps_steps.then(|| vec![step(seen)]) }
    }

    /// Adds a later step.
    pub fn take(&mut self, seen: &Observation, path: &impl Fn(u32) -> Vec<Point>) {
        self.extremes.take(seen, path);
        if let Some(steps) = &mut self.steps {
            steps.push(step(seen));
        }
    }

    /// Marks whether SUMO reports a collision of the two in this step.
    pub fn mark(&mut self, is_reported: bool) {
        let known = &mut self.extremes.collision_sumo;
        *known = Some(is_reported || *known == Some(true));
    }

    /// The conflict so far, with the PET of its event.
    pub fn conflict(&self, pet: Option<Pet>, roster: &Roster) -> Conflict {
        Conflict { steps: self.steps.clone().unwrap_or_default(), ..Conflict::of(&self.extremes, pet, roster) }
    }
}

fn step(seen: &Observation) -> Conflict {
    Conflict::of(&Extremes::of(seen, &|_| Vec::new()), None, seen.roster)
}
