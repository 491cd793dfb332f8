//! Narrow phase, first half: whether a pair would meet, and where.

use std::hint::black_box;
use std::slice::from_ref;

use super::LEVEL;
use super::cover;
use super::encounters::{How, Roles};
use super::occupancy::{Carriages, OccupancyCache};
use super::overlap::Overlap;
use super::reach::{Motion, User};
use super::step::StepInputs;
use super::work_counts::Work;
use super::worker::{Findings, Worker};
use crate::braking::{self, Braking, MuModel};
use crate::detection::narrow_phase::{self, Approach, ConflictPoint, Ego, Participant, side};
use crate::geometry::movement::{FINE, TOLERANCE};
use crate::geometry::{contact, cross};
use crate::options::Mode;
use crate::traffic::frame::State;
use crate::traffic::profile::Category;
use crate::util::units::Metre;

/// Pairs prefetched before the first of them is tested, so that their cache misses overlap. Without it the narrow phase
/// takes nearly twice as long in a jam of 10⁵ road users.
const BLOCK: usize = 32;

/// Two of which neither is further ahead than this are side by side, or mirror images, in m: rounding.
const ALIKE: Metre = 1e-9;

/// What is known of a pair that has to be swept.
#[derive(Clone, Copy)]
pub(super) struct Unsettled {
    /// Whether both drive in line.
    in_line: bool,
    overlap: Overlap,
}

impl Unsettled {
    /// The carriages of one of the two as they are swept.
    fn all_shrunk<'a>(&self, carriages: Carriages<'a>) -> Carriages<'a> {
        carriages.into_iter().map(|carriage| carriage.shrunk(self.overlap.shrinks)).collect()
    }

    /// The two as they are swept.
    pub(super) fn shrunk<'a>(&self, pair: [Participant<'a>; 2]) -> [Participant<'a>; 2] {
        if self.overlap.shrinks > 0.0 { pair.map(|of| of.shrunk(self.overlap.shrinks)) } else { pair }
    }
}

/// Whether two road users can be a pair at all. A road user without a known previous position is skipped. Two that stand are a
/// pair only in the step in which one of them stops: what it ran into on its last metre is a collision.
fn is_pair([(a, a_state), (b, b_state)]: [(&User, &State); 2], mode: Mode, work: &mut Work) -> bool {
    if [a, b].into_iter().any(|user| user.motion == Motion::Appears) {
        work.not_there_yet += 1;
        return false;
    }
    let has_stopped = [a, b].into_iter().any(|user| user.motion == Motion::HasStopped) && mode == Mode::Closecall;
    if !a_state.moves() && !b_state.moves() && !has_stopped {
        work.both_stand += 1;
        return false;
    }
    if (a_state.z - b_state.z).abs() > LEVEL && a.category != Category::Obstacle && b.category != Category::Obstacle {
        work.other_level += 1;
        return false;
    }
    if a.category == Category::Person && b.category == Category::Person {
        work.both_persons += 1;
        return false;
    }
    true
}

