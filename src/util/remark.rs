//! A remark on a result: what its reader should know before believing it. The code is for programs, the text for people.

use std::fmt;

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

/// What a remark is about; docs/log.md lists the codes.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
#[non_exhaustive]
pub enum RemarkCode {
    /// Lanes are longer or shorter than they are drawn.
    LaneLengths,
    /// Lanes overlap as drawn.
    LanesOverlap,
    /// Vehicles cut corners of pavements as drawn.
    CornersCut,
    /// The steps are long.
    LongSteps,
    /// A recording lacks something that had to be assumed.
    MissingData,
    /// Something in a recording is doubtful.
    DoubtfulData,
    /// A setting is for a vehicle type that never appeared.
    UnusedSetting,
    /// The run ended before its warm-up.
    OnlyWarmUp,
    /// Vehicles follow more closely, by their types, than the model's drivers could respond.
    OrdinaryFollowing,
    /// Vehicles brake harder than any tyre holds.
    HardBraking,
    /// SUMO drives road users through each other.
    NetFaults,
    /// Types of a recording are not defined.
    UndefinedTypes,
    /// Vehicles of a recording are beside the net's lanes.
    UnknownLanes,
    /// The routes of a recording have gaps.
    UnknownRoutes,
    /// A recording has elements other than road users.
    OtherElements,
    /// Speeds of a recording are below zero.
    NoisySpeeds,
    /// Where the earlier log of a folder is kept.
    EarlierLog,
    /// A remark of a later version.
    #[serde(other)]
    Other,
}

impl RemarkCode {
    /// The name in `run.json`.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Whether the commands print it before the first step; the rest is printed at the end.
    pub const fn is_of_opening(self) -> bool {
        matches!(
            self,
            Self::LaneLengths
                | Self::LanesOverlap
                | Self::CornersCut
                | Self::LongSteps
                | Self::MissingData
                | Self::DoubtfulData
        )
    }
}

/// A remark.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remark {
    /// What it is about.
    pub code: RemarkCode,
    /// The same in words, one line.
    pub text: String,
}

impl Remark {
    /// A remark of one line.
    pub fn new(code: RemarkCode, text: impl Into<String>) -> Self {
        Self { code, text: text.into() }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.text)
    }
}
