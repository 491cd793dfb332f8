//! Where all road users were in the last seconds, and which pairs were in conflict: what a clip shows from before its conflict.

use std::collections::VecDeque;

use super::clip::BEFORE;
use crate::detection::kind::Severity;
use crate::events::alarm::Alarm;
use crate::events::under_way::Pair;
use crate::traffic::frame::{Frame, State};
use crate::traffic::roster::{ProfileIndex, Roster, UserIndex};
use crate::util::units::{Metre, Second};
use ecow::EcoString;

/// The time between two steps that are kept, in s, less what sums of steps differ from it by rounding: ten pictures a second
/// are smooth, and shorter steps would only cost memory.
const APART: Second = 0.1 - 1e-6;

/// A road user in a step: a [`State`] in 28 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(Rust, packed(4))]
pub(super) struct Place {
    pub x: Metre,
    pub y: Metre,
    pub heading: f32,
    pub speed: f32,
    pub user: UserIndex,
}

/// A pair that is in conflict in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Danger {
    pub pair: Pair,
    pub severity: Severity,
    pub time_left: Option<Second>,
}

/// One step.
#[derive(Debug, Default)]
pub(super) struct RecentStep {
    pub time: Second,
    pub places: Vec<Place>,
    pub dangers: Vec<Danger>,
}

/// A road user that has left; its index may be given to another.
#[derive(Debug)]
struct Left {
    time: Second,
    user: UserIndex,
    id: EcoString,
    profile: ProfileIndex,
}

/// The last steps, the oldest first.
#[derive(Debug, Default)]
pub(super) struct Recent {
    steps: VecDeque<RecentStep>,
    /// In the order in which they left.
    left: VecDeque<Left>,
}

impl Recent {
    /// Adds a step; returns whether it is kept.
    pub fn add(&mut self, frame: &Frame, alarms: impl Iterator<Item = Alarm>) -> bool {
        if self.steps.back().is_some_and(|last| frame.time - last.time < APART) {
            return false;
        }
        let oldest = frame.time - BEFORE - APART;
        self.left.drain(..self.left.partition_point(|left| left.time < oldest));
        // Reuse the memory of a past step.
        let mut over = self.steps.drain(..self.steps.partition_point(|step| step.time < oldest));
        let mut step = over.next().unwrap_or_default();
        drop(over);
        step.time = frame.time;
        step.places.clear();
        step.places.reserve_exact(frame.len());
        step.places.extend(frame.rows().map(|row| {
            let State { x, y, heading, speed, .. } = row.state;
            Place { x, y, heading: heading as f32, speed: speed as f32, user: row.user }
        }));
        step.dangers.clear();
        let now = alarms.filter(|alarm| alarm.time == frame.time);
        step.dangers.extend(now.map(|Alarm { ego, foe, severity, nearness, .. }| Danger {
            pair: [ego.min(foe), ego.max(foe)],
            severity,
            time_left: nearness.and_then(|near| near.values.response_left()),
        }));
        self.steps.push_back(step);
        true
    }

    /// Notes that a road user has left.
    pub fn forget(&mut self, user: UserIndex, time: Second, roster: &Roster) {
        let (id, profile) = (roster.id(user).clone(), roster.type_of(user));
        self.left.push_back(Left { time, user, id, profile });
    }

    /// The steps later than this time.
    pub fn since(&self, time: Second) -> impl Iterator<Item = &RecentStep> {
        let first = self.steps.partition_point(|step| step.time <= time);
        self.steps.range(first..)
    }

    /// The id and the type of the road user that had this index at a time.
    pub fn who<'a>(&'a self, user: UserIndex, time: Second, roster: &'a Roster) -> (&'a EcoString, ProfileIndex) {
        let gone = self.left.iter().find(|left| left.user == user && left.time > time);
        gone.map_or_else(|| (roster.id(user), roster.type_of(user)), |left| (&left.id, left.profile))
    }
}
