//! Where the road users of a step will go: their poses, and the boxes around what they cover. Computed on demand and kept
//! until the step ends.

use super::reach::User;
use super::step::StepInputs;
use crate::detection::narrow_phase::{Participant, SweptBounds};
use crate::detection::path::{Pose, arc, straight};
use crate::geometry::Bounds;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::sweep::TOLERANCE;
use crate::options::{Mode, PathModel};
use crate::traffic::profile::Category;
use crate::util::units::Metre;

/// Initial capacity: few paths have more poses.
pub(super) const MOST_POSES: usize = 64;

/// A straight path has a pose at its start, one where the road user stands and one ε further.
const MOST_STRAIGHT: usize = 3;

/// The paths of a step that were asked for, until the step ends.
#[derive(Default)]
pub(super) struct OccupancyCache {
    /// By slot, which of `built` is its path; [`NOT_BUILT`] until it is asked for.
    numbers: Vec<u32>,
    built: Vec<BuiltPath>,
    poses: Vec<Pose>,
    covers: Vec<SweptBounds>,
}

const NOT_BUILT: u32 = u32::MAX;

/// The path of the road user in a slot.
#[derive(Clone, Copy)]
struct BuiltPath {
    poses: (u32, u32),
    /// Index of its first cover: that of the whole path, then those between poses. None until asked for.
    covers: Option<u32>,
    straight: bool,
    /// The box around all that it covers.
    bounds: Bounds,
}

impl OccupancyCache {
    /// Forgets the paths of the last step; slots below `slots` may be asked for.
    pub(super) fn begin(&mut self, slots: usize) {
        self.numbers.clear();
        self.numbers.resize(slots, NOT_BUILT);
        self.built.clear();
        self.poses.clear();
        self.covers.clear();
    }

    /// Computes the poses until the road user stands and ε further. Not needed where it can only go straight on, as the
    /// broad phase has its box.
    pub(super) fn see(&mut self, scene: &StepInputs, slot: u32) {
        if !scene.user(slot).ahead {
            self.build(scene, slot);
        }
    }

    fn build(&mut self, scene: &StepInputs, slot: u32) {
        if self.find(slot).is_some() {
            return;
        }
        let user = scene.user(slot);
        let all = &mut self.poses;
        let (profile, start) = (scene.profile(user), all.len());
        scene.course(user, &[scene.stop(user), scene.reach_of(user)], false, all);
        let poses = &all[start..];
        let axis = poses.first().map_or(user.axis, |pose| pose.axis);
        let length = scene.drawn_length(user);
        let straight = scene.paths.is_to_scale(poses) && poses.iter().all(|pose| pose.axis == axis);
        let bounds = if !scene.shortcuts.paths_apart {
            Bounds::EVERYTHING
        } else if user.ahead {
            scene.reach.area(user).bounds
        } else {
            let mut bounds = Bounds::EMPTY;
            // The boxes of the first and last pose of a straight path hold all between them.
            for pose in poses.iter().step_by(if straight { (poses.len() - 1).max(1) } else { 1 }) {
                bounds.join(&Rectangle::behind(pose.front, pose.axis, length, profile.width).bounds());
            }
            bounds.grown(TOLERANCE)
        };
        self.numbers[slot as usize] = self.built.len() as u32;
        self.built.push(BuiltPath { poses: (start as u32, all.len() as u32), covers: None, straight, bounds });
    }

    /// Computes the poses and the boxes around them.
    pub(super) fn cover(&mut self, scene: &StepInputs, slot: u32) {
        self.build(scene, slot);
        let Self { numbers, built, poses, covers } = self;
        let built = &mut built[numbers[slot as usize] as usize];
        if built.covers.is_some() {
            return;
        }
        built.covers = Some(covers.len() as u32);
        let user = scene.user(slot);
        let (length, width) = (scene.drawn_length(user), scene.profile(user).width);
        let poses = &poses[built.poses.0 as usize..built.poses.1 as usize];
        let of = |poses: &[Pose]| match scene.shortcuts.paths_apart {
            true => SweptBounds::of(poses, length, width).unwrap_or_else(|| built.bounds.into()),
            false => SweptBounds::EVERYWHERE,
        };
        let whole = match poses {
            [first, .., last] if built.straight && poses.len() <= MOST_STRAIGHT && scene.shortcuts.paths_apart => {
                SweptBounds::straight(first, last, length, width, built.bounds)
            }
            _ => of(poses),
        };
        covers.push(whole);
        if !built.straight {
            covers.extend(poses.windows(2).map(of));
        }
    }

