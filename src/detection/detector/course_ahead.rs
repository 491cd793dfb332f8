//! The course of a road user, from the path that the detector keeps for it.

use super::Detector;
use super::cover::reach;
use crate::detection::course::{Course, LaneChange, Stretch};
use crate::detection::path::lanes::KEPT_BEHIND;
use crate::traffic::frame::Frame;
use crate::traffic::lane_change::LaneChangeReason;
use crate::traffic::net::{EdgeFunction, LaneIndex};
use crate::traffic::profile::Category;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::index::row_of;
use crate::util::units::Metre;

/// A path of which the front bumper is further away than this is not that of the road user now, in m.
const ON_THE_PATH: Metre = 1.0;

impl Detector {
    /// The course of the road user of a row, until it stands, or until it has gone this far if that is further.
    pub fn course(&self, frame: &Frame, roster: &Roster, row: u32, distance: Metre) -> Course {
        let (user, state) = (frame.user(row), frame.state(row));
        let profile = roster.profile_of(user);
        // Beyond, how far a path leads depends on the log's condition and on when it was last extended.
        let behind = -(profile.length + KEPT_BEHIND);
        let ahead = reach(state, profile, self.options.epsilon).max(distance);
        let last = self.speeds.get(user).copied().unwrap_or_default();
        let (deceleration, since_impossible_stop) = (last.deceleration(), last.since_impossible_stop());
        let mut course = Course { deceleration, since_impossible_stop, ..Course::default() };
        let Some((net, path)) = self.net.as_deref().zip(self.paths.get(user)) else {
            return course;
        };
        let is_before_jump = self.jumps.iter().any(|jump| jump.row == row);
        let has_jumped = self.jumped.contains(&user);
        let is_on = || (path.track.point(path.lines(&net.lines)) - state.front()).norm() < ON_THE_PATH;
        course.has_jumped = has_jumped;
        if !path.track.is_empty() && is_on() {
            path.each_lane(&net.lines, |lane, [begin, end]| {
                if end > behind && begin <= ahead {
                    course.stretches.push(Stretch { lane, begin, end });
                }
            });
            course.is_against = path.is_against();
            course.lateral_speed = path.lateral_speed();
            // One that jumps at the end of this step is still on its former lane.
            course.change = self.lane_change(user).filter(|change| !is_before_jump || change.time < self.time);
        } else if profile.category != Category::Person
            && let (false, Some(lane)) = (state.moves(), net.lane_at(state.front()))
        {
            // One that has not moved since it entered the scene has no path.
            course.stretches.push(Stretch { lane, begin: f64::NEG_INFINITY, end: f64::INFINITY });
        }
        course
    }

    /// The last change of lanes of a road user.
    pub fn lane_change(&self, user: UserIndex) -> Option<LaneChange> {
        self.lane_changes.get(user).copied().flatten()
    }

    /// States why a road user changed lanes last.
    pub fn set_lane_change_reason(&mut self, user: UserIndex, reason: Option<LaneChangeReason>) {
        if let Some(Some(change)) = self.lane_changes.get_mut(user) {
            change.reason = reason;
        }
    }

    /// Notes that a road user has changed lanes, if the one that it was on is of the same edge as that on which it is now; in a
    /// junction, too.
    pub(super) fn take_lane(&mut self, user: UserIndex, from: Option<LaneIndex>, to: LaneIndex) {
        let (Some(net), Some(from)) = (&self.net, from.filter(|from| *from != to)) else { return };
        let edge = |lane: LaneIndex| net.lanes[lane].edge;
        if edge(from) != edge(to) || !matches!(net.function(to), EdgeFunction::Normal | EdgeFunction::Internal) {
            return;
        }
        *row_of(&mut self.lane_changes, user, || None) = Some(LaneChange { time: self.time, from, to, reason: None });
    }
}
