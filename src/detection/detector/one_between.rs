//! Rear-end pairs with another vehicle between: a follower runs into the nearest vehicle on its path, not into those beyond.
//!
//! A platoon of n would otherwise make n(n−1)/2 conflicts of n − 1 pairs. Another vehicle is between an ego and its foe if
//! - the ego's path leads to where that vehicle is now before it leads to where the foe is now, and
//! - that vehicle's own path leads to where the foe is now, over a shorter distance than the ego's.
//!
//! Each path comes there at an angle of a rear-end conflict. What is beside the path, crosses it, or leaves it before the foe
//! is therefore not between, and the pair stays: as soon as a vehicle begins to leave the lane, the one behind it may be
//! the first to run into the one ahead. So does a pair that touches already.
//!
//! All three are taken as they are now, because how far each of them drives on says nothing about their order on the path.

use super::occupancy::Carriages;
use super::reach::{Motion, User};
use super::step::StepInputs;
use crate::detection::encounter::Encounter;
use crate::detection::kind::Kind;
use crate::detection::narrow_phase::{Participant, side};
use crate::detection::path::Pose;
use crate::geometry::bisection::Bisection;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Bounds, angle_between};
use crate::traffic::profile::Category;
use crate::util::units::Metre;

/// Memory that is reused in each step.
#[derive(Default)]
pub(super) struct OneBetween {
    /// By row of the frame, the slot.
    pub slots: Vec<u32>,
    /// By slot, whether it is an ego of a rear-end pair.
    is_follower: Vec<bool>,
    /// The slots of such an ego and of a vehicle whose area meets its own, sorted.
    pub near: Vec<(u32, u32)>,
    pub ahead: PathAhead,
}

/// The path that is being followed.
#[derive(Default)]
pub(super) struct PathAhead {
    pub poses: Vec<Pose>,
    /// The first worker's, lent while no worker needs it.
    pub bisection: Bisection,
}

impl OneBetween {
    /// Finds the vehicles near the egos of rear-end pairs, among these pairs of slots; returns whether there are any.
    pub fn find<'a>(
        &mut self,
        rows: usize,
        users: &[User],
        encounters: impl Iterator<Item = &'a Encounter>,
        pairs: impl Iterator<Item = (u32, u32)>,
    ) -> bool {
        self.slots.clear();
        self.slots.resize(rows, u32::MAX);
        for (slot, user) in (0..).zip(users) {
            self.slots[user.row as usize] = slot;
        }
        self.is_follower.clear();
        self.is_follower.resize(users.len(), false);
        for found in encounters.filter(|found| may_have_one_between(found)) {
            self.is_follower[self.slots[found.ego_row as usize] as usize] = true;
        }
        self.near.clear();
        for (a, b) in pairs {
            for (one, other) in [(a, b), (b, a)] {
                if self.is_follower[one as usize] && is_there(&users[other as usize]) {
                    self.near.push((one, other));
                }
            }
        }
        self.near.sort_unstable();
        !self.near.is_empty()
    }
}

/// Whether the pair is one that another vehicle may be between.
pub(super) fn may_have_one_between(found: &Encounter) -> bool {
    found.kind == Kind::RearEnd && !found.collision && found.overlap == 0.0
}

/// Whether it is a vehicle, and where it is at this moment is known.
fn is_there(user: &User) -> bool {
    user.category == Category::Vehicle && user.motion != Motion::Appears
}

impl StepInputs<'_> {
    /// How far the road user in a slot has to go along these poses until it runs into where another one is now; none if it
    /// does not, or not from behind. Two that only graze pass each other.
    pub(super) fn distance_to(
        &self,
        PathAhead { poses, bisection }: &mut PathAhead,
        slot: u32,
        other: u32,
    ) -> Option<Metre> {
        let by = self.options.contact_tolerance / 2.0;
        let mut mover = *self.movers(slot).first()?;
        (mover.poses, mover.straight) = (poses, false);
        let others = self.movers(other).into_iter().map(|other| Participant { stop: 0.0, ..other.shrunk(by) });
        let others = others.collect::<Carriages>();
        let mut near = Bounds::EMPTY;
        for pose in mover.poses {
            near.join(&Rectangle::behind(pose.front, pose.axis, mover.length(), mover.width()).bounds());
        }
        if !others.iter().any(|other| near.meet(&other.rectangle.bounds())) {
            return None;
        }
        let (distance, axis) = side::distance_to(bisection, &mover.shrunk(by), &others)?;
        let angle =
            others.iter().map(|other| angle_between(&axis, &other.rectangle.axis)).fold(f64::INFINITY, f64::min);
        (Kind::at(angle, self.options.kind_bounds()) == Kind::RearEnd).then_some(distance)
    }
}
