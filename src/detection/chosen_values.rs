//! The values of a pair in a step of the measures that a log has only if they are chosen.
//!
//! What an event makes of the values of its steps (the smallest, the integral, …) is in [`crate::events`].

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
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

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
}

/// How long the chosen measures follow both of a pair along their paths; none where they do not.
pub(super) fn need_courses(measures: Measures, found: &Encounter) -> Option<Second> {
    use ChosenMeasure::{ALatReq, Stn, T2, Tadv};
    let has = |any: [ChosenMeasure; 2]| any.into_iter().any(|measure| measures.has(measure));
    match (found.kind, found.nearness.and_then(|nearness| nearness.ttc)) {
        (Kind::Frontal | Kind::Side, None) if has([Tadv, T2]) => Some(HORIZON),
        (Kind::RearEnd | Kind::Frontal, Some(ttc)) if has([ALatReq, Stn]) && ttc > 0.0 => Some(ttc),
        _ => None,
    }
}

impl PairInStep<'_> {
    /// The values of the chosen measures.
    pub fn values(&self, measures: Measures) -> ChosenValues {
        let is_ahead = measures.has(ChosenMeasure::Tadv) || measures.has(ChosenMeasure::T2);
        let advantage = if is_ahead { self.advantage() } else { None };
        // It tells an event in which step braking begins.
        let has_onset = [ChosenMeasure::Ta, ChosenMeasure::TaLevel].into_iter().any(|measure| measures.has(measure));
        ChosenMeasure::ALL.map(|measure| {
            let is_needed = has_onset && measure == ChosenMeasure::ConflictingSpeed;
            if measures.has(measure) || is_needed {
                self.value(measure, advantage).filter(|value| value.is_finite())
            } else {
                None
            }
        })
    }

    fn value(&self, measure: ChosenMeasure, advantage: Option<Advantage>) -> Option<f64> {
        let Self { found, ego, foe, .. } = *self;
        let kind = found.kind;
        let speeds = [ego.moving.speed, foe.moving.speed];
        let drac = || found.nearness?.drac;
        match measure {
            ChosenMeasure::Tadv => advantage.map(|advantage| advantage.tadv),
            ChosenMeasure::T2 => advantage.map(|advantage| advantage.t2),
            ChosenMeasure::RssDistance => self.rss_distance(),
            ChosenMeasure::RssLateralDistance => self.rss_lateral_distance(),
            ChosenMeasure::RssViolation => self.rss_distance().map(|safe| f64::from(found.gap < safe)),
            ChosenMeasure::Thw => headway::time_headway(kind, found.gap, foe.of.length, speeds[0]),
            ChosenMeasure::Sgap => self.behind().map(|_| found.gap),
            ChosenMeasure::Br => Some(-ego.acceleration).filter(|braking| *braking > 0.0),
            ChosenMeasure::Mdrac => mdrac::mdrac(found.gap, speeds[0] - self.behind()?.speed),
            ChosenMeasure::Mttc => self.mttc().map(|(time, _)| time),
            ChosenMeasure::CrashIndex => self.mttc()?.1,
            ChosenMeasure::Tet => Some(exposure::exposed(self.ttc())),
            ChosenMeasure::Tit => Some(exposure::lacks(self.ttc())),
            ChosenMeasure::Cpi if found.collision => Some(1.0),
            ChosenMeasure::Cpi => Some(crash_potential::exceeds_brakes(&ego.of.driver, drac())),
            ChosenMeasure::ALongReq => self.required_braking(),
            ChosenMeasure::ALatReq => self.required_steering(),
            ChosenMeasure::Btn => self.required_braking().map(|needed| needed / ego.of.brakes.deceleration),
            ChosenMeasure::Stn => self.required_steering().map(|needed| needed / ego.of.brakes.deceleration),
            ChosenMeasure::Ta => self.conflicting_speed().and(self.time_to_accident()),
            ChosenMeasure::ConflictingSpeed => self.conflicting_speed(),
            ChosenMeasure::TaLevel => {
                self.conflicting_speed().zip(self.time_to_accident()).map(|(speed, ta)| accident::level(ta, speed))
            }
            ChosenMeasure::MaxS => Some(speeds[0].max(speeds[1])),
            ChosenMeasure::DeltaS => self.ttc().map(|_| delta_s(&ego.moving, &foe.moving)),
            ChosenMeasure::Dr | ChosenMeasure::MaxD => Some(ego.acceleration),
            ChosenMeasure::Act => self.in_plane().and_then(|[ego, foe]| anticipated_collision_time(ego, foe)),
            ChosenMeasure::Ei => self.in_plane().and_then(|[ego, foe]| emergency_index(ego, foe)),
        }
    }

    fn ttc(&self) -> Option<Second> {
        self.found.nearness?.ttc
    }

    /// The foe's motion along the ego's path, if the ego follows it.
    fn behind(&self) -> Option<Accelerating> {
        let sigma = self.found.angle.cos();
        let Self { foe: UserInStep { moving, acceleration, .. }, .. } = self;
        let leader = Accelerating { speed: sigma * moving.speed, acceleration: sigma * acceleration };
        (self.found.kind == Kind::RearEnd).then_some(leader)
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
            None => self.found.nearness?.drac,
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
