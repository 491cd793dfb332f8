//! One thread's memory for its part of a step, and what it finds.

use super::chances::Chances;
use super::occupancy::{MOST_POSES, OccupancyCache};
use super::work_counts::Work;
use crate::detection::encounter::Encounter;
use crate::detection::measures::MOST_TIMES;
use crate::detection::narrow_phase::ConflictPoint;
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, Second};

/// One thread's state, and what it finds among its pairs.
#[derive(Default)]
pub(super) struct Worker {
    pub work: Work,
    pub occupancy: OccupancyCache,
    /// The paths of pairs that are predicted beyond where both stand.
    pub further: OccupancyCache,
    pub found: Findings,
    /// Road users that are absent from the step.
    pub absent: Vec<UserIndex>,
}

/// The pairs that would meet.
#[derive(Default)]
pub(super) struct Findings {
    pub encounters: Vec<Encounter>,
    /// Whether the pair under test would meet.
    pub meets: bool,
    /// Which of them are not measured yet.
    pub unmeasured: Vec<(u32, Met)>,
    /// What the crash probabilities of those that are measured follow from.
    pub chances: Chances,
    pub scratch: Scratch,
}

/// Allocations reused for each pair.
pub(super) struct Scratch {
    /// Poses further ahead than the paths of the step: the ego's and the foe's.
    pub courses: [Vec<Pose>; 2],
    /// The same of both if they are smaller.
    pub smaller_courses: [Vec<Pose>; 2],
    pub halves: Bisection,
    /// How far an ego may be at which times.
    pub limits: Vec<(Second, Metre)>,
}

impl Default for Scratch {
    fn default() -> Self {
        let courses = || [(); 2].map(|()| Vec::with_capacity(MOST_POSES));
        Self {
            courses: courses(),
            smaller_courses: courses(),
            halves: Bisection::to_keep(),
            limits: Vec::with_capacity(MOST_TIMES),
        }
    }
}

/// The input for measuring a pair that would meet.
#[derive(Clone, Copy)]
pub(super) struct Met {
    /// The ego's slot and the foe's.
    pub slots: [u32; 2],
    pub meeting: ConflictPoint,
    /// cos α.
    pub sigma: f64,
    /// Whether the gap depends on when the foe has left the conflict point.
    pub leaves: bool,
    /// How much smaller both are taken to be on every side, in m, because they graze.
    pub shrinks: Metre,
    /// Whether they meet further ahead than where both stand.
    pub further: bool,
}

impl Findings {
    pub fn clear(&mut self) {
        self.encounters.clear();
        self.unmeasured.clear();
        self.chances.clear();
    }
}
