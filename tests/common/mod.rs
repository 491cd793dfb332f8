//! What tests across modules share.

use closecall::braking::Brakes;
use closecall::profile::{Category, Profile};

/// A car of 5 m by 2 m.
pub fn car() -> Profile {
    Profile {
        name: "car".to_owned(),
        category: Category::Vehicle,
        length: 5.0,
        width: 2.0,
        chord: 5.0,
        mass: 1500.0,
        brakes: Brakes { response: 1.0, build_up: 0.1, deceleration: 8.0 },
    }
}
