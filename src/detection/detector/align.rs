//! Road users moved back to the moment to which their speeds belong.
//!
//! SUMO's Euler update moves a road user by v(t) Δt in the step that ends at t. Its position at t and its speed v(t) are
//! those of two moments: v(t) is its mean speed in that step, which it has at t − Δt/2 if it speeds up evenly. There it was
//! v(t) Δt/2 further back along the path that it drove. A change of lanes is a jump at the step's end, so that it was still on
//! the lane before. One that enters the scene at the step's end was not there. If it moves, it keeps its distance from the others
//! by being moved back too, but no overlap is a collision then. If it stands, or was put elsewhere, it meets nothing in that
//! step.

use super::Detector;
use super::jump::Jump;
use super::last_speed::LastSpeed;
use super::paths::lines_of;
use crate::detection::path::turn;
use crate::geometry::rectangle::direction;
use crate::options::Align;
use crate::traffic::frame::{Frame, State};
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{Metre, Second};

/// A road user that is further beside its path has jumped to another lane, in m; SUMO's narrowest lanes are wider.
const LEAST_JUMP: Metre = 0.5;
/// One that is further beside it was put elsewhere (SUMO's teleports, scripts), in m; no lane of a street is wider.
const MOST_JUMP: Metre = 10.0;

impl Detector {
    /// States over which share of a step, up to its end, a road user's speed is the mean: 1 for SUMO's Euler update, 0 for its
    /// ballistic one.
    pub fn set_averaged_over(&mut self, share: f64) {
        self.averaged_over = share;
    }

    /// Whether road users are moved back.
    pub fn aligns(&self) -> bool {
        self.share() > 0.0
    }

    fn share(&self) -> f64 {
        match self.options.align {
            Align::Auto => self.averaged_over,
            Align::Always => 1.0,
            Align::Never => 0.0,
        }
    }

    /// How long before the end of the step a road user has its speed.
    pub(super) fn behind(&self) -> Second {
        self.share() * self.step / 2.0
    }

    /// Moves all road users back to the moment of their speeds, if that is wanted. Call it after [`Detector::track_paths`] and the placements.
    pub fn align(&mut self, frame: &mut Frame, roster: &Roster) {
        let behind = self.behind();
        if behind == 0.0 {
            return;
        }
        frame.begin_to_move_back(behind);
        // What has jumped was not on its path then.
        for jump in &self.jumps {
            self.on_lanes[jump.row as usize] = false;
        }
        for row in 0..frame.len() as u32 {
            let user = frame.user(row);
            let state = frame.state_mut(row);
            let driven = state.speed * behind;
            if driven > 0.0 {
                self.move_back(user, self.on_lanes[row as usize], roster.profile_of(user).chord, state, driven);
            }
        }
        self.undo_jumps(frame, roster);
    }

    /// Notes that a road user has jumped to the side of its path, if it has and road users are moved back. One that was put
    /// elsewhere is as if it had just entered the scene.
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
        if off.norm() >= MOST_JUMP {
            self.speeds[user.0 as usize] = LastSpeed::default();
            self.put_elsewhere.push(user);
        } else if aside.norm() >= LEAST_JUMP {
            let mut path = path.clone();
            path.move_on(of_net, state.speed * (self.step - self.behind()));
            self.jumps.push(Jump { row, user, path });
        }
    }

    /// Puts those that have jumped back on their former paths, for this step.
    fn undo_jumps(&mut self, frame: &mut Frame, roster: &Roster) {
        for Jump { row, user, path } in &mut self.jumps {
            let lines = path.lines(lines_of(self.net.as_deref()));
            let profile = roster.profile_of(*user);
            let (front, axis) = (path.track.point(lines), path.track.chord(lines, profile.chord));
            let state = frame.state_mut(*row);
            (state.x, state.y, state.heading) = (front.x, front.y, axis.y.atan2(axis.x));
            self.on_lanes[*row as usize] = state.moves() || profile.carriages > 1;
            let next = std::mem::replace(&mut self.paths[user.0 as usize], std::mem::take(path));
            self.next_paths.push((*user, next));
        }
    }

    /// Gives those that had jumped in the last step the paths of their new lanes.
    pub(super) fn redo_jumps(&mut self) {
        self.jumps.clear();
        self.jumped.clear();
        self.put_elsewhere.clear();
        for (user, path) in self.next_paths.drain(..) {
            self.paths[user.0 as usize] = path;
            self.jumped.push(user);
        }
    }

    fn move_back(&mut self, user: UserIndex, on_lanes: bool, chord: Metre, state: &mut State, driven: Metre) {
        if !on_lanes {
            let back = direction(state.heading) * driven;
            (state.x, state.y) = (state.x - back.x, state.y - back.y);
            return;
        }
        let path = &mut self.paths[user.0 as usize];
        let of_net = lines_of(self.net.as_deref());
        let before = path.track.chord(path.lines(of_net), chord);
        path.move_back(of_net, driven);
        let front = path.track.point(path.lines(of_net));
        let after = path.track.chord(path.lines(of_net), chord);
        (state.x, state.y) = (front.x, front.y);
        // One that has just entered is as SUMO has put it, straight on its lane.
        if self.speeds.get(user.0 as usize).is_some_and(|last| last.is_known()) {
            state.heading += turn(&before, &after);
        }
    }

    /// How far a path has to reach back beyond the road user's length.
    pub(super) fn way_back(&self, state: &State) -> Metre {
        state.speed * self.behind()
    }
}
