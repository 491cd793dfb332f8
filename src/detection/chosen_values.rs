//! The values of a pair in a step of the measures that a log has only if they are chosen.
//!
//! How an event aggregates the values of its steps (the smallest, the integral, …) is in [`crate::events`].

use super::encounter::Encounter;
use super::kind::Kind;
use super::measures::accident::conflicting_speed;
use super::measures::advantage::{Advantage, advantage};
use super::measures::emergency_index::emergency_index;
use super::measures::mttc::{Accelerating, mttc};
use super::measures::plane::{Moving, anticipated_collision_time, delta_s};
use super::measures::ttc::{HORIZON, SteadyMotion};
use super::measures::{accident, crash_potential, exposure, headway, mdrac, rss_lateral, threat};
use crate::braking::rss::safe_distance;
use crate::geometry::{cross, left_of};
use crate::options::measures::{ChosenMeasure, ChosenValues, Measures};
use crate::traffic::profile::{Category, Profile};
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Probability, Radian, Second};

/// One road user of a pair in a step.
#[derive(Clone, Copy)]
pub(super) struct UserInStep<'a> {
    pub moving: Moving,
    /// Below 0 where it brakes.
    pub acceleration: MetrePerSecondSquared,
    pub of: &'a Profile,
    /// As it goes on if it keeps its speed; none where it is not asked for.
    pub course: Option<SteadyMotion<'a>>,
}

/// A pair in a step.
#[derive(Clone, Copy)]
pub(super) struct PairInStep<'a> {
    pub found: &'a Encounter,
    pub ego: UserInStep<'a>,
    pub foe: UserInStep<'a>,
    /// Paths that meet at a smaller angle do not cross.
    pub crossing: Radian,
    /// How long the step lasted.
    pub step: Second,
    /// The time advantage, where a chosen measure asks for it.
    pub advantage: Option<Advantage>,
}

/// How long the chosen measures follow both of a pair along their paths; none where they do not.
pub(super) fn need_courses(measures: Measures, found: &Encounter) -> Option<Second> {
    use ChosenMeasure::{ALatReq, Stn, T2, Tadv};
    let has = |any: [ChosenMeasure; 2]| any.into_iter().any(|measure| measures.has(measure));
    match (found.kind, found.nearness.and_then(|nearness| nearness.values.ttc())) {
        (Kind::Frontal | Kind::Side, None) if has([Tadv, T2]) => Some(HORIZON),
        (Kind::RearEnd | Kind::Frontal, Some(ttc)) if has([ALatReq, Stn]) && ttc > 0.0 => Some(ttc),
        _ => None,
    }
}

