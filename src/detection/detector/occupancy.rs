//! Where the road users of a step will go: their poses, and the boxes around what they cover. Computed on demand and kept
//! until the step ends.

use smallvec::{SmallVec, smallvec};

use super::reach::User;
use super::step::StepInputs;
use crate::detection::narrow_phase::{Participant, SweptBounds};
use crate::detection::path::{Pose, arc, straight};
use crate::geometry::Bounds;
use crate::geometry::movement::TOLERANCE;
use crate::geometry::rectangle::Rectangle;
use crate::options::{Mode, PathModel};
use crate::traffic::profile::{Carriage, Category};
use crate::util::index::make_room;
use crate::util::units::Metre;

/// Initial capacity: few paths have more poses.
pub(super) const MOST_POSES: usize = 64;

/// A straight path has a pose at its start, one where the road user stands and one ε further.
const MOST_STRAIGHT: usize = 3;

/// The paths of a step that were asked for, until the step ends.
#[derive(Default)]
pub(super) struct OccupancyCache {
    /// By slot, which of `built` is its path, or its first carriage's, which those of the others follow; [`NOT_BUILT`]
    /// until it is asked for.
    numbers: Vec<u32>,
    built: Vec<BuiltPath>,
    poses: Vec<Pose>,
    covers: Vec<SweptBounds>,
}

const NOT_BUILT: u32 = u32::MAX;

/// The path of the road user in a slot, or of one of its carriages.
#[derive(Clone, Copy)]
struct BuiltPath {
    carriage: Carriage,
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
        self.numbers[slot as usize] = self.built.len() as u32;
        let user = scene.user(slot);
        scene.carriages(user).for_each(|carriage| self.build_carriage(scene, user, carriage));
    }

    fn build_carriage(&mut self, scene: &StepInputs, user: &User, carriage: Carriage) {
        let all = &mut self.poses;
        let (profile, start) = (scene.profile(user), all.len());
        make_room(all, start + MOST_POSES);
        scene.course(user, carriage, &[scene.stop(user), scene.reach_of(user)], false, all);
        let poses = &all[start..];
        let axis = poses.first().map_or(user.axis, |pose| pose.axis);
        let length = scene.drawn_length_of(user, carriage);
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
        self.built.push(BuiltPath {
            carriage,
            poses: (start as u32, all.len() as u32),
            covers: None,
            straight,
            bounds,
        });
    }

    /// Computes the poses and the boxes around them.
    pub(super) fn cover(&mut self, scene: &StepInputs, slot: u32) {
        self.build(scene, slot);
        let (user, first) = (scene.user(slot), self.numbers[slot as usize]);
        (first..first + scene.count_carriages(user)).for_each(|number| self.cover_carriage(scene, user, number));
    }

    fn cover_carriage(&mut self, scene: &StepInputs, user: &User, number: u32) {
        let Self { built, poses, covers, .. } = self;
        let built = &mut built[number as usize];
        if built.covers.is_some() {
            return;
        }
        built.covers = Some(covers.len() as u32);
        make_room(covers, covers.len() + (built.poses.1 - built.poses.0).max(1) as usize);
        let (length, width) = (scene.drawn_length_of(user, built.carriage), scene.profile(user).width);
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
        match self.all(scene, slot) {
            [] => scene.reach.area(scene.user(slot)).bounds,
            [only] => only.bounds,
            carriages => carriages.iter().fold(Bounds::EMPTY, |mut all, carriage| {
                all.join(&carriage.bounds);
                all
            }),
        }
    }

    /// Whether the boxes around all that two road users cover are apart, if [`Self::cover`] was called for both.
    pub(super) fn are_apart(&self, scene: &StepInputs, slots: [u32; 2]) -> bool {
        let [a, b] = slots.map(|slot| self.all(scene, slot));
        !a.iter().any(|a| b.iter().any(|b| self.cover_of(a).meets(self.cover_of(b))))
    }

    fn cover_of(&self, built: &BuiltPath) -> &SweptBounds {
        let found = built.covers.and_then(|cover| self.covers.get(cover as usize));
        found.unwrap_or(&SweptBounds::EVERYWHERE)
    }

    /// The road user in a slot, with its path unless that is straight ahead.
    pub(super) fn mover<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Participant<'a> {
        if scene.user(slot).ahead { scene.mover(slot) } else { self.covered(scene, slot) }
    }

    /// The road user in a slot, after [`Self::cover`].
    pub(super) fn covered<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Participant<'a> {
        let mover = scene.mover(slot);
        self.find(slot).map_or(mover, |built| self.along(mover, built))
    }

    /// The carriages of the road user in a slot, after [`Self::cover`].
    pub(super) fn carriages<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Carriages<'a> {
        let carriages = scene.movers(slot).into_iter().zip(self.all(scene, slot));
        carriages.map(|(mover, built)| self.along(mover, built)).collect()
    }

    /// A road user or a carriage with its path.
    fn along<'a>(&'a self, mut mover: Participant<'a>, built: &BuiltPath) -> Participant<'a> {
        mover.poses = &self.poses[built.poses.0 as usize..built.poses.1 as usize];
        mover.straight = built.straight;
        mover.reach = mover.poses.last().map_or(0.0, |pose| pose.distance);
        if let Some(start) = built.covers {
            let steps = if built.straight { 0 } else { mover.poses.len().saturating_sub(1) };
            mover.cover = &self.covers[start as usize];
            mover.covers = &self.covers[start as usize + 1..][..steps];
        }
        mover
    }

    fn find(&self, slot: u32) -> Option<&BuiltPath> {
        self.built.get(self.numbers[slot as usize] as usize)
    }

    /// The paths of all carriages of the road user in a slot; none until they are asked for.
    fn all(&self, scene: &StepInputs, slot: u32) -> &[BuiltPath] {
        let first = self.numbers[slot as usize] as usize;
        let carriages = first..first.saturating_add(scene.count_carriages(scene.user(slot)) as usize);
        self.built.get(carriages).unwrap_or_default()
    }
}

