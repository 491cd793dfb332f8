//! One conflict: how the steps of a pair become its extremes.

use serde::Serialize;
use smol_str::SmolStr;

use super::Stance;
use super::pet::Pet;
use crate::encounter::{Encounter, Kind, Severity};
use crate::frame::{Frame, ProfileIndex, Roster, UserIndex};
use crate::geometry::Point;
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
    pub ego: SmolStr,
    /// SUMO's id of the foe.
    pub foe: SmolStr,
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

/// What the extremes of a conflict are found from: one step of a pair.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub frame: &'a Frame,
    pub roster: &'a Roster,
    pub found: &'a Encounter,
}

impl Seen<'_> {
    /// The severity of this step.
    pub fn severity(&self) -> Severity {
        self.found.nearness.map_or(Severity::Caution, |near| near.severity)
    }

    fn clearance(&self) -> Metre {
        self.found.nearness.map_or(f64::INFINITY, |near| near.clearance)
    }

    fn ttc(&self) -> Option<Second> {
        self.found.nearness.and_then(|near| near.ttc)
    }

    fn drac(&self) -> Option<MetrePerSecondSquared> {
        self.found.nearness.and_then(|near| near.drac)
    }

    fn moment(&self) -> Moment {
        let Encounter { x, y, ego_row, .. } = *self.found;
        Moment { time: self.frame.time, x, y, speed: self.frame.state(ego_row).speed }
    }
}

impl Conflict {
    /// One step of a pair as a conflict of its own; `path` has the path of a row's front bumper.
    pub(super) fn of(seen: &Seen, path: &impl Fn(u32) -> Vec<Point>) -> Self {
        let &Seen { frame, roster, found } = seen;
        let part = |user: UserIndex, row: u32| (frame.state(row).speed, roster.profile_of(user).mass);
        let (ego, foe) = (part(found.ego, found.ego_row), part(found.foe, found.foe_row));
        Self {
            ego: roster.id(found.ego).clone(),
            foe: roster.id(found.foe).clone(),
            ego_profile: roster.type_of(found.ego),
            foe_profile: roster.type_of(found.foe),
            kind: found.kind,
            severity: seen.severity(),
            begin: frame.time,
            end: frame.time,
            time: frame.time,
            gap: found.gap,
            mu: found.mu,
            margin: found.margin,
            clearance: seen.clearance(),
            ttc: seen.ttc(),
            drac: seen.drac(),
            pet: None,
            delta_v: measures::delta_v(ego, foe, found.angle),
            ego_speed: ego.0,
            foe_speed: foe.0,
            angle: found.angle,
            x: found.x,
            y: found.y,
            lane: found.lane,
            collision: found.collision,
            ego_stance: Stance::of(frame, roster, found.ego_row, &path(found.ego_row)),
            foe_stance: Stance::of(frame, roster, found.foe_row, &path(found.foe_row)),
            found: [seen.ttc(), seen.drac(), None].map(|value| value.map(|_| seen.moment())),
        }
    }

    /// Adds a later step of the same event.
    pub(super) fn take(&mut self, seen: &Seen, path: &impl Fn(u32) -> Vec<Point>) {
        // Of margins that only rounding tells apart the first stays.
        if seen.found.margin < self.margin - SAME_MARGIN {
            let Self { severity, begin, clearance, ttc, drac, collision, found, .. } = *self;
            *self = Self { severity, begin, clearance, ttc, drac, collision, found, ..Self::of(seen, path) };
        }
        self.end = seen.frame.time;
        self.severity = self.severity.max(seen.severity());
        self.clearance = self.clearance.min(seen.clearance());
        self.collision |= seen.found.collision;
        let [ttc_found, drac_found, _] = &mut self.found;
        take_if(&mut self.ttc, ttc_found, seen, seen.ttc(), f64::lt);
        take_if(&mut self.drac, drac_found, seen, seen.drac(), f64::gt);
    }

    /// Sets the PET and the time at which the second enters.
    pub(super) fn set_pet(&mut self, found: Option<Pet>) {
        self.pet = found.map(|pet| pet.lasts);
        self.found[2] = found.map(|pet| Moment { time: pet.enters, x: self.x, y: self.y, speed: self.ego_speed });
    }
}

/// Takes the value of a step, and when and where that was, where it is beyond the one known so far.
fn take_if(
    known: &mut Option<f64>,
    found: &mut Option<Moment>,
    seen: &Seen,
    value: Option<f64>,
    is_beyond: fn(&f64, &f64) -> bool,
) {
    let Some(now) = value else { return };
    if known.is_none_or(|known| is_beyond(&now, &known)) {
        (*known, *found) = (value, Some(seen.moment()));
    }
}
