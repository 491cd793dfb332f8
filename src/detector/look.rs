//! Who is where and how far each needs to stand; phase 1: which pairs may meet before they do.

use std::ops::Range;

use super::parts::{each, share};
use super::{Detector, LEVEL, User, Work};
use crate::braking::stopping_distance;
use crate::frame::{Frame, ProfileIndex, Roster, UserIndex};
use crate::geometry::rectangle::{Rectangle, direction};
use crate::geometry::sweep::TOLERANCE;
use crate::geometry::{Bounds, Point, Vector};
use crate::options::{Mode, PathModel};
use crate::path::{arc, turn};
use crate::precollision::{Area, Circle};
use crate::profile::{Category, Profile};
use crate::units::Metre;

/// What stands: slower than SUMO's own threshold for halting would be too coarse, so exactly 0.
const STANDS: f64 = 0.0;

impl Detector {
    /// Where everybody is now. Returns the frame's rows whose lane the detector has to know for both phases; the caller
    /// says it with [`Detector::place`], and leaves out whom it cannot place.
    ///
    /// A path that is laid in another step may be another one, within what counts as being on it: so everybody is
    /// followed, in a pair or not, and what phase 1 leaves out changes no path.
    pub fn follow(&mut self, frame: &Frame, roster: &Roster) -> &[u32] {
        if self.memory.len() < roster.len() {
            self.memory.resize(roster.len(), Default::default());
        }
        self.look(frame, roster);
        self.turns();
        self.work.rows += frame.len() as u64;
        self.unplaced.clear();
        if self.options.path == PathModel::Lanes {
            for row in 0..self.rows.len() {
                if !self.rows[row].ahead {
                    self.keep_on_path(row);
                }
            }
        }
        &self.unplaced
    }

    /// Phase 1: which pairs may meet.
    pub fn approach(&mut self) {
        self.search.prepare(&self.areas);
        self.users.clear();
        let (search, rows) = (&self.search, &self.rows);
        self.users.extend((0..rows.len() as u32).map(|place| rows[search.item(place) as usize]));
        self.find_pairs();
        for worker in &mut self.workers {
            self.work += std::mem::take(&mut worker.work);
        }
    }

    /// Everybody's area and what else follows from its state alone.
    fn look(&mut self, frame: &Frame, roster: &Roster) {
        let straight_only = self.options.mode == Mode::Paper || self.options.path == PathModel::Straight;
        let by_lanes = !straight_only && self.options.path == PathModel::Lanes && self.net.is_some();
        let by_arcs = !straight_only && self.options.path == PathModel::Arc;
        let (leaves_out, epsilon) = (self.leaves_out, self.options.epsilon);
        self.rows.resize(frame.len(), User::NOBODY);
        self.areas.resize(frame.len(), Area::NOWHERE);
        let share = share(frame.len(), self.workers.len());
        let rows = self.rows.chunks_mut(share).zip(self.areas.chunks_mut(share));
        let parts = (0..).step_by(share).zip(rows.zip(frame.users().chunks(share).zip(frame.states().chunks(share))));
        each(&mut self.workers, parts, |_, (first, ((rows, areas), (users, states)))| {
            let frame_rows = (first..).zip(users).zip(states);
            for ((now, area), ((row, &index), state)) in rows.iter_mut().zip(areas).zip(frame_rows) {
                let profile_index = roster.user(index).profile;
                let profile = roster.profile_at(profile_index);
                let moves = state.speed > STANDS;
                *now = User {
                    front: Point::new(state.x, state.y),
                    axis: direction(state.heading),
                    z: state.z,
                    speed: state.speed,
                    stop: if moves { stopping_distance(state.speed, &profile.brakes) } else { 0.0 },
                    row,
                    index,
                    profile: profile_index,
                    category: profile.category,
                    moves,
                    ahead: !(by_arcs || by_lanes && moves && profile.category == Category::Vehicle),
                    on_lanes: false,
                };
                let reach = now.stop + epsilon;
                *area = if now.category == Category::Obstacle {
                    let mut bounds = Bounds::EMPTY;
                    roster.user(index).shape.iter().for_each(|part| bounds.join(&part.bounds));
                    bounds.into()
                } else if now.ahead && leaves_out.ways_apart {
                    straight_ahead(profile, now.front, now.axis, reach).into()
                } else {
                    circle(profile, now.front, now.axis, reach).into()
                };
            }
        });
    }

