//! Where the road users of a step will go: their poses, and the boxes around what they cover on the way. Laid when
//! somebody asks, then kept until the step ends.

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

/// Hardly a way has more poses; the table of all grows by doubling where one has.
pub(super) const MOST_POSES: usize = 64;

/// A straight way has poses where it begins, where it stands and ε further.
const MOST_STRAIGHT: usize = 3;

/// How many ways are kept: this many times the square root of the road users in the step. The search comes back to
/// somebody after about one of its strips, and about the root of all stand in a strip.
const KEPT: f64 = 0.5;

/// No fewer are kept. With half as many, phase 2 would take 7 % more time on SUMO's A10.
const KEPT_AT_LEAST: usize = 32;

/// So many poses has a way, on average.
const POSES: usize = 12;

/// The ways of a step that were asked for last. Those of everybody took a quarter of the memory that a run holds per road
/// user; whose way is asked for after it was forgotten has it laid again, and it is the same.
#[derive(Default)]
pub(super) struct OccupancyCache {
    /// By slot, where its way is, if it is kept: among the newer or the older ones.
    places: Vec<u16>,
    /// So many newer ones make the older ones be forgotten.
    most: usize,
    /// The generations, the newer first.
    kept: [Kept; 2],
}

/// OccupancyCache that were laid one after the other.
struct Kept {
    laid: Vec<Laid>,
    poses: Vec<Pose>,
    covers: Vec<SweptBounds>,
}

impl Default for Kept {
    /// With the memory for the least that is kept, so that it does not grow with what is looked at.
    fn default() -> Self {
        let poses = KEPT_AT_LEAST * POSES + MOST_POSES;
        Self {
            // That of a pair's second road user may come on top.
            laid: Vec::with_capacity(KEPT_AT_LEAST + 1),
            poses: Vec::with_capacity(poses),
            covers: Vec::with_capacity(poses),
        }
    }
}

/// The way of who is in a slot.
#[derive(Clone, Copy)]
struct Laid {
    slot: u32,
    poses: (u32, u32),
    /// Where its covers begin, that of the whole way and those from pose to pose; none as long as nobody asked.
    covers: Option<u32>,
    straight: bool,
    /// The box around all that it covers on the way.
    bounds: Bounds,
}

impl Kept {
    fn clear(&mut self) {
        self.laid.clear();
        self.poses.clear();
        self.covers.clear();
    }

    fn find(&self, slot: u32, place: u16) -> Option<&Laid> {
        self.laid.get(place as usize).filter(|laid| laid.slot == slot)
    }
}

impl OccupancyCache {
    /// Forgets those of the last step; slots below `slots` may be asked for.
    pub(super) fn begin(&mut self, slots: usize) {
        self.places.resize(slots, 0);
        let most = ((slots as f64).sqrt() * KEPT) as usize;
        self.most = most.clamp(KEPT_AT_LEAST, usize::from(u16::MAX) - 1);
        self.kept.iter_mut().for_each(Kept::clear);
    }

    /// Forgets the older ones if there are enough newer ones. The ways of a pair are laid and looked at between two
    /// calls.
    pub(super) fn begin_pair(&mut self) {
        let [newer, older] = &mut self.kept;
        if newer.laid.len() >= self.most {
            std::mem::swap(newer, older);
            newer.clear();
        }
    }

    /// Lays the poses until it stands and ε further, unless it can only go straight on: then phase 1 has said where it
    /// will be.
    pub(super) fn see(&mut self, scene: &StepInputs, slot: u32) {
        if !scene.user(slot).ahead {
            self.lay(scene, slot);
        }
    }