/// The carriages of a road user: mostly it has one.
pub(super) type Carriages<'a> = SmallVec<[Participant<'a>; 1]>;

impl<'a> StepInputs<'a> {
    /// The road user in a slot, without its path.
    pub(super) fn mover(&self, slot: u32) -> Participant<'a> {
        let user = self.user(slot);
        let (profile, state) = (self.roster.profile_at(user.profile), self.state(user));
        let stop = self.stop(user);
        let mut mover = Participant {
            rectangle: Rectangle::behind(state.front(), user.axis, self.drawn_length(user), profile.width),
            carriage: Carriage { behind: 0.0, length: profile.chord },
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

    /// The carriages of the road user in a slot, without their paths.
    pub(super) fn movers(&self, slot: u32) -> Carriages<'a> {
        let (user, mover) = (self.user(slot), self.mover(slot));
        if !user.bends {
            return smallvec![mover];
        }
        let mut poses = Vec::new();
        let of = |carriage| {
            poses.clear();
            self.course(user, carriage, &[], false, &mut poses);
            let length = self.drawn_length_of(user, carriage);
            let behind = |pose: &Pose| Rectangle::behind(pose.front, pose.axis, length, mover.width());
            let rectangle = poses.first().map_or(mover.rectangle, behind);
            Participant { rectangle, carriage, ..mover }
        };
        self.carriages(user).map(of).collect()
    }

    /// Adds the poses of a road user's carriage at the given distances and between, as far as its path is known; `beyond`
    /// that straight on.
    pub(super) fn course(
        &self,
        user: &User,
        carriage: Carriage,
        distances: &[Metre],
        beyond: bool,
        poses: &mut Vec<Pose>,
    ) {
        let (User { axis, category, on_lanes, .. }, front) = (*user, self.state(user).front());
        if category == Category::Obstacle {
            return;
        }
        if on_lanes {
            let (track, lines) = self.paths.track(user.index);
            return track.poses(lines, axis, carriage, distances, beyond, poses);
        }
        poses.push(Pose { distance: 0.0, front, axis });
        let distances = &distances[distances.partition_point(|distance| *distance <= 0.0)..];
        if self.options.path == PathModel::Arc && self.options.mode == Mode::Closecall {
            arc::poses(front, axis, self.turnings[user.index].curvature, carriage.length, distances, poses);
        } else {
            straight::poses(front, axis, distances, poses);
        }
    }
}
