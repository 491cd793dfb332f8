//! SUMO's reason for a lane change.

use serde::{Serialize, Serializer};
use strum::{IntoStaticStr, VariantArray};

/// Why a vehicle changed lanes, in the order in which reasons are looked for: SUMO may give several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum LaneChangeReason {
    /// A script told it to.
    Traci,
    /// Its route goes on from the other lane.
    Strategic,
    /// It made room for another.
    Cooperative,
    /// It drives faster there.
    SpeedGain,
    /// It keeps to the side of slow traffic.
    KeepRight,
    /// It moved aside within the sublane model.
    Sublane,
}

impl LaneChangeReason {
    /// The reason in SUMO's state of a lane change (`vehicle.getLaneChangeState`); none where it tells none.
    pub fn of(state: i32) -> Option<Self> {
        Self::VARIANTS.iter().copied().find(|reason| state & reason.bit() != 0)
    }

    /// SUMO's LCA_TRACI, LCA_STRATEGIC, …
    fn bit(self) -> i32 {
        match self {
            Self::Strategic => 1 << 3,
            Self::Cooperative => 1 << 4,
            Self::SpeedGain => 1 << 5,
            Self::KeepRight => 1 << 6,
            Self::Traci => 1 << 7,
            Self::Sublane => 1 << 15,
        }
    }

    /// The name in columns.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

impl Serialize for LaneChangeReason {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_of_sumo_has_its_reason() {
        let reasons = [266, 2 | 1 << 5, 4 | 1 << 6, 2 | 1 << 4 | 1 << 8, 2 | 1 << 15, 2 | 1 << 3 | 1 << 7, 2, 0]
            .map(|state| LaneChangeReason::of(state).map_or("", LaneChangeReason::name));
        assert_eq!(reasons, ["strategic", "speed_gain", "keep_right", "cooperative", "sublane", "traci", "", ""]);
    }
}
