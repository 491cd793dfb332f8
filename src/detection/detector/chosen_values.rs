//! What the detector knows of a pair for the measures that a log has only if they are chosen.

use super::Detector;
use super::reach::User;
use crate::detection::chosen_values::{PairInStep, UserInStep, need_courses};
use crate::detection::encounter::Encounter;
use crate::detection::measures::plane::Moving;
use crate::detection::measures::ttc::SteadyMotion;
use crate::geometry::rectangle::Rectangle;
use crate::options::measures::{ChosenMeasure, ChosenValues, Measures};
use crate::traffic::frame::Frame;
use crate::traffic::roster::Roster;
use crate::util::units::Second;

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

    /// The time advantage of a pair in this step.
    pub fn tadv(&self, frame: &Frame, roster: &Roster, found: &Encounter) -> Option<Second> {
        self.values(frame, roster, found, ChosenMeasure::Tadv.into())[ChosenMeasure::Tadv as usize]
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
