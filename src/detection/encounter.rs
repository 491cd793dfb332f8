//! What the detector finds in one step: pairs that would meet, measured.

use super::kind::{Kind, Severity};
use crate::traffic::net::LaneIndex;
use crate::traffic::roster::UserIndex;
use crate::util::units::{Metre, MetrePerSecondSquared, Radian, Second};

/// A pair that would meet, in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// The one with the longer way to the meeting place.
    pub ego: UserIndex,
    /// The other one.
    pub foe: UserIndex,
    /// The ego's row in the frame.
    pub ego_row: u32,
    /// The foe's row in the frame.
    pub foe_row: u32,
    /// How they would meet.
    pub kind: Kind,
    /// Angle α between the headings at the meeting place, 0 to π.
    pub angle: Radian,
    /// The room that is left.
    pub gap: Metre,
    /// The minimal collision distance.
    pub mu: Metre,
    /// gap − μ: below 0 the pair is in conflict.
    pub margin: Metre,
    /// Way of the ego to the meeting place.
    pub ego_distance: Metre,
    /// Way of the foe until it is at the meeting place or (cos α > 0) has left it.
    pub foe_distance: Metre,
    /// The ego's front-bumper centre at the meeting place, x.
    pub x: Metre,
    /// The ego's front-bumper centre at the meeting place, y.
    pub y: Metre,
    /// The lane of the meeting place, on the ego's path; none without a net.
    pub lane: Option<LaneIndex>,
    /// Whether the rectangles overlap now.
    pub collision: bool,
    /// What only pairs in conflict have; none where margin ≥ 0.
    pub nearness: Option<Nearness>,
}

/// How near the two of a pair in conflict are, in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearness {
    /// Smallest distance between the two rectangles now.
    pub clearance: Metre,
    /// Time to collision at the speeds of now, along the paths; none if they never touch.
    pub ttc: Option<Second>,
    /// Deceleration that the ego needs to just avoid contact; none where they touch now or, at the speeds of now, never.
    pub drac: Option<MetrePerSecondSquared>,
    /// The worst of what the values above say.
    pub severity: Severity,
}

impl Encounter {
    /// Whether the gap is smaller than μ.
    pub fn in_conflict(&self) -> bool {
        self.margin < 0.0
    }
}