    fn lay(&mut self, scene: &StepInputs, slot: u32) {
        if self.find(slot).is_some() {
            return;
        }
        let user = scene.user(slot);
        let Kept { laid, poses: all, .. } = &mut self.kept[0];
        let (profile, start) = (scene.profile(user), all.len());
        let stop = scene.stop(user);
        scene.course(user, &[stop, stop + scene.options.epsilon], false, all);
        let poses = &all[start..];
        let axis = poses.first().map_or(user.axis, |pose| pose.axis);
        let straight = poses.iter().all(|pose| pose.axis == axis);
        let bounds = if !scene.shortcuts.paths_apart {
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
        self.places[slot as usize] = laid.len() as u16;
        let way = Laid { slot, poses: (start as u32, all.len() as u32), covers: None, straight, bounds };
        laid.push(way);
    }

    /// Lays the poses and the boxes around them.
    pub(super) fn cover(&mut self, scene: &StepInputs, slot: u32) {
        self.lay(scene, slot);
        let place = self.places[slot as usize];
        let Some(Kept { laid, poses, covers }) = self.kept.iter_mut().find(|kept| kept.find(slot, place).is_some())
        else {
            return;
        };
        let laid = &mut laid[place as usize];
        if laid.covers.is_some() {
            return;
        }
        laid.covers = Some(covers.len() as u32);
        let profile = scene.profile(scene.user(slot));
        let poses = &poses[laid.poses.0 as usize..laid.poses.1 as usize];
        let of = |poses: &[Pose]| match scene.shortcuts.paths_apart {
            true => SweptBounds::of(poses, profile.length, profile.width).unwrap_or_else(|| laid.bounds.into()),
            false => SweptBounds::EVERYWHERE,
        };
        let whole = match poses {
            [first, .., last] if laid.straight && poses.len() <= MOST_STRAIGHT && scene.shortcuts.paths_apart => {
                SweptBounds::straight(first, last, profile.length, profile.width, laid.bounds)
            }
            _ => of(poses),
        };
        covers.push(whole);
        if !laid.straight {
            covers.extend(poses.windows(2).map(of));
        }
    }

    /// The box around all that it covers on its way.
    pub(super) fn bounds(&self, scene: &StepInputs, slot: u32) -> Bounds {
        match self.find(slot) {
            Some((_, laid)) => laid.bounds,
            None => scene.reach.area(scene.user(slot)).bounds,
        }
    }

    /// The boxes around all that it covers on its way, if that was covered.
    pub(super) fn cover_of(&self, slot: u32) -> &SweptBounds {
        let found = self.find(slot).and_then(|(kept, laid)| kept.covers.get(laid.covers? as usize));
        found.unwrap_or(&SweptBounds::EVERYWHERE)
    }

    /// Who is in a slot, with its way if that is not simply ahead.
    pub(super) fn mover<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Participant<'a> {
        if scene.user(slot).ahead { scene.mover(slot) } else { self.covered(scene, slot) }
    }

    /// Who is in a slot whose way was covered.
    pub(super) fn covered<'a>(&'a self, scene: &StepInputs<'a>, slot: u32) -> Participant<'a> {
        let mut mover = scene.mover(slot);
        if let Some((kept, laid)) = self.find(slot) {
            mover.poses = &kept.poses[laid.poses.0 as usize..laid.poses.1 as usize];
            mover.straight = laid.straight;
            mover.reach = mover.poses.last().map_or(0.0, |pose| pose.way);
            if let Some(start) = laid.covers {
                let steps = if laid.straight { 0 } else { mover.poses.len().saturating_sub(1) };
                mover.cover = &kept.covers[start as usize];
                mover.covers = &kept.covers[start as usize + 1..][..steps];
            }
        }
        mover
    }

    fn find(&self, slot: u32) -> Option<(&Kept, &Laid)> {
        let place = self.places[slot as usize];
        self.kept.iter().find_map(|kept| kept.find(slot, place).map(|laid| (kept, laid)))
    }
}

impl<'a> StepInputs<'a> {
    /// Who is in a slot, without its way.
    pub(super) fn mover(&self, slot: u32) -> Participant<'a> {
        let user = self.user(slot);
        let (profile, state) = (self.roster.profile_at(user.profile), self.state(user));
        let stop = self.stop(user);
        let mut mover = Participant {
            rectangle: Rectangle::behind(state.front(), user.axis, profile.length, profile.width),
            shape: &[],
            poses: &[],
            straight: true,
            reach: stop + self.options.epsilon,
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

    /// Adds a road user's poses at the given ways, and between, as far as its path is known; `beyond` that straight on.
    pub(super) fn course(&self, user: &User, ways: &[Metre], beyond: bool, poses: &mut Vec<Pose>) {
        let (User { axis, category, on_lanes, .. }, front) = (*user, self.state(user).front());
        if category == Category::Obstacle {
            return;
        }
        let chord = || self.profile(user).chord;
        if on_lanes {
            let (track, lines) = self.paths.track(user.index);
            return track.poses(lines, axis, chord(), ways, beyond, poses);
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