/// Makes the function that has the value of each measure of the rows of the table.
macro_rules! value_measures {
    ($( $(#[doc = $meaning:literal])+ $variant:ident $name:ident: $unit:ty, $over:ident = |$pair:ident| $value:expr; )+) => {
        impl PairInStep<'_> {
            fn value(&self, measure: ChosenMeasure) -> Option<f64> {
                match measure {
                    $( ChosenMeasure::$variant => { let $pair = self; $value } )+
                }
            }
        }
    };
}

crate::chosen_measures!(value_measures!);

impl PairInStep<'_> {
    /// The values of the chosen measures.
    pub fn values(&self, measures: Measures) -> ChosenValues {
        let is_ahead = measures.has(ChosenMeasure::Tadv) || measures.has(ChosenMeasure::T2);
        let pair = Self { advantage: if is_ahead { self.advantage() } else { None }, ..*self };
        // It tells an event in which step braking begins.
        let has_onset = [ChosenMeasure::Ta, ChosenMeasure::TaLevel].into_iter().any(|measure| measures.has(measure));
        ChosenMeasure::ALL.map(|measure| {
            let is_needed = has_onset && measure == ChosenMeasure::ConflictingSpeed;
            if measures.has(measure) || is_needed {
                pair.value(measure).filter(|value| value.is_finite())
            } else {
                None
            }
        })
    }

    fn ttc(&self) -> Option<Second> {
        self.found.nearness?.values.ttc()
    }

    /// The foe's motion along the ego's path, if the ego follows it.
    fn behind(&self) -> Option<Accelerating> {
        let sigma = self.found.angle.cos();
        let Self { foe: UserInStep { moving, acceleration, .. }, .. } = self;
        let leader = Accelerating { speed: sigma * moving.speed, acceleration: sigma * acceleration };
        (self.found.kind == Kind::RearEnd).then_some(leader)
    }

    fn time_headway(&self) -> Option<Second> {
        headway::time_headway(self.found.kind, self.found.gap, self.foe.of.length, self.ego.moving.speed)
    }

    fn crash_potential(&self) -> Probability {
        let drac = self.found.nearness.and_then(|nearness| nearness.values.drac());
        if self.found.collision { 1.0 } else { crash_potential::exceeds_brakes(&self.ego.of.driver, drac) }
    }

    fn mttc(&self) -> Option<(Second, Option<f64>)> {
        let UserInStep { moving, acceleration, .. } = self.ego;
        mttc(self.found.gap, Accelerating { speed: moving.speed, acceleration }, self.behind()?)
    }

    /// The rectangles of both with their speeds; none with an obstacle, whose shape is a polygon.
    fn in_plane(&self) -> Option<[&Moving; 2]> {
        (self.foe.of.category != Category::Obstacle).then_some([&self.ego.moving, &self.foe.moving])
    }

    fn advantage(&self) -> Option<Advantage> {
        if self.found.kind == Kind::RearEnd || self.in_plane().is_none() {
            return None;
        }
        if let Some(ttc) = self.ttc() {
            return Some(Advantage::on_collision_course(ttc));
        }
        advantage([&self.ego.course?, &self.foe.course?], self.crossing)
    }

    fn rss_distance(&self) -> Option<Metre> {
        let [ego, foe] = [self.ego.moving.speed, self.foe.moving.speed];
        match self.found.kind {
            Kind::RearEnd => Some(safe_distance(ego, foe, 1.0)),
            Kind::Frontal => Some(safe_distance(ego, foe, -1.0)),
            Kind::Side => None,
        }
    }

    /// The ego moves along its own heading, so only the foe moves sideways.
    fn rss_lateral_distance(&self) -> Option<Metre> {
        let [ego, foe] = self.in_plane()?;
        let axis = &ego.rectangle.axis;
        let side = (foe.rectangle.centre - ego.rectangle.centre).dot(&left_of(axis)).signum();
        let leaves = side * cross(axis, &foe.rectangle.axis) * foe.speed;
        (self.found.kind != Kind::Side).then(|| rss_lateral::lateral([0.0, -leaves]))
    }

    fn required_braking(&self) -> Option<MetrePerSecondSquared> {
        match self.behind() {
            Some(Accelerating { speed, acceleration }) if !self.found.collision => {
                let braking = (-acceleration).max(0.0);
                Some(threat::behind(self.found.gap, self.ego.moving.speed, speed, braking))
            }
            Some(_) => None,
            None => self.found.nearness?.values.drac(),
        }
    }

    fn required_steering(&self) -> Option<MetrePerSecondSquared> {
        let (ego, foe) = (self.ego.course?, self.foe.course?);
        let ttc = self.time_to_accident()?;
        self.in_plane().filter(|_| self.found.kind != Kind::Side)?;
        Some(threat::aside(&ego.at(ttc), &foe.at(ttc), ttc))
    }

    /// The TTC, if they do not touch yet.
    fn time_to_accident(&self) -> Option<Second> {
        self.ttc().filter(|ttc| *ttc > 0.0)
    }

    /// The conflicting speed, if one evades.
    fn conflicting_speed(&self) -> Option<MetrePerSecond> {
        let Self { ego, foe, .. } = self;
        let speeds = [ego.moving.speed, foe.moving.speed];
        conflicting_speed(speeds, [ego.acceleration, foe.acceleration], self.step)
    }
}
