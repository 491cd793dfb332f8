//! Where the road users of a step will go: their poses, and the boxes around what they cover on the way. Laid when
//! somebody asks, then kept until the step ends.

use super::{Row, Scene};
use crate::accurate::{Cover, Mover};
use crate::frame::State;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::sweep::TOLERANCE;
use crate::geometry::{Bounds, Point};
use crate::options::{Mode, PathModel};
use crate::path::{Pose, arc, straight};
use crate::profile::Category;
use crate::units::Metre;

/// The ways of a step that were asked for.
#[derive(Default)]
pub(super) struct Ways {
    step: u32,
    laid: Vec<Laid>,
    poses: Vec<Pose>,
    covers: Vec<Cover>,
}

/// The way of a row.
#[derive(Clone, Copy)]
struct Laid {
    /// The step it was laid in.
    step: u32,
    poses: (u32, u32),
    /// Where its covers begin, that of the whole way and those from pose to pose; none as long as nobody asked.
    covers: Option<u32>,
    straight: bool,
    /// The box around all that it covers on the way.
    bounds: Bounds,
}

impl Laid {
    const NOTHING: Self = Self { step: 0, poses: (0, 0), covers: None, straight: false, bounds: Bounds::EMPTY };
}

impl Ways {
    /// Forgets those of the last step; rows below `rows` may be asked for.
    pub(super) fn begin(&mut self, rows: usize) {
        if self.laid.len() < rows {
            self.laid.resize(rows, Laid::NOTHING);
        }
        self.step = self.step.wrapping_add(1).max(1);
        self.poses.clear();
        self.covers.clear();
    }

    /// Lays a row's poses until it stands and ε further, unless it can only go straight on: then phase 1 has said where
    /// it will be.
    pub(super) fn see(&mut self, scene: &Scene, row: u32) {
        if !scene.row(row).ahead {
            self.lay(scene, row);
        }
    }

    fn lay(&mut self, scene: &Scene, row: u32) {
        let laid = &mut self.laid[row as usize];
        if laid.step == self.step {
            return;
        }
        let (profile, stop, start) = (scene.profile(row), scene.row(row).stop, self.poses.len());
        scene.course(row, &[stop, stop + scene.options.epsilon], false, &mut self.poses);
        let poses = &self.poses[start..];
        let axis = poses.first().map_or(scene.row(row).axis, |pose| pose.axis);
        let bounds = if !scene.leaves_out.ways_apart {
            Bounds::EVERYTHING
        } else if scene.row(row).ahead {
            scene.areas[row as usize].bounds
        } else {
            let mut bounds = Bounds::EMPTY;
            for pose in poses {
                bounds.join(&Rectangle::behind(pose.front, pose.axis, profile.length, profile.width).bounds());
            }
            bounds.grown(TOLERANCE)
        };
        *laid = Laid {
            step: self.step,
            poses: (start as u32, self.poses.len() as u32),
            covers: None,
            straight: poses.iter().all(|pose| pose.axis == axis),
            bounds,
        };
    }

    /// Lays a row's poses and the boxes around them.
    pub(super) fn cover(&mut self, scene: &Scene, row: u32) {
        self.lay(scene, row);
        let laid = &mut self.laid[row as usize];
        if laid.covers.is_some() {
            return;
        }
        laid.covers = Some(self.covers.len() as u32);
        let profile = scene.profile(row);
        let poses = &self.poses[laid.poses.0 as usize..laid.poses.1 as usize];
        let of = |poses: &[Pose]| match scene.leaves_out.ways_apart {
            true => Cover::of(poses, profile.length, profile.width).unwrap_or_else(|| laid.bounds.into()),
            false => Cover::EVERYWHERE,
        };
        let whole = of(poses);
        self.covers.push(whole);
        if laid.straight {
            // A part of it is hardly smaller, and there are two at most.
            self.covers.extend(poses.windows(2).map(|_| whole));
        } else {
            self.covers.extend(poses.windows(2).map(of));
        }
    }

    /// The box around all that a row covers on its way.
    pub(super) fn bounds<'a>(&'a self, scene: &'a Scene, row: u32) -> &'a Bounds {
        match self.laid(row) {
            Some(laid) => &laid.bounds,
            None => &scene.areas[row as usize].bounds,
        }
    }

    /// A row with as much of its way as was asked for.
    pub(super) fn mover<'a>(&'a self, scene: &Scene<'a>, row: u32) -> Mover<'a> {
        let Row { axis, stop, category, .. } = *scene.row(row);
        let (profile, State { x, y, speed, .. }) = (scene.roster.profile_at(scene.row(row).profile), *scene.state(row));
        let mut mover = Mover {
            rectangle: Rectangle::behind(Point::new(x, y), axis, profile.length, profile.width),
            shape: &[],
            poses: &[],
            straight: true,
            reach: stop + scene.options.epsilon,
            cover: &Cover::NOWHERE,
            covers: &[],
            speed,
            brakes: &profile.brakes,
            stop,
        };
        if category == Category::Obstacle {
            mover.shape = &scene.roster.user(scene.user(row)).shape;
            mover.reach = 0.0;
        }
        if let Some(laid) = self.laid(row) {
            mover.poses = &self.poses[laid.poses.0 as usize..laid.poses.1 as usize];
            mover.straight = laid.straight;
            mover.reach = mover.poses.last().map_or(0.0, |pose| pose.way);
            if let Some(start) = laid.covers {
                let steps = mover.poses.len().saturating_sub(1);
                mover.cover = &self.covers[start as usize];
                mover.covers = &self.covers[start as usize + 1..][..steps];
            }
        }
        mover
    }

    fn laid(&self, row: u32) -> Option<&Laid> {
        self.laid.get(row as usize).filter(|laid| laid.step == self.step)
    }
}

impl Scene<'_> {
    /// Adds a row's poses at the given ways, and between, as far as its path is known; `beyond` that straight on.
    pub(super) fn course(&self, row: u32, ways: &[Metre], beyond: bool, poses: &mut Vec<Pose>) {
        let Row { axis, category, on_lanes, .. } = *self.row(row);
        if category == Category::Obstacle {
            return;
        }
        let State { x, y, .. } = *self.state(row);
        let (front, profile) = (Point::new(x, y), self.profile(row));
        let memory = &self.memory[self.user(row).0 as usize];
        if on_lanes {
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
}