    /// The box around all that a road user covers on its path.
    pub(super) fn bounds(&self, scene: &StepInputs, slot: u32) -> Bounds {
        match self.find(slot) {
            Some(built) => built.bounds,
            None => scene.reach.area(scene.user(slot)).bounds,
        }
    }

    /// The boxes around all that a road user covers, if [`Self::cover`] was called for it.
    pub(super) fn cover_of(&self, slot: u32) -> &SweptBounds {
        let found = self.find(slot).and_then(|built| self.covers.get(built.covers? as usize));
        found.unwrap_or(&SweptBounds::EVERYWHERE)
    }

    /// The road user in a slot, with its path unless that is straight ahead.
    pub(super) fn mover<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Participant<'a> {
        if scene.user(slot).ahead { scene.mover(slot) } else { self.covered(scene, slot) }
    }

    /// The road user in a slot, after [`Self::cover`].
    pub(super) fn covered<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Participant<'a> {
        let mut mover = scene.mover(slot);
        if let Some(built) = self.find(slot) {
            mover.poses = &self.poses[built.poses.0 as usize..built.poses.1 as usize];
            mover.straight = built.straight;
            mover.reach = mover.poses.last().map_or(0.0, |pose| pose.distance);
            if let Some(start) = built.covers {
                let steps = if built.straight { 0 } else { mover.poses.len().saturating_sub(1) };
                mover.cover = &self.covers[start as usize];
                mover.covers = &self.covers[start as usize + 1..][..steps];
            }
        }
        mover
    }

    fn find(&self, slot: u32) -> Option<&BuiltPath> {
        self.built.get(self.numbers[slot as usize] as usize)
    }
}

impl<'a> StepInputs<'a> {
    /// The road user in a slot, without its path.
    pub(super) fn mover(&self, slot: u32) -> Participant<'a> {
        let user = self.user(slot);
        let (profile, state) = (self.roster.profile_at(user.profile), self.state(user));
        let stop = self.stop(user);
        let mut mover = Participant {
            rectangle: Rectangle::behind(state.front(), user.axis, self.drawn_length(user), profile.width),
            setback: 0.0,
            shape: &[],
            poses: &[],
            straight: true,
            reach: self.reach_of(user),
            cover: &SweptBounds::NOWHERE,
            covers: &[],
            speed: state.speed,
            brakes: &profile.brakes,
            stop,
        };
        if user.category == Category::Obstacle {
            mover.shape = self.roster.shape(user.index);
            mover.reach = 0.0;
        }
        mover
    }

    /// Adds a road user's poses at the given distances and between, as far as its path is known; `beyond` that straight
    /// on.
    pub(super) fn course(&self, user: &User, distances: &[Metre], beyond: bool, poses: &mut Vec<Pose>) {
        let (User { axis, category, on_lanes, .. }, front) = (*user, self.state(user).front());
        if category == Category::Obstacle {
            return;
        }
        let chord = || self.profile(user).chord;
        if on_lanes {
            let (track, lines) = self.paths.track(user.index);
            return track.poses(lines, axis, chord(), distances, beyond, poses);
        }
        poses.push(Pose { distance: 0.0, front, axis });
        let distances = &distances[distances.partition_point(|distance| *distance <= 0.0)..];
        if self.options.path == PathModel::Arc && self.options.mode == Mode::Closecall {
            arc::poses(front, axis, self.turnings[user.index.0 as usize].curvature, chord(), distances, poses);
        } else {
            straight::poses(front, axis, distances, poses);
        }
    }
}
