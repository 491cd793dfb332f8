//! What the detector finds in one step: pairs that would meet, measured.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::frame::UserIndex;
use crate::net::{EdgeIndex, LaneIndex};
use crate::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// How the two would meet, by the angle between their headings at the meeting place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub enum Kind {
    /// The ego runs into a foe that drives the same way.
    RearEnd,
    /// Both drive towards each other.
    Frontal,
    /// The ego runs into a foe that crosses its way.
    Side,
}

impl Kind {
    /// All kinds, in the order of tables.
    pub const ALL: [Self; 3] = [Self::RearEnd, Self::Frontal, Self::Side];

    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::RearEnd => "rear_end",
            Self::Frontal => "frontal",
            Self::Side => "side",
        }
    }

    /// σ = cos α of the kind's own angle.
    pub fn sigma(self) -> f64 {
        match self {
            Self::RearEnd => 1.0,
            Self::Side => 0.0,
            Self::Frontal => -1.0,
        }
    }
}

/// How bad a conflict is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Margin below 0.
    Caution,
    /// TTC below 1.5 s or DRAC above 3.4 m/s².
    Serious,
    /// DRAC above what the ego's brakes can do, or a collision.
    Critical,
}

impl Severity {
    /// All severities, mildest first.
    pub const ALL: [Self; 3] = [Self::Caution, Self::Serious, Self::Critical];

    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Caution => "caution",
            Self::Serious => "serious",
            Self::Critical => "critical",
        }
    }
}

/// Where on the net a road user is, and where it is going: what the path along the lanes starts from.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// The lane that its front bumper is on.
    pub lane: LaneIndex,
    /// Its front bumper's way from the lane's beginning, in SUMO's lane length, in m.
    pub position: Metre,
    /// Its route, where that is new or may have changed; none where it has not, or nobody knows one.
    pub route: Option<Arc<[EdgeIndex]>>,
    /// Which edge of the route it is on, or left last when it is within a junction.
    pub route_position: usize,
    /// Speed to the left across the lane, in m/s; other than 0 while a lane change is under way.
    pub lateral_speed: MetrePerSecond,
}

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
    pub ego_way: Metre,
    /// Way of the foe until it is at the meeting place or (cos α > 0) has left it.
    pub foe_way: Metre,
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
