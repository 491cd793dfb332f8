//! The causes of a conflict that closecall knows, by name; `evidence` finds them.

use std::fmt;

use serde::{Serialize, Serializer};
use strum::{IntoStaticStr, VariantArray};

use super::manoeuvre::Manoeuvre;

/// Why a conflict came about, in the order of the evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[strum(serialize_all = "snake_case")]
pub enum Cause {
    /// One drove, or walked, into the junction on red.
    RanRed,
    /// One drove into the junction on amber although it could have stopped.
    LateAmber,
    /// One drove on although it had to yield.
    DidNotYield,
    /// One changed lanes into that of the other.
    ChangedLane,
    /// One overtook on the lane of oncoming traffic.
    Overtook,
    /// A person walked across outside a crossing.
    OutsideCrossing,
    /// An obstacle stood in the way, or a vehicle at a scheduled stop.
    Stood,
    /// A queue ended where the line of sight to it left the road.
    BehindCurve,
    /// The leader braked hard.
    LeaderBraked,
    /// The follower kept too short a distance.
    TooClose,
    /// One drove faster than its lane allows.
    TooFast,
    /// One was just inserted by SUMO (artefact).
    Appeared,
}

/// Several causes, in the order of the evidence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Causes(u16);

impl Cause {
    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

impl Causes {
    /// Whether there is this cause.
    pub fn has(self, cause: Cause) -> bool {
        self.0 & (1 << cause as u16) != 0
    }

    /// Adds those of another step.
    pub fn add(&mut self, others: Self) {
        self.0 |= others.0;
    }

    /// Those that tell how one entered the junction.
    pub(crate) fn at_the_entry(self) -> Self {
        let entry = [Cause::RanRed, Cause::LateAmber, Cause::DidNotYield].into_iter().collect::<Self>();
        Self(self.0 & entry.0)
    }

    /// The same where, besides, one of the two stood at a scheduled stop.
    pub(crate) fn with_stops(mut self, manoeuvre: Option<Manoeuvre>) -> Self {
        self.add_if(Cause::Stood, true);
        self.plausible_for(manoeuvre)
    }

    /// Those without what only another manoeuvre than this is.
    pub(super) fn plausible_for(self, manoeuvre: Option<Manoeuvre>) -> Self {
        let fits = |cause| match cause {
            Cause::ChangedLane => matches!(manoeuvre, Some(Manoeuvre::CutIn | Manoeuvre::LaneChange)),
            Cause::Overtook => manoeuvre == Some(Manoeuvre::OvertakingOncoming),
            Cause::OutsideCrossing => manoeuvre == Some(Manoeuvre::PersonCrossing),
            // A vehicle at a scheduled stop is not the end of a queue.
            Cause::BehindCurve => manoeuvre == Some(Manoeuvre::Following) && !self.has(Cause::Stood),
            Cause::LeaderBraked => {
                matches!(manoeuvre, None | Some(Manoeuvre::Following | Manoeuvre::CutIn | Manoeuvre::LaneChange))
            }
            _ => true,
        };
        Cause::VARIANTS.iter().copied().filter(|cause| self.has(*cause) && fits(*cause)).collect()
    }

    pub(super) fn add_if(&mut self, cause: Cause, is_there: bool) {
        self.0 |= u16::from(is_there) << cause as u16;
    }
}

impl FromIterator<Cause> for Causes {
    fn from_iter<I: IntoIterator<Item = Cause>>(causes: I) -> Self {
        Self(causes.into_iter().fold(0, |bits, cause| bits | 1 << cause as u16))
    }
}

impl fmt::Display for Causes {
    fn fmt(&self, to: &mut fmt::Formatter) -> fmt::Result {
        let mut between = "";
        for cause in Cause::VARIANTS.iter().copied().filter(|cause| self.has(*cause)) {
            write!(to, "{between}{}", cause.name())?;
            between = " ";
        }
        Ok(())
    }
}

impl Serialize for Causes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
