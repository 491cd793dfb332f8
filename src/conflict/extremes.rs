//! What is known of an event under way: the step with the smallest margin, and the extremes of all its steps.

use super::event::Moment;
use super::stance::Stood;
use crate::encounter::{Encounter, Kind, Severity};
use crate::frame::{Frame, UserIndex};
use crate::geometry::Point;
use crate::net::LaneIndex;
use crate::units::{Metre, MetrePerSecond, Radian, Second};

/// Margins that differ by less than this are equal, in m: a pair that keeps its speeds has the same in every step.
const SAME_MARGIN: Metre = 1e-9;

/// One step of a pair.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    pub frame: &'a Frame,
    pub found: &'a Encounter,
}

/// The extremes so far; of which values a [`super::Conflict`] says.
#[derive(Debug)]
pub(super) struct Extremes {
    pub begin: Second,
    pub end: Second,
    pub severity: Severity,
    pub collision: bool,
    pub clearance: Metre,
    pub ttc: Option<Extreme>,
    pub drac: Option<Extreme>,
    pub worst: Worst,
}

/// A value, when and where that was.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extreme {
    pub value: f64,
    pub moment: Moment,
}

/// The step with the smallest margin.
#[derive(Debug)]
pub(super) struct Worst {
    pub ego: UserIndex,
    pub foe: UserIndex,
    pub kind: Kind,
    pub time: Second,
    pub gap: Metre,
    pub mu: Metre,
    pub margin: Metre,
    pub angle: Radian,
    pub x: Metre,
    pub y: Metre,
    pub lane: Option<LaneIndex>,
    /// The ego's and the foe's.
    pub speeds: [MetrePerSecond; 2],
    /// The same.
    pub stood: [Stood; 2],
}

impl Seen<'_> {
    /// The severity of this step.
    pub fn severity(&self) -> Severity {
        self.found.nearness.map_or(Severity::Caution, |near| near.severity)
    }

    fn clearance(&self) -> Metre {
        self.found.nearness.map_or(f64::INFINITY, |near| near.clearance)
    }

    fn ttc(&self) -> Option<Extreme> {
        self.extreme(self.found.nearness?.ttc?)
    }

    fn drac(&self) -> Option<Extreme> {
        self.extreme(self.found.nearness?.drac?)
    }

    fn extreme(&self, value: f64) -> Option<Extreme> {
        let Encounter { x, y, ego_row, .. } = *self.found;
        let moment = Moment { time: self.frame.time, x, y, speed: self.frame.state(ego_row).speed };
        Some(Extreme { value, moment })
    }
}

impl Worst {
    /// This step; `path` has the path of a row's front bumper.
    fn of(&Seen { frame, found }: &Seen, path: &impl Fn(u32) -> Vec<Point>) -> Self {
        let Encounter { ego, foe, kind, gap, mu, margin, angle, x, y, lane, .. } = *found;
        let rows = [found.ego_row, found.foe_row];
        let speeds = rows.map(|row| frame.state(row).speed);
        let stood = rows.map(|row| Stood::of(frame.state(row), &path(row)));
        Self { ego, foe, kind, time: frame.time, gap, mu, margin, angle, x, y, lane, speeds, stood }
    }
}

impl Extremes {
    /// Those of a first step; `path` has the path of a row's front bumper.
    pub fn of(seen: &Seen, path: &impl Fn(u32) -> Vec<Point>) -> Self {
        Self {
            begin: seen.frame.time,
            end: seen.frame.time,
            severity: seen.severity(),
            collision: seen.found.collision,
            clearance: seen.clearance(),
            ttc: seen.ttc(),
            drac: seen.drac(),
            worst: Worst::of(seen, path),
        }
    }

    /// Adds a later step of the same event.
    pub fn take(&mut self, seen: &Seen, path: &impl Fn(u32) -> Vec<Point>) {
        // Of margins that only rounding tells apart the first stays.
        if seen.found.margin < self.worst.margin - SAME_MARGIN {
            self.worst = Worst::of(seen, path);
        }
        self.end = seen.frame.time;
        self.severity = self.severity.max(seen.severity());
        self.clearance = self.clearance.min(seen.clearance());
        self.collision |= seen.found.collision;
        take_if(&mut self.ttc, seen.ttc(), f64::lt);
        take_if(&mut self.drac, seen.drac(), f64::gt);
    }
}

/// Takes the value of a step where it is beyond the one known so far.
fn take_if(known: &mut Option<Extreme>, now: Option<Extreme>, is_beyond: fn(&f64, &f64) -> bool) {
    let Some(now) = now else { return };
    if known.is_none_or(|known| is_beyond(&now.value, &known.value)) {
        *known = Some(now);
    }
}
