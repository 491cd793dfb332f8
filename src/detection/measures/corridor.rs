//! The area that a road user covered while it drove, in the order of time, and where another's touches it.

use smallvec::SmallVec;

use super::driven_path::Course;
use crate::detection::path::Pose;
use crate::geometry::Bounds;
use crate::geometry::bisection::{Bisection, Part};
use crate::geometry::movement::TOLERANCE;
use crate::geometry::separating_axes::Contact;
use crate::util::units::{Metre, Second};

/// The area that each of its carriages covered, as far as another may have been there.
pub(super) struct Corridor {
    pub carriages: SmallVec<[Vec<Step>; 1]>,
}

/// The area covered between two times.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub from: Second,
    pub to: Second,
    /// Where it was at these times.
    poses: [Pose; 2],
    length: Metre,
    width: Metre,
    part: Part,
}

impl Corridor {
    pub fn of(courses: &[Course], near: &Bounds, halves: &mut Bisection) -> Self {
        Self { carriages: courses.iter().map(|course| steps(course, near, halves)).collect() }
    }

    /// The fraction of a step of another at which that first or last touches what this one has covered by the end of the
    /// step; none where it does not.
    pub(crate) fn touched_by(&self, step: &Step, which: Contact, halves: &mut Bisection) -> Option<f64> {
        let before = self.carriages.iter().flat_map(|steps| steps.iter().take_while(|own| own.from < step.to));
        let found = before.fold(which.none(), |known, own| halves.touch(step.part, own.part, which, known));
        (found != which.none()).then_some(found.min(1.0))
    }

    /// When it touches this area of another, entered at a time, for the last time; not again later.
    pub fn leaves(&self, area: &[Step], entered: Second, halves: &mut Bisection) -> Second {
        let exits = self.carriages.iter().filter_map(|steps| {
            steps.iter().rev().skip_while(|own| own.from > entered).find_map(|own| {
                let touch = |known, step: &Step| halves.touch(own.part, step.part, Contact::Exit, known);
                let found = area.iter().fold(Contact::Exit.none(), touch);
                (found != Contact::Exit.none()).then(|| own.time(found.min(1.0)))
            })
        });
        exits.fold(Second::NEG_INFINITY, Second::max)
    }
}

impl Step {
    pub fn time(&self, part: f64) -> Second {
        self.from + (self.to - self.from) * part
    }

    /// The fraction of it that has passed at a time.
    pub(crate) fn part_at(&self, time: Second) -> f64 {
        ((time - self.from) / (self.to - self.from)).clamp(0.0, 1.0)
    }

    pub fn pose(&self, part: f64) -> Pose {
        let [from, to] = &self.poses;
        let axis = from.axis * (1.0 - part) + to.axis * part;
        let front = from.front + (to.front - from.front) * part;
        Pose { distance: 0.0, front, axis: axis.try_normalize(0.0).unwrap_or(from.axis) }
    }

    /// How far its front goes.
    pub fn travelled(&self) -> Metre {
        (self.poses[1].front - self.poses[0].front).norm()
    }

    /// The part of it between two times.
    pub fn between(&self, begin: Second, end: Second, halves: &mut Bisection) -> Self {
        if begin <= self.from && self.to <= end {
            return *self;
        }
        let poses = [begin, end].map(|time| self.pose(self.part_at(time)));
        let part = halves.add(poses[0].movement_to(&poses[1], self.length, self.width));
        Self { from: begin.max(self.from), to: end.min(self.to), poses, part, ..*self }
    }
}

/// The steps that may touch what lies within these bounds.
fn steps(course: &Course, near: &Bounds, halves: &mut Bisection) -> Vec<Step> {
    let &Course { length, width, .. } = course;
    let steps = course.poses.windows(2).filter_map(|pair| {
        let poses = [&pair[0], &pair[1]].map(|pose| course.pose(pose));
        let mut bounds = course.bounds_at(&poses[0]);
        bounds.join(&course.bounds_at(&poses[1]));
        if !bounds.grown(TOLERANCE).meet(near) {
            return None;
        }
        let part = halves.add(poses[0].movement_to(&poses[1], length, width));
        Some(Step { from: pair[0].time, to: pair[1].time, poses, length, width, part })
    });
    steps.collect()
}
