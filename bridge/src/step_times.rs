//! Where the time of a run goes.

use std::time::{Duration, Instant};

use closecall_run::run::step::StepPart;

/// The parts of a step, in order. Those from the broad phase on may run beside SUMO's next step.
#[derive(Clone, Copy)]
pub enum TimedPart {
    Sumo,
    Pull,
    Paths,
    Painting,
    Check(StepPart),
}

const NAMES: [&str; 8] = ["SUMO", "pull", "paths", "painting", "broad phase", "narrow phase", "events", "log"];

impl TimedPart {
    fn index(self) -> usize {
        match self {
            Self::Sumo => 0,
            Self::Pull => 1,
            Self::Paths => 2,
            Self::Painting => 3,
            Self::Check(StepPart::BroadPhase) => 4,
            Self::Check(StepPart::NarrowPhase) => 5,
            Self::Check(StepPart::Events) => 6,
            Self::Check(StepPart::Log) => 7,
        }
    }
}

/// The time that each part took.
#[derive(Clone, Copy, Default)]
pub struct StepTimes([Duration; NAMES.len()]);

impl StepTimes {
    /// Adds the time since `since` to a part, and sets `since` to now.
    pub fn add(&mut self, part: TimedPart, since: &mut Instant) {
        let now = Instant::now();
        self.0[part.index()] += now - *since;
        *since = now;
    }

    /// Adds the times of another.
    pub fn add_all(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, part)| *sum += part);
    }

    /// The name and the seconds of each part that took any time.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        let parts = NAMES.into_iter().zip(self.0.map(|part| part.as_secs_f64()));
        parts.filter(|(_, seconds)| *seconds > 0.0).collect()
    }
}
