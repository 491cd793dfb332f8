//! The kind and the severity of a conflict.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

use crate::options::thresholds::KindBounds;
use crate::util::units::Radian;
use crate::util::variants::array;

/// How the two road users of a pair meet, by the angle between their headings at the conflict point.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Kind {
    /// The ego runs into a foe that drives in the same direction.
    #[cfg_attr(feature = "clap", value(alias = "rear-end"))]
    RearEnd,
    /// Both drive towards each other.
    Frontal,
    /// The ego runs into a foe that crosses its path.
    Side,
}

impl Kind {
    /// All kinds, in the order used in tables.
    pub const ALL: [Self; Self::VARIANTS.len()] = array(Self::VARIANTS);

    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The kind at an angle α between the headings.
    pub fn at(angle: Radian, bounds: KindBounds) -> Self {
        if angle < bounds.rear_end_below {
            Self::RearEnd
        } else if angle > bounds.frontal_above {
            Self::Frontal
        } else {
            Self::Side
        }
    }

    /// σ = cos α at the kind's typical angle: 0, 90 or 180 degrees.
    pub fn sigma(self) -> f64 {
        match self {
            Self::RearEnd => 1.0,
            Self::Side => 0.0,
            Self::Frontal => -1.0,
        }
    }
}

/// How severe a conflict is.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Severity {
    /// Neither serious nor critical.
    Caution,
    /// The driver brakes too late with some probability, or thresholds are passed: by the rule of the options.
    Serious,
    /// Even braking fully at once is too late, or a collision.
    Critical,
}

impl Severity {
    /// All severities, mildest first.
    pub const ALL: [Self; Self::VARIANTS.len()] = array(Self::VARIANTS);

    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }
}
