//! Narrow phase, second half: the gap of a pair whose foe first has to arrive and leave, and the measures of a pair in
//! conflict.

use super::chances::{CHANCES, Chance, Chances};
use super::cover;
use super::occupancy::Carriages;
use super::overlap::shrinks;
use super::reach::User;
use super::step::StepInputs;
use super::timely::Timely;
use super::worker::{Findings, Met, Scratch, Worker};
use crate::braking::{self, LateBraking, Leader, MuModel, rss};
use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::kind::Kind;
use crate::detection::measures;
use crate::detection::measures::accident::BRAKES;
use crate::detection::measures::drac;
use crate::detection::measures::injury::{Body, injury_probability};
use crate::detection::measures::table::LoggedMeasure;
use crate::detection::measures::ttb::{self, Evasion};
use crate::detection::measures::ttc::{self, SteadyMotion};
use crate::detection::narrow_phase::{self, ConflictPoint, Participant, side};
use crate::detection::path::Pose;
use crate::detection::severity::{Assessment, SeverityInputs, depends_on};
use crate::detection::step_values::StepValues;
use crate::geometry::{contact, polygon};
use crate::options::Mode;
use crate::traffic::profile::Category;
use crate::util::units::{Metre, MetrePerSecondSquared, Second};

impl StepInputs<'_> {
    /// How far ahead a road user's path has to be known to measure a pair that it is in.
    pub(super) fn distance_to_measure(&self, user: &User, meeting: &ConflictPoint) -> Metre {
        (self.state(user).speed * ttc::HORIZON).max(self.furthest_exit(user, meeting))
    }

    /// Measures the pairs that a worker could not measure at once.
    pub(super) fn measure_all(&self, worker: &mut Worker) {
        let Findings { encounters, unmeasured, scratch, chances, .. } = &mut worker.found;
        for (index, met) in unmeasured {
            self.as_met(met.further).measure(scratch, chances, met, &mut encounters[*index as usize]);
        }
    }

    /// Completes the encounter of a pair that would meet: the ego and its foe.
    pub(super) fn measure(&self, scratch: &mut Scratch, chances: &mut Chances, met: &Met, encounter: &mut Encounter) {
        let pair = met.slots.map(|slot| {
            let carriages = self.movers(slot).into_iter();
            carriages.map(|carriage| carriage.shrunk(met.shrinks)).collect::<Carriages>()
        });
        if met.leaves {
            encounter.foe_distance = self.exit_distance(scratch, &pair[1], met);
            if self.options.mode == Mode::Closecall {
                let gap = narrow_phase::gap(encounter.ego_distance, encounter.foe_distance, met.sigma);
                encounter.gap = self.gap_beyond(gap, encounter.mu, met.slots, &met.meeting);
                encounter.margin = encounter.gap - encounter.mu;
            }
        }
        if self.measures(encounter) {
            encounter.nearness = Some(self.nearness(scratch, chances, &pair, met, encounter));
            encounter.pet_below = self.pet_below(chances, met.slots, encounter);
        }
    }

    /// Whether a pair that would meet is measured: if it is in conflict, or the log asks for more than that.
    pub(super) fn measures(&self, encounter: &Encounter) -> bool {
        encounter.in_conflict() || !self.options.log.is_default()
    }

    /// The PET that its event has to be below so that the step is logged. A collision always is.
    fn pet_below(&self, chances: &Chances, slots: [u32; 2], encounter: &Encounter) -> Second {
        if encounter.collision || (self.options.log.is_default() && encounter.in_conflict()) {
            return Second::INFINITY;
        }
        let users = slots.map(|slot| self.user(slot));
        let values = StepValues {
            found: encounter,
            speeds: users.map(|user| self.state(user).speed),
            types: users.map(|user| self.profile(user)),
            crash_probability: &|nearness, measure| chances.of(nearness, measure, self.roster),
        };
        let may_have_pet = encounter.may_cross() && !self.is_obstacle(slots[1]);
        self.options.log.pet_below(&|measure| values.of(measure), may_have_pet)
    }

    /// The gap of a pair. If it meets only beyond where both stand, its margin is at least the distance by which one would have
    /// to go on; its gap is increased accordingly.
    pub(super) fn gap_beyond(&self, gap: Metre, mu: Metre, slots: [u32; 2], meeting: &ConflictPoint) -> Metre {
        if !self.is_further() {
            return gap;
        }
        let [ego, foe] = slots.map(|slot| self.user(slot));
        let reserve = if self.state(ego).moves() { self.options.epsilon } else { 0.0 };
        let ego_beyond = meeting.ego_distance - self.model_stop(ego) - reserve;
        let foe_beyond = meeting.foe_distance - self.model_stop(foe);
        let beyond = ego_beyond.max(foe_beyond);
        // RSS has them stand further than their brakes do.
        if self.mu_model() == MuModel::Rss && beyond <= 0.0 { gap } else { gap.max(mu + beyond.max(0.0)) }
    }

    /// The distance until a road user stands that brakes as the model of μ has it.
    fn model_stop(&self, user: &User) -> Metre {
        let state = self.state(user);
        match self.mu_model() {
            MuModel::Rss if state.moves() => rss::stopping_distance(state.speed),
            _ => cover::stop(state, self.profile(user)),
        }
    }

    /// Whether a foe that brakes fully now stands before it gets to the conflict point.
    fn stops_before(&self, met: &Met) -> bool {
        let foe = self.user(met.slots[1]);
        met.further && met.meeting.foe_distance > cover::stop(self.state(foe), self.profile(foe))
    }

    /// A distance along the path at which the foe has surely left the conflict point.
    pub(super) fn furthest_exit(&self, foe: &User, meeting: &ConflictPoint) -> Metre {
        let profile = self.profile(foe);
        let rectangle = &meeting.ego_rectangle;
        // The foe has left when its rear has passed the ego's whole rectangle, however that is turned.
        let passed = self.drawn_length(foe) + 2.0 * (rectangle.half_length + rectangle.half_width) + profile.width;
        meeting.foe_distance + passed / self.paths.scale(foe.index)
    }

    /// The foe's distance until it, and so each of its carriages, has left the ego's conflict point.
    fn exit_distance(&self, scratch: &mut Scratch, foe: &[Participant], met: &Met) -> Metre {
        let (poses, user, meeting) = (&mut scratch.courses[1], self.user(met.slots[1]), &met.meeting);
        let rectangle = &meeting.ego_rectangle;
        let left = foe.iter().filter_map(|carriage| {
            poses.clear();
            self.course(user, carriage.carriage, &[self.furthest_exit(user, meeting)], true, poses);
            match foe {
                [_] => Some(side::departure(&mut scratch.halves, poses, carriage, rectangle, meeting.foe_distance)),
                _ => side::carriage_departure(&mut scratch.halves, poses, carriage, rectangle),
            }
        });
        left.fold(meeting.foe_distance, f64::max)
    }

    fn nearness(
        &self,
        scratch: &mut Scratch,
        chances: &mut Chances,
        pair: &[Carriages; 2],
        met: &Met,
        encounter: &Encounter,
    ) -> Nearness {
        let clearance = |[ego, foe]: [&Participant; 2]| match foe.shape {
            [] => contact::room(&ego.rectangle, &foe.rectangle),
            shape => polygon::distance(shape, &ego.rectangle),
        };
        let clearance = if encounter.overlap > 0.0 || encounter.collision {
            0.0
        } else {
            pairs(pair).map(clearance).fold(f64::INFINITY, f64::min)
        };
        let timely = if encounter.collision {
            Timely::of_collision()
        } else {
            self.timely(scratch, chances, pair, met, encounter)
        };
        let each = [timely.chance, self.chance_braking([&pair[0][0], &pair[1][0]], met, encounter)];
        let (mut values, mut crash_at_most, mut left_out) = (timely.values, [0.0; 2], 0);
        for (which, (measure, chance)) in CHANCES.into_iter().zip(&each).enumerate() {
            let [least, most] = chances.bounds(chance, self.roster);
            // Only the first decides a severity.
            let decides = which == 0 && depends_on(self.options.severity_thresholds(), [least, most]);
            let value = match () {
                () if least == most => Some(most),
                () if decides || !self.shortcuts.known_chances => Some(chances.value(chance, self.roster)),
                () => None,
            };
            values = values.with(measure, value);
            crash_at_most[which] = value.unwrap_or(most);
            left_out += usize::from(value.is_none());
        }
        let (ttc, drac) = (values.ttc(), values.drac());
        let [ego, foe] = [&pair[0][0], &pair[1][0]];
        let (ego_deceleration, collision) = (ego.brakes.deceleration, encounter.collision);
        let unavoidable = drac.is_some_and(|drac| drac > ego_deceleration.max(drac::LIMIT));
        let users = met.slots.map(|slot| self.user(slot));
        let types = users.map(|user| self.profile(user));
        let movements = [0, 1].map(|one| (self.state(users[one]).speed, types[one].mass));
        let [of_ego, of_foe] = measures::delta_v(movements[0], movements[1], encounter.angle);
        let inputs = SeverityInputs {
            ttc,
            drac,
            ego_deceleration,
            ttb: values.ttb(),
            // Where it is not worked out, its bound decides the same.
            crash_probability: crash_at_most[0],
            braking: self.evasive_braking(users, encounter.kind),
            delta_v: of_ego.max(of_foe),
            injury_probability: injury_probability(
                encounter.kind,
                Body::of(types[0], of_ego),
                Body::of(types[1], of_foe),
            ),
            collision,
        };
        let extended_delta_v =
            ttc.map(|left| measures::extended_delta_v(movements[0], movements[1], encounter.angle, left));
        let values = values
            .with(LoggedMeasure::Drac, drac.map(|drac| drac.min(drac::LIMIT)))
            .with(LoggedMeasure::ResponseLeft, self.response_left([ego, foe], met, encounter))
            .with(LoggedMeasure::ExtendedDeltaV, extended_delta_v);
        Nearness {
            clearance,
            values,
            crash_at_most,
            chances: chances.add(each, left_out),
            unavoidable,
            assessment: Assessment::of(&inputs, self.options.severity_thresholds()),
        }
    }

    /// How hard the road user brakes that can avoid the collision: the ego, or either where paths cross. A person stops at
    /// once: not a sign of danger.
    fn evasive_braking(&self, [ego, foe]: [&User; 2], kind: Kind) -> MetrePerSecondSquared {
        let of = |user: &User| if user.category == Category::Vehicle { self.deceleration(user) } else { 0.0 };
        if kind == Kind::RearEnd { of(ego) } else { of(ego).max(of(foe)) }
    }

    /// The ego's longest response time with which μ still fits into the gap; none if the ego stands, or if a foe that brakes
    /// now is never in the way. It is below the ego's response time exactly if the margin is below 0.
    fn response_left(&self, [ego, foe]: [&Participant; 2], met: &Met, encounter: &Encounter) -> Option<Second> {
        if ego.speed == 0.0 {
            return None;
        }
        if encounter.collision {
            return Some(0.0);
        }
        if met.further && met.meeting.foe_distance > self.model_stop(self.user(met.slots[1])) {
            return None;
        }
        let (model, epsilon) = (self.mu_model(), self.options.epsilon);
        let left = braking::response_left(model, ego.braking(), foe.braking(), met.sigma, epsilon, encounter.gap);
        let response = if model == MuModel::Rss { rss::RESPONSE } else { ego.brakes.response };
        let left = if encounter.margin < 0.0 { left.min(response.next_down()).max(0.0) } else { left.max(response) };
        Some(left).filter(|left| left.is_finite())
    }

    /// The chance that the ego's driver does not brake in time for contact, if the foe brakes fully now. As in μ and
    /// [`Self::response_left`], the ego keeps its speed until its driver responds, and a foe for σ ≤ 0 responds as always.
    fn chance_braking(&self, [ego, foe]: [&Participant; 2], met: &Met, encounter: &Encounter) -> Chance {
        if encounter.collision {
            return Chance::Known(1.0);
        }
        if self.stops_before(met) {
            return Chance::Known(0.0);
        }
        let leader = braking::leader(foe.braking(), met.sigma, encounter.gap);
        let braking = self.late_braking(met.slots[0], ego);
        let has_responded = braking.present >= BRAKES;
        let braking = LateBraking { present: if has_responded { braking.present } else { 0.0 }, ..braking };
        let driver = self.user(met.slots[0]).profile;
        Chance::Of { driver, braking, evasion: Evasion::Behind(leader), has_responded }
    }

    /// How a road user brakes if it goes on as now for a while.
    fn late_braking(&self, slot: u32, of: &Participant) -> LateBraking {
        let present = self.deceleration(self.user(slot));
        LateBraking { speed: of.speed, present, build_up: of.brakes.build_up, deceleration: of.brakes.deceleration }
    }

    /// The measures that follow from the courses of both; of several carriages, those of the two that are worst.
    fn timely(
        &self,
        scratch: &mut Scratch,
        chances: &mut Chances,
        pair: &[Carriages; 2],
        met: &Met,
        encounter: &Encounter,
    ) -> Timely {
        let mut worst: Option<Timely> = None;
        for pair in pairs(pair) {
            let found = self.timely_of(scratch, chances, pair, met, encounter);
            worst = Some(worst.map_or(found, |worst| worst.worse(&found, chances, self.roster)));
        }
        worst.unwrap_or(Timely::APART)
    }

    /// The same for a carriage of each of the two.
    fn timely_of(
        &self,
        scratch: &mut Scratch,
        chances: &mut Chances,
        pair: [&Participant; 2],
        met: &Met,
        encounter: &Encounter,
    ) -> Timely {
        let users = met.slots.map(|slot| self.user(slot));
        for ((user, of), poses) in users.into_iter().zip(pair).zip(scratch.courses.iter_mut()) {
            poses.clear();
            self.course(user, of.carriage, &[self.state(user).speed * ttc::HORIZON], true, poses);
            set_back(poses, of.setback);
        }
        // A contact ahead that only grazes is none: two that are smaller by the tolerance decide whether there is one.
        let ahead = [met.meeting.ego_distance, met.meeting.foe_distance];
        let tolerance = if met.shrinks > 0.0 { 0.0 } else { self.tolerance(met.slots, ahead) };
        let smaller = pair.map(|of| of.shrunk(shrinks(tolerance, pair[1])));
        let Scratch { courses, smaller_courses, halves, limits } = scratch;
        for one in [0, 1] {
            smaller_courses[one].clone_from(&courses[one]);
            set_back(&mut smaller_courses[one], smaller[one].setback - pair[one].setback);
        }
        let along = |slow_down: [MetrePerSecondSquared; 2]| {
            let full = [0, 1].map(|one| steady(pair[one], &courses[one], slow_down[one]));
            (full, [0, 1].map(|one| steady(&smaller[one], &smaller_courses[one], slow_down[one])))
        };
        let ([ego, foe], [smaller_ego, smaller_foe]) = along([0.0; 2]);
        let driver = |slot| self.user(slot).profile;
        let braking = self.late_braking(met.slots[0], pair[0]);
        if self.is_obstacle(met.slots[1]) {
            let mut time_to = |ego| ttc::time_to_fixed(halves, ego, self.roster.shape(encounter.foe));
            let Some(time) = time_to(&smaller_ego).and_then(|_| time_to(&ego)) else { return Timely::APART };
            let evasion = Evasion::Behind(Leader { room: ego.speed * time, speed: 0.0, deceleration: 0.0 });
            let drac = Some(ego.speed / (2.0 * time)).filter(|drac| *drac > 0.0);
            return Timely::of_course(Some(time), drac).with(&evasion, braking, driver(met.slots[0]), chances);
        }
        // The smaller two may touch too late to be found.
        let touch_at_last = || contact::touches(&ego.at(ttc::HORIZON), &foe.at(ttc::HORIZON));
        let ttc = ttc::time_to_collision(&ego, &foe)
            .filter(|_| ttc::time_to_collision(&smaller_ego, &smaller_foe).is_some() || touch_at_last());
        let drac = ttc.map(|ttc| drac::drac(halves, &ego, &foe, ttc, encounter.kind)).filter(|drac| *drac > 0.0);
        let timely = Timely::of_course(ttc, drac);
        // Both go on as now.
        let decelerations = users.map(|user| self.deceleration(user));
        let ([ego, foe], [smaller_ego, smaller_foe]) = along(decelerations);
        let meets = if decelerations == [0.0; 2] {
            ttc
        } else {
            ttc::time_to_collision(&smaller_ego, &smaller_foe).and_then(|_| ttc::time_to_collision(&ego, &foe))
        };
        let Some(meets) = meets else { return timely };
        let foe_braking = self.late_braking(met.slots[1], pair[1]);
        let alone = ttb::to_stay_behind(halves, limits, [&ego, &foe], &braking, meets);
        if encounter.kind == Kind::Frontal {
            let or_at = if let Some(Evasion::At(limits)) = alone { Some(limits) } else { None };
            let (share, room) = (-met.sigma.min(0.0), encounter.gap);
            let evasion = Evasion::Towards { foe: foe_braking, share, room, or_at };
            return timely.with(&evasion, braking, driver(met.slots[0]), chances);
        }
        if let Some(evasion) = alone {
            return timely.with(&evasion, braking, driver(met.slots[0]), chances);
        }
        // The foe comes to where the ego is now: only the foe can avoid contact.
        let of_foe = ttb::to_stay_behind(halves, limits, [&foe, &ego], &foe_braking, meets);
        timely.with(&of_foe.unwrap_or(Evasion::None), foe_braking, driver(met.slots[1]), chances)
    }
}

/// A road user, or a carriage of it, that keeps its deceleration along its course.
fn steady<'a>(of: &Participant, poses: &'a [Pose], deceleration: MetrePerSecondSquared) -> SteadyMotion<'a> {
    SteadyMotion { poses, speed: of.speed, deceleration, length: of.length(), width: of.width() }
}

/// Moves the fronts of a course back.
fn set_back(course: &mut [Pose], by: Metre) {
    course.iter_mut().for_each(|pose| pose.front -= pose.axis * by);
}

/// Each carriage of the one with each of the other.
fn pairs<'a, 'b>([ego, foe]: &'b [Carriages<'a>; 2]) -> impl Iterator<Item = [&'b Participant<'a>; 2]> {
    ego.iter().flat_map(move |ego| foe.iter().map(move |foe| [ego, foe]))
}
