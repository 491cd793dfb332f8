//! Narrow phase, second half: the gap of a pair whose foe first has to arrive and leave, and the clearance, TTC, DRAC and
//! severity of a pair in conflict.

use super::occupancy::Carriages;
use super::reach::User;
use super::step::StepInputs;
use super::worker::{Findings, Met, Scratch, Worker};
use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::measures;
use crate::detection::measures::drac;
use crate::detection::measures::ttc::{self, SteadyMotion};
use crate::detection::narrow_phase::{self, ConflictPoint, Participant, side};
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
            self.measure(scratch, met, &mut encounters[*index as usize]);
        }
    }

    /// Completes the encounter of a pair that would meet: the ego and its foe.
    pub(super) fn measure(&self, scratch: &mut Scratch, met: &Met, encounter: &mut Encounter) {
        let pair = met.slots.map(|slot| {
            let carriages = self.movers(slot).into_iter();
            carriages.map(|carriage| carriage.shrunk(met.shrinks)).collect::<Carriages>()
        });
        if met.leaves {
            encounter.foe_distance = self.way_out(scratch, &pair[1], met);
            if self.options.mode == Mode::Closecall {
                encounter.gap = narrow_phase::gap(encounter.ego_distance, encounter.foe_distance, met.sigma);
                encounter.margin = encounter.gap - encounter.mu;
            }
        }
        if encounter.in_conflict() {
            encounter.nearness = Some(self.nearness(scratch, &pair, met, encounter));
        }
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

    /// The foe's distance until it, and so each of its carriages, has left the ego's conflict point.
    fn way_out(&self, scratch: &mut Scratch, foe: &[Participant], met: &Met) -> Metre {
        let (poses, user, meeting) = (&mut scratch.courses[1], self.user(met.slots[1]), &met.meeting);
        let rectangle = &meeting.ego_rectangle;
        let left = foe.iter().filter_map(|carriage| {
            poses.clear();
            self.course(user, carriage.carriage, &[self.furthest_way_out(user, meeting)], true, poses);
            match foe {
                [_] => Some(side::departure(&mut scratch.halves, poses, carriage, rectangle, meeting.foe_distance)),
                _ => side::carriage_departure(&mut scratch.halves, poses, carriage, rectangle),
            }
        });
        left.fold(meeting.foe_distance, f64::max)
    }

    fn nearness(&self, scratch: &mut Scratch, pair: &[Carriages; 2], met: &Met, encounter: &Encounter) -> Nearness {
        let clearance = |[ego, foe]: [&Participant; 2]| match foe.shape {
            [] => contact::room(&ego.rectangle, &foe.rectangle),
            shape => polygon::distance(shape, &ego.rectangle),
        };
        let clearance = if encounter.overlap > 0.0 || encounter.collision {
            0.0
        } else {
            pairs(pair).map(clearance).fold(f64::INFINITY, f64::min)
        };
        let (ttc, drac) = if encounter.collision {
            (Some(0.0), None)
        } else {
            self.first_ttc_and_drac(scratch, pair, met, encounter)
        };
        let brakes = self.profile(self.user(met.slots[0])).brakes.deceleration;
        let unavoidable = drac.is_some_and(|drac| drac > brakes.max(drac::LIMIT));
        let severity = measures::severity(ttc, drac, brakes, encounter.collision, self.options.severity_thresholds());
        Nearness { clearance, ttc, drac: drac.map(|drac| drac.min(drac::LIMIT)), unavoidable, severity }
    }

    /// The time to collision and, where there is one, the deceleration that avoids it; infinite where none does. The first
    /// two carriages to touch have the one, those that are hardest to keep apart the other.
    fn first_ttc_and_drac(
        &self,
        scratch: &mut Scratch,
        pair: &[Carriages; 2],
        met: &Met,
        encounter: &Encounter,
    ) -> (Option<Second>, Option<MetrePerSecondSquared>) {
        let each = pairs(pair).map(|pair| self.ttc_and_drac(scratch, pair, met, encounter));
        let one_of = |a: Option<f64>, b: Option<f64>, best: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(best(a, b)),
            (one, other) => one.or(other),
        };
        let first = |(ttc, drac), (next, other)| (one_of(ttc, next, f64::min), one_of(drac, other, f64::max));
        each.reduce(first).unwrap_or_default()
    }

    /// The same for a carriage of each of the two.
    fn ttc_and_drac(
        &self,
        scratch: &mut Scratch,
        pair: [&Participant; 2],
        met: &Met,
        encounter: &Encounter,
    ) -> (Option<Second>, Option<MetrePerSecondSquared>) {
        let users = met.slots.map(|slot| self.user(slot));
        for ((user, of), poses) in users.into_iter().zip(pair).zip(scratch.courses.iter_mut()) {
            poses.clear();
            self.course(user, of.carriage, &[self.state(user).speed * ttc::HORIZON], true, poses);
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

/// Each carriage of the one with each of the other.
fn pairs<'a, 'b>([ego, foe]: &'b [Carriages<'a>; 2]) -> impl Iterator<Item = [&'b Participant<'a>; 2]> {
    ego.iter().flat_map(move |ego| foe.iter().map(move |foe| [ego, foe]))
}
