//! What the narrow phase reads of the current step.

use typed_index_collections::TiSlice;

use super::cover::Cover;
use super::last_speed::LastSpeed;
use super::paths::Paths;
use super::reach::{Reach, User};
use super::shortcuts::Shortcuts;
use crate::detection::path::turning::Turning;
use crate::options::Options;
use crate::options::condition::LookAhead;
use crate::traffic::frame::{Frame, State};
use crate::traffic::net::{Net, Overlaps};
use crate::traffic::profile::{Carriage, Category, Profile};
use crate::traffic::roster::{Roster, UserIndex};
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
    pub turnings: &'a TiSlice<UserIndex, Turning>,
    pub speeds: &'a TiSlice<UserIndex, LastSpeed>,
    pub reach: Reach<'a>,
    pub users: &'a [User],
    /// How far ahead pairs are predicted.
    pub cover: Cover,
    /// How far the log's condition looks beyond where both stand; none where it does not.
    pub look: Option<LookAhead>,
    /// The road users with reach extended by the look-ahead; empty without one.
    pub users_further: &'a [User],
}

impl StepInputs<'_> {
    /// The same, with pairs met as far ahead as the log's condition looks; none where that is not further.
    pub fn further(&self) -> Option<Self> {
        let cover = Cover::Further(self.look?);
        Some(Self { cover, reach: self.reach.with(cover), users: self.users_further, ..*self })
    }

    /// Whether pairs are predicted beyond where both stand.
    pub(crate) fn is_further(&self) -> bool {
        self.cover != Cover::UntilTheyStand
    }

    /// The inputs with which a pair was met.
    pub(crate) fn as_met(self, further: bool) -> Self {
        if further { self.further().unwrap_or(self) } else { self }
    }

    /// Whether the broad phase has compared the areas of pairs.
    pub(crate) fn areas_are_compared(&self) -> bool {
        self.shortcuts.areas_apart && (self.look.is_none() || self.is_further())
    }

    pub fn user(&self, slot: u32) -> &User {
        &self.users[slot as usize]
    }

    pub fn state(&self, user: &User) -> &State {
        self.frame.state(user.row)
    }

    /// The distance until a road user stands, or its reach.
    #[inline(always)]
    pub fn stop(&self, user: &User) -> Metre {
        self.cover.stop(self.state(user), self.profile(user))
    }

    /// The same and ε further; 0 if it stands.
    #[inline(always)]
    pub(crate) fn reach_of(&self, user: &User) -> Metre {
        self.cover.reach(self.state(user), self.profile(user), self.options.epsilon)
    }

    /// Its length as SUMO draws it.
    pub(crate) fn drawn_length(&self, user: &User) -> Metre {
        self.paths.drawn_length(user.index, self.profile(user).length)
    }

    /// The carriages that a road user is seen as: one, unless it bends.
    pub fn carriages(&self, user: &User) -> impl Iterator<Item = Carriage> + use<> {
        self.profile(user).carriages().take(self.count_carriages(user) as usize)
    }

    /// The number of carriages that a road user is seen as.
    pub(crate) fn count_carriages(&self, user: &User) -> u32 {
        if user.bends { self.profile(user).carriages } else { 1 }
    }

    /// The length of a carriage as SUMO draws it; that of the whole road user, unless it bends.
    pub(crate) fn drawn_length_of(&self, user: &User, carriage: Carriage) -> Metre {
        if user.bends { carriage.length * self.paths.scale(user.index) } else { self.drawn_length(user) }
    }

    pub(crate) fn is_obstacle(&self, slot: u32) -> bool {
        self.user(slot).category == Category::Obstacle
    }

    /// Its deceleration since the last step, 0 or more.
    pub fn deceleration(&self, user: &User) -> MetrePerSecondSquared {
        self.speeds[user.index].deceleration()
    }

    pub fn profile(&self, user: &User) -> &Profile {
        self.roster.profile_at(user.profile)
    }
}
