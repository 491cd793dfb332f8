//! What one thread needs for its part of a step, and what it finds.

use super::occupancy::{MOST_POSES, OccupancyCache};
use super::work::Work;
use crate::detection::encounter::Encounter;
use crate::detection::narrow_phase::ConflictPoint;
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;

/// One thread, and what it finds among the pairs that it looks at.
#[derive(Default)]
pub(super) struct Worker {
    pub work: Work,
    pub ways: OccupancyCache,
    pub found: Found,
}

/// The pairs that would meet.
#[derive(Default)]
pub(super) struct Found {
    pub encounters: Vec<Encounter>,
    /// Which of them are not measured yet.
    pub unmeasured: Vec<(u32, Met)>,
    pub scratch: Scratch,
}

/// Memory for what is forgotten with the pair.
pub(super) struct Scratch {
    /// Poses further ahead than the ways of the step: the ego's and the foe's.
    pub courses: [Vec<Pose>; 2],
    pub halves: Bisection,
}

impl Default for Scratch {
    fn default() -> Self {
        Self { courses: [(); 2].map(|()| Vec::with_capacity(MOST_POSES)), halves: Bisection::to_keep() }
    }
}

/// What measuring a pair that would meet starts from.
#[derive(Clone, Copy)]
pub(super) struct Met {
    /// The ego's slot and the foe's.
    pub slots: [u32; 2],
    pub meeting: ConflictPoint,
    /// cos α.
    pub sigma: f64,
    /// Whether the gap waits for when the foe has left the meeting place.
    pub leaves: bool,
}

impl Found {
    pub fn clear(&mut self) {
        self.encounters.clear();
        self.unmeasured.clear();
    }
}
