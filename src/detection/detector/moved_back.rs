//! Road users moved back to the moment to which their speeds belong.
//!
//! SUMO's Euler update moves a road user by v(t) Δt in the step that ends at t. Its position at t and its speed v(t) are
//! those of two moments: v(t) is its mean speed in that step, which it has at t − Δt/2 if it speeds up evenly. There it was
//! v(t) Δt/2 further back on its way. That way is known only between the last place that was reported and this one:
//! - along its path, if both places are on it;
//! - along its former path, if it was moved to another lane at the step's end ([`super::jump`]);
//! - else the arc between both poses, on which a vehicle moves that a script steers.
//!
//! No place lies outside. A road user that was not in the last step, or was put elsewhere since, stays where it was reported.
//! Its place at the others' moment is unknown, so it is skipped in that step.

use super::Detector;
use super::last_speed::LastSpeed;
use super::paths::lines_of;
use crate::detection::path::turn;
use crate::geometry::Vector;
use crate::geometry::bow::Bow;
use crate::geometry::rectangle::direction;
use crate::options::Align;
use crate::traffic::frame::{Frame, State};
use crate::traffic::profile::Profile;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::index::make_room;
use crate::util::units::{Metre, Radian, Second};

/// A road user that is further beside its path has not come along it, in m; SUMO's narrowest lanes are wider.
pub(super) const BESIDE: Metre = 0.5;
/// A road user that follows its path heads along it, or went at least this part of the straight way along it, less [`ROUNDED`].
const ALONG: f64 = 0.95;
/// By how much recorded places are rounded, in m.
const ROUNDED: Metre = 0.02;
/// If its heading differs by more from that of its path, it does not follow it, in rad: a script steers it.
const ASKEW: Radian = 0.3;
/// A larger turn in a step is not an arc, in rad: a person turns where it stands.
const MOST_TURN: Radian = 1.0;

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
        if behind > 0.0 {
            frame.begin_to_move_back(behind);
            self.move_all_back(frame, roster);
        }
        if self.aligns() {
            make_room(&mut self.reported.raw, self.paths.len());
            self.reported.resize(self.paths.len(), State::NOWHERE);
            for row in 0..frame.len() as u32 {
                self.reported[frame.user(row)] = *frame.reported(row);
            }
        }
    }

    fn move_all_back(&mut self, frame: &mut Frame, roster: &Roster) {
        let mut jumps = std::mem::take(&mut self.jumps);
        let mut jumped = jumps.iter_mut().peekable();
        for row in 0..frame.len() as u32 {
            let (user, state) = (frame.user(row), frame.state_mut(row));
            let profile = roster.profile_of(user);
            if let Some(jump) = jumped.next_if(|jump| jump.row == row) {
                self.undo_jump(jump, profile, state);
            } else if state.moves()
                && let Some(last) = self.last_reported(user)
            {
                self.move_back(row, user, profile, &last, state);
            }
        }
        self.jumps = jumps;
    }

    /// The state in which a road user was reported in the last step; none if it was not there, or was put elsewhere since.
    pub(super) fn last_reported(&self, user: UserIndex) -> Option<State> {
        let is_known = self.speeds.get(user).is_some_and(|last| last.is_known());
        self.reported.get(user).filter(|_| is_known).copied()
    }

    /// Moves a road user back on its way from where it was reported last.
    fn move_back(&mut self, row: u32, user: UserIndex, profile: &Profile, last: &State, state: &mut State) {
        let driven = state.speed * self.behind();
        let came = if self.on_lanes[row as usize] { self.came(user, profile, last, state) } else { None };
        if let Some(came) = came {
            let (path, of_net) = (&mut self.paths[user], lines_of(self.net.as_deref()));
            let before = path.track.chord(path.lines(of_net), profile.chord);
            path.move_back(of_net, driven.min(came));
            let front = path.track.point(path.lines(of_net));
            let after = path.track.chord(path.lines(of_net), profile.chord);
            (state.x, state.y) = (front.x, front.y);
            state.heading += turn(&before, &after);
            return;
        }
        let driven_straight = (state.front() - last.front()).norm();
        self.on_lanes[row as usize] = false;
        if driven_straight > self.driven_at_most(user, state.speed) {
            self.speeds[user] = LastSpeed::default();
        } else if driven_straight > 0.0 {
            let ends = [last.front(), state.front()];
            let arc = Bow::new(ends, [last.heading, state.heading]);
            let bow = if arc.turn.abs() > MOST_TURN { Bow::new(ends, [state.heading; 2]) } else { arc };
            let back = (driven / driven_straight).min(1.0);
            let front = bow.at(1.0 - back);
            (state.x, state.y) = (front.x, front.y);
            state.heading -= bow.turn * back;
        }
    }

    /// How far a road user came along its path since it was reported last; none if it came another way.
    fn came(&self, user: UserIndex, profile: &Profile, last: &State, state: &State) -> Option<Metre> {
        let path = &self.paths[user];
        path.driven().or_else(|| {
            let lines = path.lines(lines_of(self.net.as_deref()));
            let scale = path.track.scale(lines);
            let (mut came, mut beside) = (self.expected(last, state), Metre::INFINITY);
            // The first guess is right where the speeds tell the way.
            for _ in 0..2 {
                let (point, direction) = path.track.behind_at(lines, came);
                let off = last.front() - point;
                let along = off.dot(&direction);
                beside = (off - direction * along).norm();
                came -= along / scale;
            }
            let driven_straight = (state.front() - last.front()).norm();
            let is_along = || came * scale >= ALONG * driven_straight - ROUNDED;
            let heads_along = || !is_askew(&path.track.chord(lines, profile.chord), state);
            (beside < BESIDE && (is_along() || heads_along())).then_some(came.max(0.0))
        })
    }

    /// How far a road user has driven in the step, as its speeds tell.
    fn expected(&self, last: &State, state: &State) -> Metre {
        let half_of_change = (state.speed - last.speed) / 2.0;
        ((state.speed + last.speed) / 2.0 + self.share() * half_of_change) * self.step
    }

    /// How far a path has to reach back beyond the road user's length.
    pub(super) fn distance_back(&self, state: &State) -> Metre {
        state.speed * self.behind()
    }
}

/// Whether a heading is not that of a path with this chord.
pub(super) fn is_askew(chord: &Vector, state: &State) -> bool {
    turn(chord, &direction(state.heading)).abs() > ASKEW
}
