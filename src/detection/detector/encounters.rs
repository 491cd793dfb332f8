//! Narrow phase, first half: a pair that would meet becomes an encounter, with its kind, gap and μ.

use super::overlap::Overlap;
use super::reach::User;
use super::step::StepInputs;
use super::work_counts::Work;
use super::worker::{Findings, Met};
use crate::braking::MuModel;
use crate::detection::encounter::Encounter;
use crate::detection::kind::Kind;
use crate::detection::narrow_phase::{self, ConflictPoint, Ego, Participant};
use crate::geometry::movement::TOLERANCE;
use crate::options::Mode;
use crate::util::units::{Metre, Radian};

/// Which of a pair is the ego and which the foe.
pub(super) struct Roles<'a> {
    /// The ego's slot and the foe's.
    pub slots: [u32; 2],
    pub ego: &'a Participant<'a>,
    pub foe: &'a Participant<'a>,
}

impl<'a> Roles<'a> {
    pub fn new(ego: Ego, slots: [u32; 2], pair: [&'a Participant<'a>; 2]) -> Self {
        let slots = ego.then_foe(slots);
        let [ego, foe] = ego.then_foe(pair);
        Self { slots, ego, foe }
    }
}

/// Kind, angle and gap of a pair that would meet.
pub(super) struct How {
    pub kind: Kind,
    pub angle: Radian,
    /// cos α.
    pub sigma: f64,
    pub gap: Metre,
    pub overlap: Overlap,
}

impl StepInputs<'_> {
    /// Adds a pair that would meet at this conflict point.
    pub(super) fn met(
        &self,
        work: &mut Work,
        found: &mut Findings,
        roles: &Roles,
        meeting: &ConflictPoint,
        overlap: Overlap,
    ) {
        let angle = meeting.angle();
        let sigma = narrow_phase::sigma(angle);
        let gap = narrow_phase::gap(meeting.ego_distance, meeting.foe_distance, sigma);
        let gap = if overlap.collision { 0.0 } else { gap };
        let kind = match Kind::at(angle, self.options.kind_bounds()) {
            Kind::Side if sigma > 0.0 && self.follows(roles.slots, meeting) => Kind::RearEnd,
            kind => kind,
        };
        let how = How { kind, angle, sigma, gap, overlap };
        match how.kind {
            Kind::Frontal => work.frontal += 1,
            Kind::Side => work.side += 1,
            Kind::RearEnd => {}
        }
        self.add(work, found, roles, meeting, how);
    }

    /// Whether the ego follows the foe on one path of lanes, as through a bend: all that is under the foe is on the ego's way.
    fn follows(&self, slots: [u32; 2], meeting: &ConflictPoint) -> bool {
        let [ego, foe] = slots.map(|slot| self.user(slot));
        if !ego.on_lanes || !foe.on_lanes {
            return false;
        }
        let lanes = |user: &User, from, to| {
            let path = self.paths.of(user.index);
            path.map(|path| path.lanes_between(self.paths.of_net(), from, to)).unwrap_or_default()
        };
        let length = self.drawn_length(foe);
        let (under, path_lanes) = (lanes(foe, -length, 0.0), lanes(ego, 0.0, meeting.ego_distance + length));
        !under.is_empty() && under.iter().all(|lane| path_lanes.contains(lane))
    }

    /// Adds a pair that would meet and measures it. Where a path has to be extended for that, it is measured later.
    pub(super) fn add(&self, work: &mut Work, found: &mut Findings, roles: &Roles, meeting: &ConflictPoint, how: How) {
        found.meets = true;
        let How { kind, angle, sigma, gap, overlap } = how;
        let Overlap { depth, collision, shrinks } = overlap;
        let mu = narrow_phase::mu(self.mu_model(), roles.ego, roles.foe, sigma, self.options.epsilon);
        let gap = self.gap_beyond(gap, mu, roles.slots, meeting);
        let margin = gap - mu;
        // The gap is not known yet where the foe first has to arrive and leave.
        let leaves = meeting.foe_leaves(sigma);
        if self.conflicts_only
            && self.options.log.is_default()
            && margin >= 0.0
            && !collision
            && !(leaves && self.may_leave_late(roles, meeting, sigma, mu))
        {
            return;
        }
        if self.are_on_two_levels(roles.slots, meeting, kind) {
            work.other_level += 1;
            return;
        }
        let at = meeting.front();
        let [ego, foe] = roles.slots.map(|slot| self.user(slot));
        let encounter = Encounter {
            ego: ego.index,
            foe: foe.index,
            ego_row: ego.row,
            foe_row: foe.row,
            kind,
            angle,
            gap,
            mu,
            margin,
            ego_distance: meeting.ego_distance,
            foe_distance: meeting.foe_distance,
            foe_leads: meeting.foe_leads || meeting.foe_distance <= 0.0,
            x: at.x,
            y: at.y,
            lane: if ego.on_lanes {
                self.paths.lane_at(ego.index, meeting.ego_distance - meeting.ego_behind)
            } else {
                None
            },
            overlap: depth,
            collision,
            nearness: None,
            pet_below: f64::NEG_INFINITY,
        };
        found.encounters.push(encounter);
        let Findings { encounters, unmeasured, scratch, chances, .. } = found;
        let (number, Some(encounter)) = (encounters.len() as u32 - 1, encounters.last_mut()) else { return };
        if leaves || self.measures(encounter) {
            let met = Met { slots: roles.slots, meeting: *meeting, sigma, leaves, shrinks, further: self.is_further() };
            if [ego, foe].into_iter().all(|user| self.reaches(user, self.distance_to_measure(user, meeting))) {
                self.measure(scratch, chances, &met, encounter);
                if self.conflicts_only && !encounter.may_be_logged() {
                    encounters.pop();
                }
            } else {
                unmeasured.push((number, met));
            }
        }
    }

    /// Whether a road user's path reaches this far ahead, or never has to be extended.
    fn reaches(&self, user: &User, distance: Metre) -> bool {
        !user.on_lanes || self.paths.track(user.index).0.ahead() >= distance
    }

    /// Whether a pair is in conflict if its foe leaves the conflict point as late as it can.
    pub(super) fn may_leave_late(&self, roles: &Roles, meeting: &ConflictPoint, sigma: f64, mu: Metre) -> bool {
        let foe_distance = self.furthest_exit(self.user(roles.slots[1]), meeting);
        narrow_phase::gap(meeting.ego_distance, foe_distance, sigma) < mu + TOLERANCE
    }

    pub(super) fn mu_model(&self) -> MuModel {
        match self.options.mode {
            Mode::Closecall => self.options.mu,
            Mode::Paper => MuModel::Paper,
        }
    }
}