impl StepInputs<'_> {
    /// Finds which of these pairs would meet, `most` of them and those of the same block.
    pub(super) fn meet_all(&self, worker: &mut Worker, pairs: &[(u32, u32)], most: usize) {
        let Worker { work, occupancy, further: further_occupancy, found, .. } = worker;
        let further = self.further();
        for block in pairs.chunks(BLOCK) {
            if found.encounters.len() > most {
                return;
            }
            self.fetch(block);
            for &(a, b) in block {
                let users = [a, b].map(|slot| self.user(slot));
                if !is_pair(users.map(|user| (user, self.state(user))), self.options.mode, work) {
                    continue;
                }
                let slots = if self.comes_first(users) { [a, b] } else { [b, a] };
                match self.options.mode {
                    Mode::Closecall => {
                        found.meets = false;
                        let before = *work;
                        self.meet(occupancy, work, slots, found);
                        if let (Some(further), false) = (&further, found.meets) {
                            // A pair counts once.
                            *work = before;
                            further.meet(further_occupancy, work, slots, found);
                        }
                    }
                    Mode::Paper => self.meet_on_paper(work, slots, found),
                }
            }
        }
    }

    /// Prefetches the slots of these pairs, then their rows of the frame. `black_box` keeps the compiler from removing
    /// reads whose values are not used.
    fn fetch(&self, pairs: &[(u32, u32)]) {
        let mut rows = [0; 2 * BLOCK];
        for (rows, &(a, b)) in rows.chunks_exact_mut(2).zip(pairs) {
            rows[0] = black_box(self.user(a)).row;
            rows[1] = black_box(self.user(b)).row;
        }
        for row in &rows[..2 * pairs.len()] {
            let state = self.frame.state(*row);
            black_box((state.x, state.speed));
        }
    }

    fn meet(&self, occupancy: &mut OccupancyCache, work: &mut Work, slots: [u32; 2], found: &mut Findings) {
        let [a, b] = slots;
        let both_ahead = self.user(a).ahead && self.user(b).ahead;
        // The broad phase has already compared the boxes of two road users that can only go straight on.
        let is_known = self.areas_are_compared() && both_ahead;
        let only_margins = self.conflicts_only && self.options.log.is_default();
        if is_known && self.shortcuts.in_line && only_margins && self.keeps_distance(slots) {
            work.in_line += 1;
            return;
        }
        if self.go_straight(slots) {
            return self.meet_straight(work, slots, found);
        }
        slots.iter().for_each(|slot| occupancy.see(self, *slot));
        if self.shortcuts.paths_apart && !is_known && !occupancy.bounds(self, a).meet(&occupancy.bounds(self, b)) {
            work.paths_apart += 1;
            return;
        }
        // The narrow boxes of a road user that turns: the sweep needs them anyway.
        if !both_ahead && self.are_apart(occupancy, work, slots) {
            return;
        }
        if slots.iter().any(|slot| self.user(*slot).bends) {
            return self.meet_bent(occupancy, work, slots, found);
        }
        // An obstacle is never the ego.
        let slots = if self.is_obstacle(a) { [b, a] } else { slots };
        let pair = slots.map(|slot| occupancy.mover(self, slot));
        let Some(unsettled) = self.settle(work, slots, &pair, found) else { return };
        if both_ahead && self.are_apart(occupancy, work, slots) {
            return;
        }
        let pair = unsettled.shrunk(slots.map(|slot| occupancy.covered(self, slot)));
        self.sweep(work, slots, &pair, unsettled, found);
    }

    /// Settles a pair that collides now or drives in line. Returns what is known of any other pair.
    pub(super) fn settle(
        &self,
        work: &mut Work,
        slots: [u32; 2],
        pair: &[Participant; 2],
        found: &mut Findings,
    ) -> Option<Unsettled> {
        let overlap = self.overlap(slots, pair);
        if overlap.collision {
            self.collide(work, slots, pair, overlap, found);
            return None;
        }
        let unsettled = Unsettled { in_line: narrow_phase::drive_in_line(&pair[0], &pair[1]), overlap };
        if !unsettled.in_line || !self.shortcuts.in_line {
            return Some(unsettled);
        }
        let [first, second] = &unsettled.shrunk(*pair);
        work.in_line += 1;
        work.frontal += u64::from(narrow_phase::drive_opposed(first, second));
        let approach = narrow_phase::meet_in_one_dimension(first, second);
        if let Some(approach) = approach {
            let roles = Roles::new(approach.ego, slots, [first, second]);
            self.met(work, found, &roles, &approach.conflict_point, overlap);
        }
        None
    }

    /// Adds a pair that collides now.
    fn collide(
        &self,
        work: &mut Work,
        slots: [u32; 2],
        [first, second]: &[Participant; 2],
        overlap: Overlap,
        found: &mut Findings,
    ) {
        let ego = if second.shape.is_empty() { Ego::of_equals([first, second]) } else { Ego::First };
        let roles = Roles::new(ego, slots, [first, second]);
        let conflict_point = ConflictPoint {
            ego_distance: 0.0,
            foe_distance: 0.0,
            ego_rectangle: roles.ego.rectangle,
            ego_behind: roles.ego.carriage.behind,
            foe_axis: roles.foe.shape.is_empty().then_some(roles.foe.rectangle.axis),
            foe_leads: true,
        };
        self.met(work, found, &roles, &conflict_point, overlap);
    }

    /// Finds where a pair meets of which one or both bend: any carriage of the one may touch any of the other.
    fn meet_bent(&self, occupancy: &mut OccupancyCache, work: &mut Work, slots: [u32; 2], found: &mut Findings) {
        let slots = if self.is_obstacle(slots[0]) { [slots[1], slots[0]] } else { slots };
        slots.iter().for_each(|slot| occupancy.cover(self, *slot));
        let [first, second] = slots.map(|slot| occupancy.carriages(self, slot));
        let pairs = first.iter().flat_map(|a| second.iter().map(move |b| [*a, *b]));
        let overlaps = pairs.map(|pair| (self.overlap(slots, &pair), pair));
        let deepest = overlaps.reduce(|deepest, next| if next.0.depth > deepest.0.depth { next } else { deepest });
        let Some((overlap, pair)) = deepest else { return };
        if overlap.collision {
            return self.collide(work, slots, &pair, overlap, found);
        }
        work.swept += 1;
        let unsettled = Unsettled { in_line: false, overlap };
        let [first, second] = [first, second].map(|carriages| unsettled.all_shrunk(carriages));
        let approach = self.swept(slots, [&first, &second], found);
        if let (Some(approach), [first, ..], [second, ..]) = (approach, &first[..], &second[..]) {
            let roles = Roles::new(approach.ego, slots, [first, second]);
            self.met(work, found, &roles, &approach.conflict_point, overlap);
        }
    }

    /// Finds where two covered paths meet. If both drive in line, one dimension decides even so: it is exact to rounding, the
    /// sweep to its tolerance.
    pub(super) fn sweep(
        &self,
        work: &mut Work,
        slots: [u32; 2],
        [first, second]: &[Participant; 2],
        Unsettled { in_line, overlap }: Unsettled,
        found: &mut Findings,
    ) {
        work.swept += 1;
        let swept = self.swept(slots, [from_ref(first), from_ref(second)], found);
        let approach = if in_line { narrow_phase::meet_in_one_dimension(first, second) } else { swept };
        if let Some(approach) = approach {
            let roles = Roles::new(approach.ego, slots, [first, second]);
            self.met(work, found, &roles, &approach.conflict_point, overlap);
        }
    }

    /// How a pair meets: swept coarsely, and finely if that finds a conflict.
    fn swept(&self, slots: [u32; 2], [a, b]: [&[Participant]; 2], found: &mut Findings) -> Option<Approach> {
        let halves = &mut found.scratch.halves;
        let coarse = side::meet(halves, a, b)?;
        let roles = Roles::new(coarse.ego, slots, [a.first()?, b.first()?]);
        let point = &coarse.conflict_point;
        let sigma = narrow_phase::sigma(point.angle());
        let gap = narrow_phase::gap(point.ego_distance, point.foe_distance, sigma);
        let mu = narrow_phase::mu(self.mu_model(), roles.ego, roles.foe, sigma, self.options.epsilon);
        if gap >= mu && !(point.foe_leaves(sigma) && self.may_leave_late(&roles, point, sigma, mu)) {
            return Some(coarse);
        }
        side::refine(halves, FINE, a, b)
    }

    /// Whether the first of the two is the first of the pair, so that neither ids nor the order of the rows decide anything:
    /// the faster one, then the one behind, then the longer and the wider one. The order decides only between mirror images.
    fn comes_first(&self, [a, b]: [&User; 2]) -> bool {
        let (of_a, of_b) = (self.state(a), self.state(b));
        if of_a.speed != of_b.speed {
            return of_a.speed > of_b.speed;
        }
        let along = (of_b.front() - of_a.front()).dot(&(a.axis + b.axis));
        if along.abs() > ALIKE {
            return along > 0.0;
        }
        let size = |user| [self.profile(user).length, self.profile(user).width];
        (size(a), b.row) > (size(b), a.row)
    }

    /// Whether two road users that go straight on in the same direction surely pass beside each other, or one follows the
    /// other at a safe distance. Most pairs do; they are settled before paths are built. Within the tolerance: `false`.
    #[inline(always)]
    fn keeps_distance(&self, slots: [u32; 2]) -> bool {
        let [a, b] = slots.map(|slot| self.user(slot));
        let (of_a, of_b) = (self.profile(a), self.profile(b));
        let lead_alike = |lengths| narrow_phase::are_parallel([&a.axis, &b.axis], lengths);
        // Most pairs that cross do not, however far they go.
        if !lead_alike([of_a.length, of_b.length])
            || a.axis.dot(&b.axis) <= 0.0
            || slots.iter().any(|slot| self.is_obstacle(*slot))
        {
            return false;
        }
        let (state_a, state_b) = (self.state(a), self.state(b));
        let stops = [cover::stop(state_a, of_a), cover::stop(state_b, of_b)];
        if !lead_alike([stops[0] + of_a.length, stops[1] + of_b.length]) {
            return false;
        }
        let between = state_b.front() - state_a.front();
        if cross(&a.axis, &between).abs() > (of_a.width + of_b.width) / 2.0 + TOLERANCE {
            return true;
        }
        let along = between.dot(&a.axis);
        let a = Braking { speed: state_a.speed, brakes: &of_a.brakes };
        let b = Braking { speed: state_b.speed, brakes: &of_b.brakes };
        let is_behind = 2.0 * along > of_b.length - of_a.length;
        let (ahead, stop, ego, foe) = match is_behind {
            true => (along - of_b.length, stops[0], a, b),
            false => (-along - of_a.length, stops[1], b, a),
        };
        let enough = |needed: Metre| ahead > needed.max(0.0) + TOLERANCE;
        let epsilon = self.options.epsilon;
        let model = self.mu_model();
        let stops = model != MuModel::Rss && enough(stop + epsilon);
        stops || enough(braking::mu(model, ego, foe, 1.0, epsilon))
    }

    /// Whether the narrow boxes around both paths are apart.
    fn are_apart(&self, occupancy: &mut OccupancyCache, work: &mut Work, slots: [u32; 2]) -> bool {
        slots.iter().for_each(|slot| occupancy.cover(self, *slot));
        let apart = occupancy.are_apart(self, slots);
        work.paths_apart += u64::from(apart);
        apart
    }

    fn meet_on_paper(&self, work: &mut Work, slots: [u32; 2], found: &mut Findings) {
        if slots.iter().any(|slot| self.is_obstacle(*slot)) {
            return;
        }
        // The paper's flow chart determines the kind first, so no test is left out.
        work.frontal += 1;
        work.side += 1;
        let (first, second) = (self.mover(slots[0]), self.mover(slots[1]));
        let measured = narrow_phase::paper_mode::measure(&first, &second, self.options.kind_bounds());
        let roles = Roles::new(measured.approach.ego, slots, [&first, &second]);
        let (ego, foe) = (roles.ego, roles.foe);
        let between = (foe.rectangle.centre - ego.rectangle.centre).norm();
        let radius = braking::stopping_distance_paper(ego.speed, ego.brakes) + self.options.epsilon;
        // Eq. 4: the ego's detection radius reaches the foe's front.
        if between - foe.rectangle.half_length > radius || !measured.distance.is_finite() {
            return;
        }
        let depth = contact::overlap(&ego.rectangle, &foe.rectangle);
        let overlap = Overlap { depth, collision: contact::touches(&ego.rectangle, &foe.rectangle), shrinks: 0.0 };
        let conflict_point = measured.approach.conflict_point;
        let angle = conflict_point.angle();
        let how = How { kind: measured.kind, angle, sigma: angle.cos(), gap: measured.distance, overlap };
        self.add(work, found, &roles, &conflict_point, how);
    }
}
