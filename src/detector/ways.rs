//! Where the road users of a step will go: their poses, and the boxes around what they cover on the way.

use super::{Detector, Row};
use crate::accurate::{Cover, Mover};
use crate::frame::{Frame, Roster, State};
use crate::geometry::rectangle::Rectangle;
use crate::geometry::sweep::TOLERANCE;
use crate::geometry::{Bounds, Point};
use crate::options::{Mode, PathModel};
use crate::path::{Pose, arc, straight};
use crate::profile::Category;
use crate::units::Metre;

impl Detector {
    /// A row's poses until it stands and ε further.
    pub(super) fn lay_poses(&mut self, frame: &Frame, roster: &Roster, row: usize) {
        let user = frame.users()[row];
        let profile = roster.profile_of(user);
        let stop = self.rows[row].stop;
        let start = self.poses.len();
        let ways = [stop, stop + self.options.epsilon];
        let mut poses = std::mem::take(&mut self.poses);
        self.course(frame, roster, row, &ways, false, &mut poses);
        self.poses = poses;
        let laid = &self.poses[start..];
        let axis = laid.first().map_or(self.rows[row].axis, |pose| pose.axis);
        let row = &mut self.rows[row];
        row.poses = (start as u32, self.poses.len() as u32);
        row.straight = laid.iter().all(|pose| pose.axis == axis);
        row.bounds = Bounds::EMPTY;
        if profile.category == Category::Obstacle {
            for part in roster.user(user).shape.iter() {
                row.bounds.join(&part.bounds);
            }
        }
        for pose in laid {
            row.bounds.join(&Rectangle::behind(pose.front, pose.axis, profile.length, profile.width).bounds());
        }
        row.bounds = if self.leaves_out.ways_apart { row.bounds.grown(TOLERANCE) } else { Bounds::EVERYTHING };
    }

    /// Sees to it that a row's covers are known.
    pub(super) fn cover(&mut self, frame: &Frame, roster: &Roster, row: u32) {
        let user = frame.users()[row as usize];
        let row = &mut self.rows[row as usize];
        if row.covers.is_none() {
            let profile = roster.profile_of(user);
            row.covers = Some(self.covers.len() as u32);
            let poses = &self.poses[row.poses.0 as usize..row.poses.1 as usize];
            let of = |poses: &[Pose]| match self.leaves_out.ways_apart {
                true => Cover::of(poses, profile.length, profile.width).unwrap_or_else(|| row.bounds.into()),
                false => Cover::EVERYWHERE,
            };
            self.covers.push(of(poses));
            self.covers.extend(poses.windows(2).map(of));
        }
    }

    /// Poses of a row at the given ways, and between.
    pub(super) fn course(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        row: usize,
        ways: &[Metre],
        beyond: bool,
        poses: &mut Vec<Pose>,
    ) {
        let user = frame.users()[row];
        let profile = roster.profile_of(user);
        let State { x, y, .. } = frame.states()[row];
        let (front, axis) = (Point::new(x, y), self.rows[row].axis);
        let memory = &mut self.memory[user.0 as usize];
        if profile.category == Category::Obstacle {
            return;
        }
        if self.rows[row].on_lanes
            && let Some(net) = &self.net
        {
            let furthest = ways.last().copied().unwrap_or(0.0);
            memory.path.reach(net, profile.chord, furthest);
            memory.path.track.poses(axis, profile.chord, ways, beyond, poses);
            return;
        }
        poses.push(Pose { way: 0.0, front, axis });
        let ways = &ways[ways.partition_point(|way| *way <= 0.0)..];
        if self.options.path == PathModel::Arc && self.options.mode == Mode::Closecall {
            arc::poses(front, axis, memory.curvature, profile.chord, ways, poses);
        } else {
            straight::poses(front, axis, ways, poses);
        }
    }

    /// The covers of a row's whole way and of its steps.
    pub(super) fn covers_of(&self, row: &Row) -> (Cover, &[Cover]) {
        let steps = (row.poses.1 - row.poses.0).saturating_sub(1) as usize;
        let known = row.covers.map(|start| &self.covers[start as usize..][..=steps]);
        known.and_then(<[Cover]>::split_first).map_or((Cover::NOWHERE, &[]), |(whole, steps)| (*whole, steps))
    }

    pub(super) fn mover<'a>(&'a self, frame: &Frame, roster: &'a Roster, row: u32) -> Mover<'a> {
        let (index, row) = (row as usize, &self.rows[row as usize]);
        let user = frame.users()[index];
        let profile = roster.profile_of(user);
        let state = &frame.states()[index];
        let (cover, covers) = self.covers_of(row);
        Mover {
            rectangle: Rectangle::behind(Point::new(state.x, state.y), row.axis, profile.length, profile.width),
            shape: &roster.user(user).shape,
            poses: &self.poses[row.poses.0 as usize..row.poses.1 as usize],
            straight: row.straight,
            cover,
            covers,
            speed: state.speed,
            brakes: &profile.brakes,
            stop: row.stop,
        }
    }
}
