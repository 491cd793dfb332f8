//! Where the road users of a recording will be: a second reader is ahead of the replay by [`LOOK_AHEAD`].

use std::collections::VecDeque;
use std::path::Path;
use std::vec::Drain;

use super::lanes::heading;
use super::recorded_step::RecordedStep;
use super::recording::Recording;
use crate::Result;
use crate::net::projection::Projection;
use closecall::detection::path::driven::{DrivenCourse, DrivenPlace};
use closecall::geometry::Point;
use closecall::geometry::rectangle::direction;
use closecall::util::units::Second;

/// How far ahead the second reader is, in s.
const LOOK_AHEAD: Second = 30.0;

/// The places that the road users of a recording will drive to.
pub(super) struct Future {
    recording: Recording,
    /// The next step, unless the recording has ended.
    step: RecordedStep,
    has_step: bool,
    /// By the recording's number, which may be given to one road user after the other: those that have not left the replay, in
    /// the order in which they entered.
    users: Vec<VecDeque<FutureUser>>,
}

/// A road user that is in the scene, or will be.
#[derive(Default)]
struct FutureUser {
    course: DrivenCourse,
    /// Places that the replay has not taken.
    places: Vec<DrivenPlace>,
    /// Whether it has left the scene where the second reader is.
    has_left: bool,
}

impl Future {
    pub fn open(path: &Path) -> Result<Self> {
        let mut recording = Recording::open(path)?;
        let mut step = RecordedStep::default();
        let has_step = recording.next_step(&mut step)?;
        Ok(Self { recording, step, has_step, users: Vec::new() })
    }

    /// Reads on, so that everything is known that happens until [`LOOK_AHEAD`] after this time.
    /// What is wrong with the rest of the recording the replay will find when it comes there.
    pub(crate) fn look_from(&mut self, time: Second, projection: Option<&Projection>) {
        while self.has_step && self.step.time <= time + LOOK_AHEAD {
            if projection.is_some_and(|projection| self.step.project(projection).is_err()) {
                self.has_step = false;
                return;
            }
            self.take_step();
            self.has_step = self.recording.next_step(&mut self.step).unwrap_or(false);
        }
    }

    fn take_step(&mut self) {
        for gone in self.step.gone() {
            if let Some(user) = self.users.get_mut(*gone as usize).and_then(VecDeque::back_mut) {
                user.has_left = true;
            }
        }
        for row in self.step.rows() {
            let number = row.user as usize;
            if self.users.len() <= number {
                self.users.resize_with(number + 1, VecDeque::new);
            }
            let users = &mut self.users[number];
            if users.back().is_none_or(|last| last.has_left) {
                users.push_back(FutureUser::default());
            }
            if let Some(FutureUser { course, places, .. }) = users.back_mut() {
                course.take(self.step.time, Point::new(row.x, row.y), direction(heading(row)), places);
            }
        }
    }

    /// The places of a road user in the scene that were not taken before.
    pub fn take(&mut self, user: u32) -> Option<Drain<'_, DrivenPlace>> {
        let user = self.users.get_mut(user as usize)?.front_mut()?;
        Some(user.places.drain(..))
    }

    /// A road user leaves the scene.
    pub fn leave(&mut self, user: u32) {
        if let Some(users) = self.users.get_mut(user as usize) {
            users.pop_front();
        }
    }
}