    /// How the paths of now turn, where they are arcs.
    fn turns(&mut self) {
        if self.options.path != PathModel::Arc {
            return;
        }
        for user in &self.rows {
            let memory = &mut self.memory[user.index.0 as usize];
            if let Some((last, last_axis)) = memory.last {
                memory.curvature = arc::curvature(turn(&last_axis, &user.axis), (user.front - last).norm());
            }
            memory.last = Some((user.front, user.axis));
        }
    }

    /// The pairs whose areas meet, but for those that are none. Each worker keeps those that it found.
    fn find_pairs(&mut self) {
        let (search, users, all) = (&self.search, &self.users[..], !self.leaves_out.circles_apart);
        let share = share(users.len(), self.workers.len());
        for worker in &mut self.workers {
            worker.pairs.clear();
        }
        let parts = (0..users.len()).step_by(share).map(|start| start..(start + share).min(users.len()));
        each(&mut self.workers, parts, |worker, part| {
            let (pairs, work) = (&mut worker.pairs, &mut worker.work);
            let found = |a: u32, b: u32| {
                let (first, second) = (&users[a as usize], &users[b as usize]);
                if is_pair(first, second, work) {
                    pairs.push(if first.row < second.row { (a, b) } else { (b, a) });
                }
            };
            if all { every_pair(part, found) } else { search.sweep(part, found) }
        });
        self.work.circles_apart += all_pairs(users.len());
        self.work.circles_apart -= self.workers.iter().map(|worker| worker.work.pairs).sum::<u64>();
    }

    /// Follows a row's path along the lanes, or asks for its lane.
    fn keep_on_path(&mut self, row: usize) {
        let user = &mut self.rows[row];
        user.on_lanes = self.memory[user.index.0 as usize].path.follow(user.front);
        if self.leaves_out.known_paths && !self.routes_may_change && user.on_lanes {
            self.work.known_paths += 1;
        } else {
            self.unplaced.push(row as u32);
        }
    }
}

impl User {
    /// Nobody yet.
    const NOBODY: Self = Self {
        front: Point::new(0.0, 0.0),
        axis: Vector::new(1.0, 0.0),
        z: 0.0,
        speed: 0.0,
        stop: 0.0,
        row: 0,
        index: UserIndex(0),
        profile: ProfileIndex(0),
        category: Category::Obstacle,
        moves: false,
        ahead: true,
        on_lanes: false,
    };
}

/// Each of these places with all before it.
fn every_pair(places: Range<usize>, mut found: impl FnMut(u32, u32)) {
    for place in places {
        (0..place).for_each(|other| found(other as u32, place as u32));
    }
}

/// Whether two road users near each other are a pair at all.
fn is_pair(a: &User, b: &User, work: &mut Work) -> bool {
    work.pairs += 1;
    if !a.moves && !b.moves {
        work.both_stand += 1;
        return false;
    }
    if (a.z - b.z).abs() > LEVEL && a.category != Category::Obstacle && b.category != Category::Obstacle {
        work.other_level += 1;
        return false;
    }
    if a.category == Category::Person && b.category == Category::Person {
        work.both_persons += 1;
        return false;
    }
    true
}

/// How many pairs so many road users are.
fn all_pairs(count: usize) -> u64 {
    let count = count as u64;
    count * count.saturating_sub(1) / 2
}

/// The circle that holds all that a road user may cover within `reach` m of way.
fn circle(profile: &Profile, front: Point, axis: Vector, reach: Metre) -> Circle {
    let centre = front - axis * (profile.length / 2.0);
    let diagonal = (profile.length * profile.length + profile.width * profile.width).sqrt();
    Circle { x: centre.x, y: centre.y, radius: reach + diagonal / 2.0 }
}

/// The box that holds all that it covers within `reach` m straight ahead.
fn straight_ahead(profile: &Profile, front: Point, axis: Vector, reach: Metre) -> Bounds {
    let covered = Rectangle::behind(front + axis * reach, axis, profile.length + reach, profile.width);
    covered.bounds().grown(TOLERANCE)
}
