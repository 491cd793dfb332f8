//! Phase 2, first half: where a pair would meet, what gap and μ are there.

use super::ways::Ways;
use super::{Met, Scene, Work, Worker};
use crate::accurate::{self, Meeting, Mover, side};
use crate::braking::{self, MuModel};
use crate::encounter::Encounter;
use crate::geometry::rectangle;
use crate::options::Mode;

impl Scene<'_> {
    /// The pairs of a worker that would meet.
    pub(super) fn meet_all(&self, worker: &mut Worker) {
        let Worker { pairs, work, ways, encounters, unmeasured, .. } = worker;
        for &(a, b) in pairs.iter() {
            let met = match self.options.mode {
                Mode::Closecall => self.meet(ways, work, a, b),
                Mode::Paper => self.meet_on_paper(ways, a, b),
            };
            let Some((encounter, meeting)) = met else { continue };
            let leaves = !meeting.leads && meeting.foe_axis.is_some() && encounter.angle.cos() > 0.0;
            if leaves || encounter.in_conflict() {
                let rows = [encounter.ego_row, encounter.foe_row];
                unmeasured.push(Met { encounter: encounters.len() as u32, rows, meeting, leaves });
            }
            encounters.push(encounter);
        }
    }

    fn meet(&self, ways: &mut Ways, work: &mut Work, a: u32, b: u32) -> Option<(Encounter, Meeting)> {
        ways.see(self, a);
        ways.see(self, b);
        if self.leaves_out.ways_apart && !ways.bounds(self, a).meet(ways.bounds(self, b)) {
            work.ways_apart += 1;
            return None;
        }
        let (first, second) = (ways.mover(self, a), ways.mover(self, b));
        let (first, second, a, b) = if first.shape.is_empty() { (first, second, a, b) } else { (second, first, b, a) };
        let id = |row: u32| &self.roster.user(self.user(row)).id;
        let a_is_smaller = || id(a) <= id(b);
        if side::touch_now(&first, &second) {
            let ego_is_a = !second.shape.is_empty() || a_is_smaller();
            let (ego, foe) = if ego_is_a { (&first, &second) } else { (&second, &first) };
            let foe_axis = foe.shape.is_empty().then_some(foe.rectangle.axis);
            let meeting = Meeting { ego_way: 0.0, foe_way: 0.0, ego: ego.rectangle, foe_axis, leads: true };
            let rows = if ego_is_a { (a, b) } else { (b, a) };
            return Some(self.met(rows, (ego, foe), meeting, true));
        }
        let in_line = accurate::drive_in_line(&first, &second);
        if in_line && self.leaves_out.in_line {
            work.in_line += 1;
            let (ego_is_a, meeting) = accurate::meet_in_one_dimension(&first, &second, &a_is_smaller)?;
            return Some(self.met_as(ego_is_a, (a, b), (&first, &second), meeting));
        }
        ways.cover(self, a);
        ways.cover(self, b);
        let (first, second) = (ways.mover(self, a), ways.mover(self, b));
        if !first.cover.meets(second.cover) {
            work.ways_apart += 1;
            return None;
        }
        work.swept += 1;
        let (ego_is_a, meeting) = accurate::meet_swept(&first, &second, in_line, &a_is_smaller)?;
        Some(self.met_as(ego_is_a, (a, b), (&first, &second), meeting))
    }

    fn meet_on_paper(&self, ways: &Ways, a: u32, b: u32) -> Option<(Encounter, Meeting)> {
        let (first, second) = (ways.mover(self, a), ways.mover(self, b));
        if !first.shape.is_empty() || !second.shape.is_empty() {
            return None;
        }
        let found = accurate::paper::measure(&first, &second, self.options);
        let (ego, foe) = if found.ego_is_a { (&first, &second) } else { (&second, &first) };
        let between = (foe.rectangle.centre - ego.rectangle.centre).norm();
        let radius = braking::stopping_distance_paper(ego.speed, ego.brakes) + self.options.epsilon;
        // Eq. 4: the ego's detection radius reaches the foe's front.
        if between - foe.rectangle.half_length > radius || !found.distance.is_finite() {
            return None;
        }
        let collision = rectangle::touches(&ego.rectangle, &foe.rectangle);
        let rows = if found.ego_is_a { (a, b) } else { (b, a) };
        let (mut encounter, meeting) = self.met(rows, (ego, foe), found.meeting, collision);
        encounter.kind = found.kind;
        encounter.gap = found.distance;
        encounter.margin = encounter.gap - encounter.mu;
        Some((encounter, meeting))
    }

    fn met_as(
        &self,
        ego_is_a: bool,
        (a, b): (u32, u32),
        (first, second): (&Mover, &Mover),
        meeting: Meeting,
    ) -> (Encounter, Meeting) {
        if ego_is_a {
            self.met((a, b), (first, second), meeting, false)
        } else {
            self.met((b, a), (second, first), meeting, false)
        }
    }

    /// Gap, μ and margin of a pair that would meet, as ego and foe; the gap of one whose foe has to come and go is not
    /// known yet.
    fn met(
        &self,
        rows: (u32, u32),
        (ego, foe): (&Mover, &Mover),
        meeting: Meeting,
        collision: bool,
    ) -> (Encounter, Meeting) {
        let angle = meeting.angle();
        let sigma = angle.cos();
        let gap = if collision { 0.0 } else { accurate::gap(meeting.ego_way, meeting.foe_way, sigma) };
        let mu = accurate::mu(self.mu_model(), ego, foe, sigma, self.options.epsilon);
        let place = meeting.place();
        let user = self.user(rows.0);
        let path = self.row(rows.0).on_lanes.then(|| &self.memory[user.0 as usize].path);
        let encounter = Encounter {
            ego: user,
            foe: self.user(rows.1),
            ego_row: rows.0,
            foe_row: rows.1,
            kind: accurate::kind_at(angle, self.options),
            angle,
            gap,
            mu,
            margin: gap - mu,
            ego_way: meeting.ego_way,
            foe_way: meeting.foe_way,
            x: place.x,
            y: place.y,
            lane: path.and_then(|path| path.lane_at(meeting.ego_way)),
            collision,
            nearness: None,
        };
        (encounter, meeting)
    }

    fn mu_model(&self) -> MuModel {
        match self.options.mode {
            Mode::Closecall => self.options.mu,
            Mode::Paper => MuModel::Paper,
        }
    }
}
