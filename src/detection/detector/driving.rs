//! Paths along the recorded future, rebuilt in each step, since a road user's front bumper is on them now.

use super::Detector;
use super::reach::User;
use crate::detection::path::driven::{DrivenNow, DrivenPlace, DrivenPlaces};
use crate::detection::path::lanes::KEPT_BEHIND;
use crate::geometry::rectangle::direction;
use crate::traffic::frame::{Frame, Row};
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::index::row_of;
use crate::util::units::Metre;

impl Detector {
    /// Adds places to which a road user will drive, or where it is now; each later than the one before.
    pub fn drive(&mut self, user: UserIndex, places: impl IntoIterator<Item = DrivenPlace>) {
        row_of(&mut self.driven, user, DrivenPlaces::default).add(places);
    }

    /// Lays the paths of a step as far as both phases look.
    pub(super) fn lay_driven(&mut self, frame: &Frame, roster: &Roster) {
        if self.driven.len() < self.paths.len() {
            self.driven.resize_with(self.paths.len(), DrivenPlaces::default);
        }
        let cover = self.cover();
        for (row, Row { user, state }) in frame.rows().enumerate() {
            let profile = roster.profile_of(user);
            let follows = state.moves() || profile.carriages > 1;
            let distance_back = self.distance_back(&state);
            let path = &mut self.paths[user];
            if profile.category == Category::Obstacle || !(follows || self.look.is_some()) {
                path.clear();
                continue;
            }
            let now = DrivenNow {
                time: frame.time,
                front: state.front(),
                axis: direction(state.heading),
                behind: profile.length + distance_back + KEPT_BEHIND,
                ahead: cover.reach(&state, profile, self.options.epsilon),
            };
            self.driven[user].lay(path, &now);
            self.on_lanes[row] = follows;
        }
    }

    /// Extends a road user's path this far ahead.
    pub(super) fn lengthen_driven(&mut self, user: &User, distance: Metre) {
        self.driven[user.index].lengthen(&mut self.paths[user.index], user.axis, distance);
    }
}
