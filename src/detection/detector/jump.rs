//! Road users that change lanes: SUMO moves them to another lane at the end of a step. At the moment of their speeds, half a step
//! before, they were on their former paths.

use super::Detector;
use super::reach::lines_of;
use crate::detection::path::lanes::LanePath;
use crate::traffic::frame::{Frame, State};
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::Metre;

/// A road user that is further beside its path has jumped to another lane, in m; SUMO's narrowest lanes are wider.
const LEAST_JUMP: Metre = 0.5;

/// A road user that has jumped to another lane.
pub(super) struct Jump {
    /// Its row in the frame.
    pub row: u32,
    user: UserIndex,
    /// Its former path, on which it is at the moment of its speed.
    path: LanePath,
}

impl Detector {
    /// Notes that a road user has jumped to the side of its path, if it has and road users are moved back.
    pub(super) fn take_jump(&mut self, row: u32, user: UserIndex, state: &State) {
        let path = &self.paths[user.0 as usize];
        if self.behind() == 0.0 || path.track.is_empty() {
            return;
        }
        let of_net = lines_of(self.net.as_deref());
        let (point, direction) = path.track.ahead_at(path.lines(of_net), state.speed * self.step);
        let (off, direction) = (state.front() - point, direction.normalize());
        let along = off.dot(&direction);
        let aside = off - direction * along;
        if aside.norm() > LEAST_JUMP && along.abs() < aside.norm() {
            let mut path = path.clone();
            path.move_on(of_net, state.speed * (self.step - self.behind()));
            self.jumps.push(Jump { row, user, path });
        }
    }

    /// Puts those that have jumped back on their former paths, for this step.
    pub(super) fn undo_jumps(&mut self, frame: &mut Frame, roster: &Roster) {
        for Jump { row, user, path } in &mut self.jumps {
            let lines = path.lines(lines_of(self.net.as_deref()));
            let (front, axis) = (path.track.point(lines), path.track.chord(lines, roster.profile_of(*user).chord));
            let state = frame.state_mut(*row);
            (state.x, state.y, state.heading) = (front.x, front.y, axis.y.atan2(axis.x));
            self.on_lanes[*row as usize] = true;
            let next = std::mem::replace(&mut self.paths[user.0 as usize], std::mem::take(path));
            self.next_paths.push((*user, next));
        }
    }

    /// Gives those that had jumped in the last step the paths of their new lanes.
    pub(super) fn redo_jumps(&mut self) {
        self.jumps.clear();
        self.jumped.clear();
        for (user, path) in self.next_paths.drain(..) {
            self.paths[user.0 as usize] = path;
            self.jumped.push(user);
        }
    }
}
