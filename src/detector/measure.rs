//! A pair that would meet, measured: gap, μ and margin; for a pair in conflict also clearance, TTC, DRAC, severity.

use super::Detector;
use crate::accurate::{self, Meeting, side};
use crate::approach::{self, Course};
use crate::braking::MuModel;
use crate::encounter::{Encounter, Kind, Nearness};
use crate::frame::{Frame, Roster};
use crate::geometry::outline::Outline;
use crate::geometry::rectangle;
use crate::measures;
use crate::options::Mode;
use crate::units::Metre;

impl Detector {
    /// Gap, μ and margin of a pair that would meet; for a pair in conflict also how near it is.
    pub(super) fn measure(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        (ego_row, foe_row): (u32, u32),
        meeting: &Meeting,
        collision: bool,
    ) -> Encounter {
        let angle = meeting.angle();
        let sigma = angle.cos();
        let foe_way = match meeting.foe_axis {
            Some(_) if sigma > 0.0 && !meeting.leads => self.way_out(frame, roster, foe_row, meeting),
            _ => meeting.foe_way,
        };
        let (ego, foe) = (self.mover(frame, roster, ego_row), self.mover(frame, roster, foe_row));
        let gap = if collision { 0.0 } else { accurate::gap(meeting.ego_way, foe_way, sigma) };
        let mu = accurate::mu(self.mu_model(), &ego, &foe, sigma, self.options.epsilon);
        let place = meeting.place();
        let ego_user = frame.users()[ego_row as usize];
        let lane = if self.rows[ego_row as usize].on_lanes {
            self.memory[ego_user.0 as usize].path.lane_at(meeting.ego_way)
        } else {
            None
        };
        let mut encounter = Encounter {
            ego: ego_user,
            foe: frame.users()[foe_row as usize],
            ego_row,
            foe_row,
            kind: accurate::kind_at(angle, &self.options),
            angle,
            gap,
            mu,
            margin: gap - mu,
            ego_way: meeting.ego_way,
            foe_way,
            x: place.x,
            y: place.y,
            lane,
            collision,
            nearness: None,
        };
        if encounter.in_conflict() {
            encounter.nearness = Some(self.nearness(frame, roster, &encounter, meeting));
        }
        encounter
    }

    fn mu_model(&self) -> MuModel {
        match self.options.mode {
            Mode::Closecall => self.options.mu,
            Mode::Paper => MuModel::Paper,
        }
    }

    /// The foe's way until it has left the ego's meeting place.
    fn way_out(&mut self, frame: &Frame, roster: &Roster, foe_row: u32, meeting: &Meeting) -> Metre {
        let profile = roster.profile_of(frame.users()[foe_row as usize]);
        // The foe is out when its rear has passed the ego's whole rectangle, whatever way that lies.
        let way =
            meeting.foe_way + profile.length + 2.0 * (meeting.ego.half_length + meeting.ego.half_width) + profile.width;
        let mut poses = std::mem::take(&mut self.scratch[0]);
        poses.clear();
        self.course(frame, roster, foe_row as usize, &[way], true, &mut poses);
        let foe = self.mover(frame, roster, foe_row);
        let out = side::departure(&poses, &foe, &meeting.ego, meeting.foe_way);
        self.scratch[0] = poses;
        out
    }

    fn nearness(&mut self, frame: &Frame, roster: &Roster, encounter: &Encounter, meeting: &Meeting) -> Nearness {
        let (ego_row, foe_row) = (encounter.ego_row, encounter.foe_row);
        let ttc = self.time_to_collision(frame, roster, ego_row, foe_row, encounter.collision);
        let ego = self.mover(frame, roster, ego_row);
        let foe = self.mover(frame, roster, foe_row);
        let clearance = if encounter.collision {
            0.0
        } else if foe.shape.is_empty() {
            rectangle::distance(&ego.rectangle, &foe.rectangle)
        } else {
            crate::geometry::polygon::distance(foe.shape, &ego.rectangle)
        };
        let drac = ttc.and_then(|_| self.drac(frame, roster, encounter, meeting));
        let ego = self.mover(frame, roster, ego_row);
        let severity = measures::severity(ttc, drac, ego.brakes.deceleration, encounter.collision, &self.options);
        Nearness { clearance, ttc, drac, severity }
    }

    fn drac(&mut self, frame: &Frame, roster: &Roster, encounter: &Encounter, meeting: &Meeting) -> Option<f64> {
        let speed = |row: u32| frame.states()[row as usize].speed;
        let (ego, foe) = (speed(encounter.ego_row), speed(encounter.foe_row));
        let sigma = encounter.angle.cos();
        if meeting.leads || encounter.kind == Kind::Frontal {
            return measures::drac_in_line(ego - sigma * foe, encounter.gap);
        }
        let out = if sigma > 0.0 || meeting.foe_axis.is_none() {
            encounter.foe_way
        } else {
            self.way_out(frame, roster, encounter.foe_row, meeting)
        };
        measures::drac_across(ego, encounter.ego_way, foe, out)
    }

    fn time_to_collision(
        &mut self,
        frame: &Frame,
        roster: &Roster,
        ego_row: u32,
        foe_row: u32,
        collision: bool,
    ) -> Option<f64> {
        if collision {
            return Some(0.0);
        }
        let mut poses = std::mem::take(&mut self.scratch);
        for (row, poses) in [ego_row, foe_row].into_iter().zip(&mut poses) {
            poses.clear();
            let way = frame.states()[row as usize].speed * approach::HORIZON;
            self.course(frame, roster, row as usize, &[way], true, poses);
        }
        let course = |row: u32, poses| {
            let profile = roster.profile_of(frame.users()[row as usize]);
            let speed = frame.states()[row as usize].speed;
            Course { poses, speed, length: profile.length, width: profile.width }
        };
        let (ego, foe) = (course(ego_row, &poses[0]), course(foe_row, &poses[1]));
        let shape = &roster.user(frame.users()[foe_row as usize]).shape;
        let ttc = if shape.is_empty() {
            approach::time_to_collision(&ego, &foe)
        } else {
            let outlines = shape.iter().map(|part| part.outline).collect::<Vec<Outline>>();
            approach::time_to_fixed(&ego, &outlines)
        };
        self.scratch = poses;
        ttc
    }
}
