//! What the narrow phase reads of the current step.

use super::last_speed::LastSpeed;
use super::reach;
use super::reach::{Paths, Reach, User};
use super::shortcuts::Shortcuts;
use crate::detection::path::turning::Turning;
use crate::options::Options;
use crate::traffic::frame::{Frame, State};
use crate::traffic::net::{Net, Overlaps};
use crate::traffic::profile::{Carriage, Category, Profile};
use crate::traffic::roster::Roster;
use crate::util::units::{Metre, MetrePerSecondSquared};

/// The inputs of the narrow phase in the current step.
#[derive(Clone, Copy)]
pub(super) struct StepInputs<'a> {
    pub options: &'a Options,
    pub shortcuts: Shortcuts,
    pub conflicts_only: bool,
    pub frame: &'a Frame,
    pub roster: &'a Roster,
    /// The net, if it has no heights that tell a bridge from what it crosses.
    pub flat_net: Option<&'a Net>,
    /// The lanes that overlap as drawn.
    pub overlaps: &'a Overlaps,
    pub paths: Paths<'a>,
    pub turnings: &'a [Turning],
    pub speeds: &'a [LastSpeed],
    pub reach: Reach<'a>,
    pub users: &'a [User],
}

impl StepInputs<'_> {
    pub fn user(&self, slot: u32) -> &User {
        &self.users[slot as usize]
    }

    pub fn state(&self, user: &User) -> &State {
        self.frame.state(user.row)
    }

    /// The distance until a road user stands.
    #[inline(always)]
    pub fn stop(&self, user: &User) -> Metre {
        reach::stop(self.state(user), self.profile(user))
    }

    /// The distance until a road user stands, and ε further; 0 if it stands.
    #[inline(always)]
    pub fn reach_of(&self, user: &User) -> Metre {
        reach::reach(self.state(user), self.profile(user), self.options.epsilon)
    }

    /// Its length as SUMO draws it.
    pub fn drawn_length(&self, user: &User) -> Metre {
        self.paths.drawn_length(user.index, self.profile(user).length)
    }

    /// The carriages that a road user is seen as: one, unless it bends.
    pub fn carriages(&self, user: &User) -> impl Iterator<Item = Carriage> + use<> {
        self.profile(user).carriages().take(self.count_carriages(user) as usize)
    }

    /// The number of carriages that a road user is seen as.
    pub fn count_carriages(&self, user: &User) -> u32 {
        if user.bends { self.profile(user).carriages } else { 1 }
    }

    /// The length of a carriage as SUMO draws it; that of the whole road user, unless it bends.
    pub fn drawn_length_of(&self, user: &User, carriage: Carriage) -> Metre {
        if user.bends { carriage.length * self.paths.scale(user.index) } else { self.drawn_length(user) }
    }

    pub fn is_obstacle(&self, slot: u32) -> bool {
        self.user(slot).category == Category::Obstacle
    }

    /// Its deceleration since the last step, 0 or more.
    pub fn deceleration(&self, user: &User) -> MetrePerSecondSquared {
        self.speeds[user.index.0 as usize].deceleration
    }

    pub fn profile(&self, user: &User) -> &Profile {
        self.roster.profile_at(user.profile)
    }
}
