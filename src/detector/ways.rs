//! Where the road users of a step will go: their poses, and the boxes around what they cover on the way. Laid when
//! somebody asks, then kept until the step ends.

use super::{Scene, User};
use crate::accurate::{Cover, Mover};
use crate::frame::{fill, make_room};
use crate::geometry::Bounds;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::sweep::TOLERANCE;
use crate::options::{Mode, PathModel};
use crate::path::{Pose, arc, straight};
use crate::profile::Category;
use crate::units::Metre;

/// Hardly a way has more poses; the table of all grows by doubling where one has.
const MOST_POSES: usize = 32;

/// A straight way has poses where it begins, where it stands and ε further.
const MOST_STRAIGHT: usize = 3;

/// The ways of a step that were asked for, by slot.
#[derive(Default)]
pub(super) struct Ways {
    step: u32,
    laid: Vec<Laid>,
    poses: Vec<Pose>,
    covers: Vec<Cover>,
}

/// The way of who is in a slot.
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
    /// Forgets those of the last step; slots below `slots` may be asked for.
    pub(super) fn begin(&mut self, slots: usize) {
        if self.laid.len() < slots {
            fill(&mut self.laid, slots, Laid::NOTHING);
        }
        self.step = self.step.wrapping_add(1).max(1);
        self.poses.clear();
        self.covers.clear();
    }

    /// Lays the poses until it stands and ε further, unless it can only go straight on: then phase 1 has said where it
    /// will be.
    pub(super) fn see(&mut self, scene: &Scene, slot: u32) {
        if !scene.user(slot).ahead {
            self.lay(scene, slot);
        }
    }

    fn lay(&mut self, scene: &Scene, slot: u32) {
        let laid = &mut self.laid[slot as usize];
        if laid.step == self.step {
            return;
        }
        let user = scene.user(slot);
        let (profile, start) = (scene.profile(user), self.poses.len());
        make_room(&mut self.poses, MOST_POSES);
        scene.course(user, &[user.stop, user.stop + scene.options.epsilon], false, &mut self.poses);
        let poses = &self.poses[start..];
        let axis = poses.first().map_or(user.axis, |pose| pose.axis);
        let straight = poses.iter().all(|pose| pose.axis == axis);
        let bounds = if !scene.leaves_out.ways_apart {
            Bounds::EVERYTHING
        } else if user.ahead {
            scene.reach.area(user).bounds
        } else {
            let mut bounds = Bounds::EMPTY;
            // What lies between the first and the last of a straight way their boxes hold.
            for pose in poses.iter().step_by(if straight { (poses.len() - 1).max(1) } else { 1 }) {
                bounds.join(&Rectangle::behind(pose.front, pose.axis, profile.length, profile.width).bounds());
            }
            bounds.grown(TOLERANCE)
        };
        *laid =
            Laid { step: self.step, poses: (start as u32, self.poses.len() as u32), covers: None, straight, bounds };
    }

    /// Lays the poses and the boxes around them.
    pub(super) fn cover(&mut self, scene: &Scene, slot: u32) {
        self.lay(scene, slot);
        let laid = &mut self.laid[slot as usize];
        if laid.covers.is_some() {
            return;
        }
        laid.covers = Some(self.covers.len() as u32);
        let profile = scene.profile(scene.user(slot));
        let poses = &self.poses[laid.poses.0 as usize..laid.poses.1 as usize];
        let of = |poses: &[Pose]| match scene.leaves_out.ways_apart {
            true => Cover::of(poses, profile.length, profile.width).unwrap_or_else(|| laid.bounds.into()),
            false => Cover::EVERYWHERE,
        };
        let whole = match poses {
            [first, .., last] if laid.straight && poses.len() <= MOST_STRAIGHT && scene.leaves_out.ways_apart => {
                Cover::straight(first, last, profile.length, profile.width, laid.bounds)
            }
            _ => of(poses),
        };
        make_room(&mut self.covers, poses.len().max(1));
        self.covers.push(whole);
        if laid.straight {
            // A part of it is hardly smaller, and there are two at most.
            self.covers.extend(poses.windows(2).map(|_| whole));
        } else {
            self.covers.extend(poses.windows(2).map(of));
        }
    }

    /// The box around all that it covers on its way.
    pub(super) fn bounds(&self, scene: &Scene, slot: u32) -> Bounds {
        match self.laid(slot) {
            Some(laid) => laid.bounds,
            None => scene.reach.area(scene.user(slot)).bounds,
        }
    }

    /// Who is in a slot, with its way if that is not simply ahead.
    pub(super) fn mover<'a>(&'a self, scene: &Scene<'a>, slot: u32) -> Mover<'a> {
        let laid = if scene.user(slot).ahead { None } else { self.laid(slot) };
        self.on(laid, scene, slot)
    }

    /// Who is in a slot whose way was covered.
    pub(super) fn covered<'a>(&'a self, scene: &Scene<'a>, slot: u32) -> Mover<'a> {
        self.on(self.laid(slot), scene, slot)
    }

    fn on<'a>(&'a self, laid: Option<&Laid>, scene: &Scene<'a>, slot: u32) -> Mover<'a> {
        let user = scene.user(slot);
        let profile = scene.roster.profile_at(user.profile);
        let mut mover = Mover {
            rectangle: Rectangle::behind(user.front, user.axis, profile.length, profile.width),
            shape: &[],
            poses: &[],
            straight: true,
            reach: user.stop + scene.options.epsilon,
            cover: &Cover::NOWHERE,
            covers: &[],
            speed: user.speed,
            brakes: &profile.brakes,
            stop: user.stop,
        };
        if user.category == Category::Obstacle {
            mover.shape = &scene.roster.user(user.index).shape;
            mover.reach = 0.0;
        }
        if let Some(laid) = laid {
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

    fn laid(&self, slot: u32) -> Option<&Laid> {
        self.laid.get(slot as usize).filter(|laid| laid.step == self.step)
    }
}

impl Scene<'_> {
    /// Adds a road user's poses at the given ways, and between, as far as its path is known; `beyond` that straight on.
    pub(super) fn course(&self, user: &User, ways: &[Metre], beyond: bool, poses: &mut Vec<Pose>) {
        let User { front, axis, category, on_lanes, .. } = *user;
        if category == Category::Obstacle {
            return;
        }
        let chord = || self.profile(user).chord;
        if on_lanes {
            self.paths[user.index.0 as usize].track.poses(axis, chord(), ways, beyond, poses);
            return;
        }
        poses.push(Pose { way: 0.0, front, axis });
        let ways = &ways[ways.partition_point(|way| *way <= 0.0)..];
        if self.options.path == PathModel::Arc && self.options.mode == Mode::Closecall {
            arc::poses(front, axis, self.turnings[user.index.0 as usize].curvature, chord(), ways, poses);
        } else {
            straight::poses(front, axis, ways, poses);
        }
    }
}
