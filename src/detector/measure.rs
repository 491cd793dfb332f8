//! Phase 2, second half: the gap of a pair whose foe has to come and go first; of a pair in conflict clearance, TTC, DRAC,
//! severity.

use super::ways::Ways;
use super::{Scene, Worker};
use crate::accurate::{self, Meeting, side};
use crate::approach::{self, Course};
use crate::encounter::{Encounter, Kind, Nearness};
use crate::geometry::outline::Outline;
use crate::geometry::{polygon, rectangle};
use crate::measures;
use crate::options::Mode;
use crate::path::Pose;
use crate::units::{Metre, MetrePerSecondSquared, Second};

/// Poses further ahead than the ways of the step: the ego's and the foe's.
type Courses = [Vec<Pose>; 2];

impl Scene<'_> {
    /// How far ahead the path of a row has to be known to measure a pair that it is in.
    pub(super) fn way_to_measure(&self, row: u32, meeting: &Meeting) -> Metre {
        (self.state(row).speed * approach::HORIZON).max(self.furthest_way_out(row, meeting))
    }

    /// Completes what a worker has met.
    pub(super) fn measure_all(&self, worker: &mut Worker) {
        let Worker { encounters, unmeasured, ways, courses, .. } = worker;
        for met in unmeasured {
            let encounter = &mut encounters[met.encounter as usize];
            if met.leaves {
                encounter.foe_way = self.way_out(ways, courses, encounter.foe_row, &met.meeting);
                if self.options.mode == Mode::Closecall {
                    encounter.gap = accurate::gap(encounter.ego_way, encounter.foe_way, encounter.angle.cos());
                    encounter.margin = encounter.gap - encounter.mu;
                }
            }
            if encounter.in_conflict() {
                encounter.nearness = Some(self.nearness(ways, courses, encounter, &met.meeting));
            }
        }
    }

    /// The way that holds the one at which the foe is out of the way.
    fn furthest_way_out(&self, foe_row: u32, meeting: &Meeting) -> Metre {
        let profile = self.profile(foe_row);
        // The foe is out when its rear has passed the ego's whole rectangle, whatever way that lies.
        meeting.foe_way + profile.length + 2.0 * (meeting.ego.half_length + meeting.ego.half_width) + profile.width
    }

    /// The foe's way until it has left the ego's meeting place.
    fn way_out(&self, ways: &Ways, courses: &mut Courses, foe_row: u32, meeting: &Meeting) -> Metre {
        let poses = &mut courses[1];
        poses.clear();
        self.course(foe_row, &[self.furthest_way_out(foe_row, meeting)], true, poses);
        side::departure(poses, &ways.mover(self, foe_row), &meeting.ego, meeting.foe_way)
    }

    fn nearness(&self, ways: &Ways, courses: &mut Courses, encounter: &Encounter, meeting: &Meeting) -> Nearness {
        let ttc = self.time_to_collision(courses, encounter);
        let (ego, foe) = (ways.mover(self, encounter.ego_row), ways.mover(self, encounter.foe_row));
        let clearance = if encounter.collision {
            0.0
        } else if foe.shape.is_empty() {
            rectangle::distance(&ego.rectangle, &foe.rectangle)
        } else {
            polygon::distance(foe.shape, &ego.rectangle)
        };
        let drac = ttc.and_then(|_| self.drac(ways, courses, encounter, meeting));
        let severity = measures::severity(ttc, drac, ego.brakes.deceleration, encounter.collision, self.options);
        Nearness { clearance, ttc, drac, severity }
    }

    fn drac(
        &self,
        ways: &Ways,
        courses: &mut Courses,
        encounter: &Encounter,
        meeting: &Meeting,
    ) -> Option<MetrePerSecondSquared> {
        let [ego, foe] = [encounter.ego_row, encounter.foe_row].map(|row| self.state(row).speed);
        let sigma = encounter.angle.cos();
        if meeting.leads || encounter.kind == Kind::Frontal {
            return measures::drac_in_line(ego - sigma * foe, encounter.gap);
        }
        let out = if sigma > 0.0 || meeting.foe_axis.is_none() {
            encounter.foe_way
        } else {
            self.way_out(ways, courses, encounter.foe_row, meeting)
        };
        measures::drac_across(ego, encounter.ego_way, foe, out)
    }

    fn time_to_collision(&self, courses: &mut Courses, encounter: &Encounter) -> Option<Second> {
        if encounter.collision {
            return Some(0.0);
        }
        let rows = [encounter.ego_row, encounter.foe_row];
        for (row, poses) in rows.into_iter().zip(courses.iter_mut()) {
            poses.clear();
            self.course(row, &[self.state(row).speed * approach::HORIZON], true, poses);
        }
        let course = |row: u32, poses| {
            let profile = self.profile(row);
            Course { poses, speed: self.state(row).speed, length: profile.length, width: profile.width }
        };
        let (ego, foe) = (course(rows[0], &courses[0][..]), course(rows[1], &courses[1][..]));
        let shape = &self.roster.user(encounter.foe).shape;
        if shape.is_empty() {
            approach::time_to_collision(&ego, &foe)
        } else {
            let outlines = shape.iter().map(|part| part.outline).collect::<Vec<Outline>>();
            approach::time_to_fixed(&ego, &outlines)
        }
    }
}
