//! Narrow phase, second half: the gap of a pair whose foe first has to arrive and leave, and the clearance, TTC, DRAC and
//! severity of a pair in conflict.

use super::cover;
use super::reach::User;
use super::step::StepInputs;
use super::worker::{Findings, Met, Scratch, Worker};
use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::kind::Kind;
use crate::detection::measures;
use crate::detection::measures::drac;
use crate::detection::measures::ttc::{self, SteadyMotion};
use crate::detection::narrow_phase::{self, ConflictPoint, Participant, side};
use crate::detection::step_values::StepValues;
use crate::geometry::{contact, polygon};
use crate::options::Mode;
use crate::util::units::{Metre, MetrePerSecondSquared, Second};

impl StepInputs<'_> {
    /// How far ahead a road user's path has to be known to measure a pair that it is in.
    pub(super) fn way_to_measure(&self, user: &User, meeting: &ConflictPoint) -> Metre {
        (self.state(user).speed * ttc::HORIZON).max(self.furthest_way_out(user, meeting))
    }

    /// Measures the pairs that a worker could not measure at once.
    pub(super) fn measure_all(&self, worker: &mut Worker) {
        let Findings { encounters, unmeasured, scratch, .. } = &mut worker.found;
        for (index, met) in unmeasured {
            let scene = self.as_met(met.further);
            let [ego, foe] = met.slots.map(|slot| scene.mover(slot).shrunk(met.shrinks));
            scene.measure(scratch, [&ego, &foe], met, &mut encounters[*index as usize]);
        }
    }

    /// Completes the encounter of a pair that would meet: the ego and its foe.
    pub(super) fn measure(&self, scratch: &mut Scratch, pair: [&Participant; 2], met: &Met, encounter: &mut Encounter) {
        if met.leaves {
            encounter.foe_distance = self.way_out(scratch, pair[1], met);
            if self.options.mode == Mode::Closecall {
                let gap = narrow_phase::gap(encounter.ego_distance, encounter.foe_distance, met.sigma);
                encounter.gap = self.gap_beyond(gap, encounter.mu, met.slots, &met.meeting);
                encounter.margin = encounter.gap - encounter.mu;
            }
        }
        if self.measures(encounter) {
            encounter.nearness = Some(self.nearness(scratch, pair, met, encounter));
            encounter.pet_below = self.pet_below(met.slots, encounter);
        }
    }

    /// Whether a pair that would meet is measured: if it is in conflict, or the log asks for more than that.
    pub(super) fn measures(&self, encounter: &Encounter) -> bool {
        encounter.in_conflict() || !self.options.log.is_default()
    }

    /// The PET that its event has to be below so that the step is logged. A collision always is.
    fn pet_below(&self, slots: [u32; 2], encounter: &Encounter) -> Second {
        if encounter.collision || (self.options.log.is_default() && encounter.in_conflict()) {
            return Second::INFINITY;
        }
        let users = slots.map(|slot| self.user(slot));
        let values = StepValues {
            found: encounter,
            speeds: users.map(|user| self.state(user).speed),
            masses: users.map(|user| self.profile(user).mass),
        };
        let may_have_pet = encounter.kind != Kind::RearEnd && !self.is_obstacle(slots[1]);
        self.options.log.pet_below(&|measure| values.of(measure), may_have_pet)
    }

    /// The gap of a pair. One that meets only beyond where both stand has a margin of at least the distance by which one
    /// would have to go on for that; its gap is as large.
    pub(super) fn gap_beyond(&self, gap: Metre, mu: Metre, slots: [u32; 2], meeting: &ConflictPoint) -> Metre {
        if !self.is_further() {
            return gap;
        }
        let [(ego, of_ego), (foe, of_foe)] =
            slots.map(|slot| self.user(slot)).map(|user| (self.state(user), self.profile(user)));
        let ego_beyond = meeting.ego_distance - cover::reach(ego, of_ego, self.options.epsilon);
        let foe_beyond = meeting.foe_distance - cover::stop(foe, of_foe);
        gap.max(mu + ego_beyond.max(foe_beyond).max(0.0))
    }

    /// A distance along the path at which the foe has surely left the conflict point.
    pub(super) fn furthest_way_out(&self, foe: &User, meeting: &ConflictPoint) -> Metre {
        let profile = self.profile(foe);
        let rectangle = &meeting.ego_rectangle;
        // The foe has left when its rear has passed the ego's whole rectangle, however that is turned.
        meeting.foe_distance
            + profile.length
            + (2.0 * (rectangle.half_length + rectangle.half_width) + profile.width) / self.paths.scale(foe.index)
    }

    /// The foe's distance until it has left the ego's conflict point.
    fn way_out(&self, scratch: &mut Scratch, foe: &Participant, met: &Met) -> Metre {
        let (poses, user) = (&mut scratch.courses[1], self.user(met.slots[1]));
        poses.clear();
        self.course(user, &[self.furthest_way_out(user, &met.meeting)], true, poses);
        side::departure(&mut scratch.halves, poses, foe, &met.meeting.ego_rectangle, met.meeting.foe_distance)
    }

    fn nearness(&self, scratch: &mut Scratch, pair: [&Participant; 2], met: &Met, encounter: &Encounter) -> Nearness {
        let [ego, foe] = pair;
        let clearance = if encounter.overlap > 0.0 || encounter.collision {
            0.0
        } else if foe.shape.is_empty() {
            contact::room(&ego.rectangle, &foe.rectangle)
        } else {
            polygon::distance(foe.shape, &ego.rectangle)
        };
        let (ttc, drac) =
            if encounter.collision { (Some(0.0), None) } else { self.ttc_and_drac(scratch, pair, met, encounter) };
        let brakes = ego.brakes.deceleration;
        let unavoidable = drac.is_some_and(|drac| drac > brakes.max(drac::LIMIT));
        let severity = measures::severity(ttc, drac, brakes, encounter.collision, self.options.severity_thresholds());
        Nearness { clearance, ttc, drac: drac.map(|drac| drac.min(drac::LIMIT)), unavoidable, severity }
    }

    /// The time to collision and, where there is one, the deceleration that avoids it; infinite where none does.
    fn ttc_and_drac(
        &self,
        scratch: &mut Scratch,
        pair: [&Participant; 2],
        met: &Met,
        encounter: &Encounter,
    ) -> (Option<Second>, Option<MetrePerSecondSquared>) {
        let users = met.slots.map(|slot| self.user(slot));
        for (user, poses) in users.into_iter().zip(scratch.courses.iter_mut()) {
            poses.clear();
            self.course(user, &[self.state(user).speed * ttc::HORIZON], true, poses);
            poses.iter_mut().for_each(|pose| pose.front -= pose.axis * met.shrinks);
        }
        let course =
            |of: &Participant, poses| SteadyMotion { poses, speed: of.speed, length: of.length(), width: of.width() };
        let (ego, foe) = (course(pair[0], &scratch.courses[0][..]), course(pair[1], &scratch.courses[1][..]));
        let is_obstacle = self.is_obstacle(met.slots[1]);
        let ttc = if is_obstacle {
            ttc::time_to_fixed(&mut scratch.halves, &ego, self.roster.shape(encounter.foe))
        } else {
            ttc::time_to_collision(&ego, &foe)
        };
        let Some(time) = ttc else { return (None, None) };
        let drac = if is_obstacle {
            ego.speed / (2.0 * time)
        } else {
            drac::drac(&mut scratch.halves, &ego, &foe, time, encounter.kind)
        };
        (ttc, Some(drac).filter(|drac| *drac > 0.0))
    }
}
