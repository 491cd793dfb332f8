//! Who is where and how far each needs to stand; phase 1: which pairs may meet before they do.

use super::parts::{each, share};
use super::{Detector, LEVEL, Row, Work, Worker};
use crate::braking::stopping_distance;
use crate::frame::{Frame, ProfileIndex, Roster};
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

impl Row {
    /// Nobody's yet.
    const EMPTY: Self = Self {
        axis: Vector::new(1.0, 0.0),
        stop: 0.0,
        profile: ProfileIndex(0),
        category: Category::Obstacle,
        moves: false,
        ahead: true,
        on_lanes: false,
    };
}

const NOWHERE: Area = Area { bounds: Bounds::EMPTY, radius: 0.0 };

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
        self.turns(frame);
        self.work.rows += frame.len() as u64;
        self.unplaced.clear();
        if self.options.path == PathModel::Lanes {
            for row in 0..self.rows.len() {
                if !self.rows[row].ahead {
                    self.keep_on_path(frame, row);
                }
            }
        }
        &self.unplaced
    }

    /// Phase 1: which pairs may meet.
    pub fn approach(&mut self, frame: &Frame) {
        self.find_pairs(frame);
        for worker in &mut self.workers {
            self.work += std::mem::take(&mut worker.work);
        }
    }

    /// Every row's area and what else follows from its state alone.
    fn look(&mut self, frame: &Frame, roster: &Roster) {
        self.rows.resize(frame.len(), Row::EMPTY);
        self.areas.resize(frame.len(), NOWHERE);
        let straight_only = self.options.mode == Mode::Paper || self.options.path == PathModel::Straight;
        let by_lanes = !straight_only && self.options.path == PathModel::Lanes && self.net.is_some();
        let by_arcs = !straight_only && self.options.path == PathModel::Arc;
        let (leaves_out, epsilon) = (self.leaves_out, self.options.epsilon);
        let share = share(frame.len(), self.workers.len());
        let rows = self.rows.chunks_mut(share).zip(self.areas.chunks_mut(share));
        let parts = rows.zip(frame.users().chunks(share).zip(frame.states().chunks(share)));
        each(&mut self.workers, parts, |_, ((rows, areas), (users, states))| {
            for (((row, area), user), state) in rows.iter_mut().zip(areas).zip(users).zip(states) {
                let road_user = roster.user(*user);
                let profile = roster.profile_at(road_user.profile);
                row.axis = direction(state.heading);
                row.profile = road_user.profile;
                row.category = profile.category;
                row.moves = state.speed > STANDS;
                row.stop = if row.moves { stopping_distance(state.speed, &profile.brakes) } else { 0.0 };
                row.ahead = !(by_arcs || by_lanes && row.moves && row.category == Category::Vehicle);
                row.on_lanes = false;
                let front = Point::new(state.x, state.y);
                *area = if row.category == Category::Obstacle {
                    let mut bounds = Bounds::EMPTY;
                    road_user.shape.iter().for_each(|part| bounds.join(&part.bounds));
                    bounds.into()
                } else if row.ahead && leaves_out.ways_apart {
                    straight_ahead(profile, front, row.axis, row.stop + epsilon).into()
                } else {
                    circle(profile, front, row.axis, row.stop + epsilon).into()
                };
            }
        });
    }

    /// How the paths of now turn, where they are arcs.
    fn turns(&mut self, frame: &Frame) {
        if self.options.path != PathModel::Arc {
            return;
        }
        for (row, (user, state)) in self.rows.iter().zip(frame.users().iter().zip(frame.states())) {
            let (memory, front) = (&mut self.memory[user.0 as usize], Point::new(state.x, state.y));
            if let Some((last, last_axis)) = memory.last {
                memory.curvature = arc::curvature(turn(&last_axis, &row.axis), (front - last).norm());
            }
            memory.last = Some((front, row.axis));
        }
    }

    /// The pairs whose areas meet, but for those that are none; each worker keeps those that it found.
    fn find_pairs(&mut self, frame: &Frame) {
        for worker in &mut self.workers {
            worker.pairs.clear();
        }
        let rows = &self.rows[..];
        let count = frame.len() as u32;
        if !self.leaves_out.circles_apart {
            let worker = &mut self.workers[0];
            for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))) {
                if is_pair(rows, frame, a, b, &mut worker.work) {
                    worker.pairs.push((a, b));
                }
            }
            return;
        }
        self.search.prepare(&self.areas);
        let (search, areas) = (&self.search, &self.areas);
        let share = share(search.places(), self.workers.len());
        let parts = (0..search.places()).step_by(share).map(|start| start..(start + share).min(search.places()));
        each(&mut self.workers, parts, |worker, part| {
            let (pairs, work) = (&mut worker.pairs, &mut worker.work);
            search.sweep(part, |a, b| {
                if is_pair(rows, frame, a, b, work) {
                    pairs.push((a, b))
                }
            });
        });
        let Worker { pairs, work, .. } = &mut self.workers[0];
        search.compare_large(areas, |a, b| {
            if is_pair(rows, frame, a, b, work) {
                pairs.push((a, b))
            }
        });
        self.work.circles_apart += all_pairs(frame.len());
        self.work.circles_apart -= self.workers.iter().map(|worker| worker.work.pairs).sum::<u64>();
    }

    /// Follows a row's path along the lanes, or asks for its lane.
    fn keep_on_path(&mut self, frame: &Frame, row: usize) {
        let state = &frame.states()[row];
        let memory = &mut self.memory[frame.users()[row].0 as usize];
        self.rows[row].on_lanes = memory.path.follow(Point::new(state.x, state.y));
        if self.leaves_out.known_paths && !self.routes_may_change && self.rows[row].on_lanes {
            self.work.known_paths += 1;
        } else {
            self.unplaced.push(row as u32);
        }
    }
}

/// Whether two road users near each other are a pair at all.
fn is_pair(rows: &[Row], frame: &Frame, first: u32, second: u32, work: &mut Work) -> bool {
    let (a, b) = (&rows[first as usize], &rows[second as usize]);
    work.pairs += 1;
    if !a.moves && !b.moves {
        work.both_stand += 1;
        return false;
    }
    let (a_is, b_is) = (a.category, b.category);
    let heights = [first, second].map(|row| frame.states()[row as usize].z);
    if (heights[0] - heights[1]).abs() > LEVEL && a_is != Category::Obstacle && b_is != Category::Obstacle {
        work.other_level += 1;
        return false;
    }
    if a_is == Category::Person && b_is == Category::Person {
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
