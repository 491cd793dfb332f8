//! One conflict: how the steps of a pair become its extremes.

use std::sync::Arc;

use serde::Serialize;

use super::Stance;
use crate::encounter::{Encounter, Kind, Severity};
use crate::frame::{Frame, ProfileIndex, Roster, UserIndex};
use crate::measures;
use crate::net::LaneIndex;
use crate::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// Margins that differ by less than this are equal, in m: a pair that keeps its speeds has the same in every step.
const SAME_MARGIN: Metre = 1e-9;

/// One conflict: a pair and a run of steps with margin < 0.
///
/// Everything from `time` on is of the step with the smallest margin, except `clearance`, `ttc`, `drac` and `pet`,
/// which are the event's extremes, and `severity`, its worst.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Conflict {
    /// SUMO's id of the ego.
    pub ego: Arc<str>,
    /// SUMO's id of the foe.
    pub foe: Arc<str>,
    /// The ego's type.
    #[serde(skip)]
    pub ego_profile: ProfileIndex,
    /// The foe's type.
    #[serde(skip)]
    pub foe_profile: ProfileIndex,
    /// The kind at the smallest margin.
    pub kind: Kind,
    /// The worst over the event.
    pub severity: Severity,
    /// First step with margin < 0, in s.
    pub begin: Second,
    /// Last step with margin < 0, in s.
    pub end: Second,
    /// The step with the smallest margin, in s.
    pub time: Second,
    /// The room that was left, in m.
    pub gap: Metre,
    /// The minimal collision distance, in m.
    pub mu: Metre,
    /// gap − μ, in m.
    pub margin: Metre,
    /// Smallest distance between the two rectangles, in m.
    pub clearance: Metre,
    /// Smallest time to collision, in s.
    pub ttc: Option<Second>,
    /// Largest deceleration rate to avoid the collision, in m/s².
    pub drac: Option<MetrePerSecondSquared>,
    /// Post-encroachment time, in s; side and frontal only.
    pub pet: Option<Second>,
    /// Speed change of the ego in a fully inelastic collision, in m/s.
    pub delta_v: MetrePerSecond,
    /// Speed of the ego, in m/s.
    pub ego_speed: MetrePerSecond,
    /// Speed of the foe, in m/s.
    pub foe_speed: MetrePerSecond,
    /// Angle α at the meeting place, in rad.
    pub angle: Radian,
    /// The ego's front-bumper centre at the meeting place, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// The lane of the meeting place.
    #[serde(skip)]
    pub lane: Option<LaneIndex>,
    /// Whether the rectangles overlapped in any step.
    pub collision: bool,
    /// Where the ego stood and was about to go.
    #[serde(skip)]
    pub ego_stance: Stance,
    /// The same of the foe.
    #[serde(skip)]
    pub foe_stance: Stance,
    /// When and where `ttc`, `drac` and `pet` were found.
    #[serde(skip)]
    pub found: [Option<Moment>; 3],
}

/// When and where an extreme was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time, in s; for the PET, when the second enters the conflict area.
    pub time: Second,
    /// The ego's front-bumper centre at the meeting place of that step, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// Speed of the ego in that step, in m/s; for the PET, in the step with the smallest margin.
    pub speed: MetrePerSecond,
}

/// One step of a pair as a conflict of its own.
pub(super) fn moment(frame: &Frame, roster: &Roster, found: &Encounter) -> Conflict {
    let part = |user: UserIndex, row: u32| (frame.state(row).speed, roster.profile_of(user).mass);
    let (ego, foe) = (part(found.ego, found.ego_row), part(found.foe, found.foe_row));
    let near = found.nearness.as_ref();
    Conflict {
        ego: roster.id(found.ego).clone(),
        foe: roster.id(found.foe).clone(),
        ego_profile: roster.type_of(found.ego),
        foe_profile: roster.type_of(found.foe),
        kind: found.kind,
        severity: near.map_or(Severity::Caution, |near| near.severity),
        begin: frame.time,
        end: frame.time,
        time: frame.time,
        gap: found.gap,
        mu: found.mu,
        margin: found.margin,
        clearance: near.map_or(f64::INFINITY, |near| near.clearance),
        ttc: near.and_then(|near| near.ttc),
        drac: near.and_then(|near| near.drac),
        pet: None,
        delta_v: measures::delta_v(ego, foe, found.angle),
        ego_speed: ego.0,
        foe_speed: foe.0,
        angle: found.angle,
        x: found.x,
        y: found.y,
        lane: found.lane,
        collision: found.collision,
        ego_stance: Stance::of(frame, roster, found.ego_row),
        foe_stance: Stance::of(frame, roster, found.foe_row),
        found: [near.and_then(|near| near.ttc), near.and_then(|near| near.drac), None]
            .map(|value| value.map(|_| Moment { time: frame.time, x: found.x, y: found.y, speed: ego.0 })),
    }
}

impl Conflict {
    /// Whether the margin of a step is the smallest so far: that of equal ones the first stays, whatever rounding says.
    pub(super) fn is_narrower_than(&self, so_far: &Self) -> bool {
        self.margin < so_far.margin - SAME_MARGIN
    }

    /// Adds a later step of the same event.
    pub(super) fn take(&mut self, now: Self) {
        let extremes = Self {
            severity: self.severity.max(now.severity),
            begin: self.begin,
            end: now.end,
            clearance: self.clearance.min(now.clearance),
            ttc: least(self.ttc, now.ttc),
            drac: least(self.drac.map(|drac| -drac), now.drac.map(|drac| -drac)).map(|drac| -drac),
            collision: self.collision || now.collision,
            found: [
                earlier(self.ttc, now.ttc, self.found[0], now.found[0], f64::lt),
                earlier(self.drac, now.drac, self.found[1], now.found[1], f64::gt),
                None,
            ],
            ..if now.is_narrower_than(self) { now } else { self.clone() }
        };
        *self = extremes;
    }

    /// Sets the PET and the time at which the second enters.
    pub(super) fn set_pet(&mut self, found: Option<(Second, Second)>) {
        self.pet = found.map(|(pet, _)| pet);
        self.found[2] = found.map(|(_, time)| Moment { time, x: self.x, y: self.y, speed: self.ego_speed });
    }
}

/// The moment of what was known, or of what is now where that is beyond it.
fn earlier(
    known: Option<f64>,
    now: Option<f64>,
    then: Option<Moment>,
    here: Option<Moment>,
    beyond: fn(&f64, &f64) -> bool,
) -> Option<Moment> {
    match (known, now) {
        (Some(known), Some(now)) => {
            if beyond(&now, &known) {
                here
            } else {
                then
            }
        }
        (known, _) => {
            if known.is_some() {
                then
            } else {
                here
            }
        }
    }
}

fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
