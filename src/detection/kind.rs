//! What kind of conflict a pair is in, and how severe it is.

use serde::{Deserialize, Serialize};

use crate::options::Options;
use crate::util::units::Radian;

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

/// The kind of a conflict at this angle.
pub fn kind_at(angle: Radian, options: &Options) -> Kind {
    if angle < options.rear_end_below {
        Kind::RearEnd
    } else if angle > options.frontal_above {
        Kind::Frontal
    } else {
        Kind::Side
    }
}
