//! The road users' paths along lanes: set from placements, lengthened as far as both phases look, and given out.

use std::sync::Arc;

use super::Detector;
use super::paths::PathSource;
use super::reach::User;
use crate::detection::measures::ttc::HORIZON;
use crate::detection::path::Pose;
use crate::detection::path::lanes::PathStart;
use crate::geometry::Point;
use crate::geometry::rectangle::direction;
use crate::traffic::frame::{Frame, Row};
use crate::traffic::net::LaneIndex;
use crate::traffic::placement::Placement;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::Metre;

/// As far ahead of a road user that stands at a junction its way through it is followed, in m.
const AHEAD: Metre = 20.0;

impl Detector {
    /// Whether the road user of a row is still on the path built before.
    pub fn keeps_path(&self, row: u32) -> bool {
        self.on_lanes[row as usize]
    }

    /// Whether a road user's route is known from this position on.
    pub fn knows_route(&self, user: UserIndex, position: usize) -> bool {
        self.paths.get(user).is_some_and(|path| path.knows_route(position))
    }

    /// The lane that a road user's front bumper is on, where it follows lanes.
    pub fn lane(&self, user: UserIndex) -> Option<LaneIndex> {
        self.paths.get(user)?.lane()
    }

    /// Sets a road user's place on the net. No effect while it is still on a path that matches its route.
    pub fn set_placement(&mut self, frame: &Frame, roster: &Roster, row: u32, placement: &Placement) {
        let Some(net) = &self.net else { return };
        let Row { user, state } = frame.row(row);
        let distance_back = self.distance_back(&state);
        let (path, profile) = (&mut self.paths[user], roster.profile_of(user));
        let is_for = |route: &Arc<[_]>| path.is_for(net, route, placement.route_position);
        if self.on_lanes[row as usize] && placement.route.as_ref().is_none_or(is_for) {
            return;
        }
        let start = PathStart {
            front: state.front(),
            axis: direction(state.heading),
            chord: profile.chord,
            length: profile.length,
            distance_back,
            width: profile.width,
            speed: state.speed,
            sublane: self.sublane,
            step: self.step,
        };
        let before = path.lane_at(&net.lines, 0.0);
        path.build(net, &start, placement);
        self.on_lanes[row as usize] = !path.track.is_empty();
        self.take_lane(user, before, placement.lane);
    }

    /// Extends all paths as far as both phases look, whether in a pair or not: a road user at the end of its path would
    /// get another one.
    pub(super) fn lengthen_all(&mut self, frame: &Frame, roster: &Roster) {
        let Some(net) = self.net.as_ref().filter(|_| self.turns() == PathSource::Lanes) else { return };
        let cover = self.cover();
        for (Row { user, state }, on_lanes) in frame.rows().zip(&self.on_lanes) {
            if *on_lanes || self.look.is_some() {
                let profile = roster.profile_of(user);
                let distance = cover.reach(&state, profile, self.options.epsilon);
                self.paths[user].extend(net, profile.length, distance);
            }
        }
    }

    /// Extends a road user's path this far ahead, if its route reaches that far.
    pub(super) fn lengthen(&mut self, roster: &Roster, user: &User, distance: Metre) {
        if self.turns() == PathSource::Driven {
            return self.lengthen_driven(user, distance);
        }
        if let Some(net) = &self.net {
            self.paths[user.index].extend(net, roster.profile_at(user.profile).length, distance);
        }
    }

    /// The poses that the road user of a row will go through within [`HORIZON`] at its speed, and at least 20 m.
    pub fn ahead(&self, frame: &Frame, roster: &Roster, row: u32) -> Vec<Pose> {
        let (sight, scene, mut poses) = (self.sight(frame, roster), self.scene(frame, roster), Vec::new());
        let user = sight.user(row, &sight.see(row), &User::default());
        if let Some(first) = scene.carriages(&user).next() {
            let distance = AHEAD.max(frame.state(row).speed * HORIZON);
            scene.course(&user, first, &[distance], true, &mut poses);
        }
        poses
    }

    /// The path of a row's front bumper from where it is until it stands and ε further; empty for an obstacle.
    pub fn path(&self, frame: &Frame, roster: &Roster, row: u32) -> Vec<Point> {
        let (sight, mut poses) = (self.sight(frame, roster), Vec::new());
        let user = sight.user(row, &sight.see(row), &User::default());
        let scene = self.scene(frame, roster);
        if let Some(first) = scene.carriages(&user).next() {
            scene.course(&user, first, &[scene.stop(&user), scene.reach_of(&user)], false, &mut poses);
        }
        poses.iter().map(|pose| pose.front).collect()
    }
}
