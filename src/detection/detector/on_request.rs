//! What the detector works out of a pair on request: the measures that a log has only if they are chosen, and crash
//! probabilities.

use super::Detector;
use super::chances::CHANCES;
use super::last_speed::LastSpeed;
use super::reach::User;
use crate::detection::chosen_values::{PairInStep, UserInStep, need_courses};
use crate::detection::encounter::{Encounter, Nearness};
use crate::detection::measures::plane::Moving;
use crate::detection::measures::table::{LoggedMeasure, LoggedValues};
use crate::detection::measures::ttc::SteadyMotion;
use crate::geometry::rectangle::Rectangle;
use crate::options::measures::{ChosenMeasure, ChosenValues, Measures};
use crate::traffic::frame::Frame;
use crate::traffic::roster::{Roster, UserIndex};
use crate::util::units::{MetrePerSecondSquared, Probability, Second};

impl Detector {
    /// The measures that are computed besides those that every run has.
    pub fn measures(&self) -> Measures {
        self.options.measures
    }

    /// The values of the chosen measures of a pair in this step; none where none is chosen.
    pub fn chosen(&self, frame: &Frame, roster: &Roster, found: &Encounter) -> Option<Box<ChosenValues>> {
        let measures = self.options.measures;
        (!measures.is_empty()).then(|| Box::new(self.values(frame, roster, found, measures)))
    }

    /// How a road user brakes, 0 or more: the mean over some steps, as measures take it.
    pub fn deceleration(&self, user: UserIndex) -> MetrePerSecondSquared {
        self.speeds.get(user).map_or(0.0, LastSpeed::deceleration)
    }

    /// The time advantage of a pair in this step.
    pub fn tadv(&self, frame: &Frame, roster: &Roster, found: &Encounter) -> Option<Second> {
        self.values(frame, roster, found, ChosenMeasure::Tadv.into())[ChosenMeasure::Tadv as usize]
    }

    /// A crash probability of a pair that was measured in this step, [`LoggedMeasure::CrashProbability`] or
    /// [`LoggedMeasure::CrashProbabilityBraking`]; none if it is one of an earlier step that was not worked out then.
    pub fn crash_probability(
        &self,
        roster: &Roster,
        nearness: &Nearness,
        measure: LoggedMeasure,
    ) -> Option<Probability> {
        let worker = self.workers.get(nearness.chances.worker as usize)?;
        worker.found.chances.of(nearness, measure, roster)
    }

    /// An encounter of this step with its crash probabilities.
    pub fn with_probabilities(&self, roster: &Roster, found: &Encounter) -> Encounter {
        let with = |near: Nearness| {
            let chances = CHANCES.map(|measure| self.crash_probability(roster, &near, measure));
            let add = |values: LoggedValues, (measure, value)| values.with(measure, value);
            let values = CHANCES.into_iter().zip(chances).fold(near.values, add);
            let crash_at_most = [0, 1].map(|which| chances[which].unwrap_or(near.crash_at_most[which]));
            Nearness { values, crash_at_most, ..near }
        };
        Encounter { nearness: found.nearness.map(with), ..*found }
    }

    fn values(&self, frame: &Frame, roster: &Roster, found: &Encounter, measures: Measures) -> ChosenValues {
        let (sight, scene) = (self.sight(frame, roster), self.scene(frame, roster));
        let users = [found.ego_row, found.foe_row].map(|row| sight.user(row, &sight.see(row), &User::default()));
        let mut courses = [Vec::new(), Vec::new()];
        if let Some(until) = need_courses(measures, found) {
            for (user, poses) in users.iter().zip(&mut courses) {
                if let Some(first) = scene.carriages(user).next() {
                    scene.course(user, first, &[scene.state(user).speed * until], true, poses);
                }
            }
        }
        let [ego, foe] = [0, 1].map(|one| {
            let (user, poses) = (&users[one], &courses[one]);
            let (state, of, length) = (scene.state(user), scene.profile(user), scene.drawn_length(user));
            let rectangle = Rectangle::behind(state.front(), user.axis, length, of.width);
            let steady = SteadyMotion { poses, speed: state.speed, deceleration: 0.0, length, width: of.width };
            UserInStep {
                moving: Moving { rectangle, speed: state.speed },
                acceleration: self.speeds[user.index].acceleration,
                of,
                course: (!poses.is_empty()).then_some(steady),
            }
        });
        let crossing = self.options.kind_bounds().rear_end_below;
        PairInStep { found, ego, foe, crossing, step: self.step, advantage: None }.values(measures)
    }
}
