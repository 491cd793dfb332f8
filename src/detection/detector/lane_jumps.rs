//! Road users that jump to another lane: SUMO moves them there at the end of a step, so that they were on their former lanes
//! before.

use super::Detector;
use super::jump::Jump;
use super::last_speed::LastSpeed;
use super::moved_back::{BESIDE, is_askew};
use super::paths::lines_of;
use crate::detection::path::turn;
use crate::traffic::frame::State;
use crate::traffic::profile::Profile;
use crate::traffic::roster::UserIndex;
use crate::util::units::Metre;

/// A road user that is further from where its path leads was put elsewhere (SUMO's teleports, scripts), in m; no lane of a street
/// is wider.
const MOST_JUMP: Metre = 10.0;

impl Detector {
    /// Notes that a road user has jumped to the side of its path, if it has and road users are moved back. After being put
    /// elsewhere it counts as new. If it did not head along its path, it has not jumped from it.
    pub(super) fn take_jump(&mut self, row: u32, user: UserIndex, profile: &Profile, state: &State) {
        let path = &self.paths[user];
        if self.behind() == 0.0 || path.track.is_empty() {
            return;
        }
        let Some(last) = self.last_reported(user) else { return };
        let lines = path.lines(lines_of(self.net.as_deref()));
        let (displacement, chord) = (state.front() - last.front(), path.track.chord(lines, profile.chord));
        if is_askew(&chord, &last) && displacement.norm() <= self.driven_at_most(user, state.speed) {
            return;
        }
        let (point, axis) = path.track.ahead_at(lines, state.speed * self.step);
        let off = state.front() - point;
        let aside = off - axis * off.dot(&axis);
        let ahead = displacement.dot(&path.track.ahead_at(lines, 0.0).1);
        if off.norm() >= MOST_JUMP || ahead < -BESIDE {
            self.speeds[user] = LastSpeed::default();
        } else if aside.norm() >= BESIDE {
            let mut path = path.clone();
            let driven = state.speed * (self.step - self.behind());
            path.move_on(lines_of(self.net.as_deref()), driven.min(ahead).max(0.0));
            let lines = path.lines(lines_of(self.net.as_deref()));
            let heading = last.heading + turn(&chord, &path.track.chord(lines, profile.chord));
            self.jumps.push(Jump { row, user, path, heading });
        }
    }

    /// Puts a jumping road user back on its former path, for this step.
    pub(super) fn undo_jump(&mut self, jump: &mut Jump, profile: &Profile, state: &mut State) {
        let Jump { row, user, path, heading } = jump;
        let front = path.track.point(path.lines(lines_of(self.net.as_deref())));
        (state.x, state.y, state.heading) = (front.x, front.y, *heading);
        self.on_lanes[*row as usize] = state.moves() || profile.carriages > 1;
        let next = std::mem::replace(&mut self.paths[*user], std::mem::take(path));
        self.next_paths.push((*user, next));
    }

    /// Gives those that had jumped in the last step the paths of their new lanes.
    pub(super) fn redo_jumps(&mut self) {
        self.jumps.clear();
        self.jumped.clear();
        for (user, path) in self.next_paths.drain(..) {
            self.paths[user] = path;
            self.jumped.push(user);
        }
    }
}
