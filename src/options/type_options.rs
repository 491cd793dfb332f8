//! Settings of one vehicle type.

use serde::{Deserialize, Serialize};

use super::driver_presets::DriverOptions;
use crate::util::limits::{DECELERATION, DURATION, LENGTH, MASS, WIDTH};
use crate::util::units::{Kilogram, Metre, MetrePerSecondSquared, Second};

/// The brake system of a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrakeSystem {
    /// Cars, bicycles, motorcycles.
    Hydraulic,
    /// Trucks, buses, coaches, trailers.
    Pneumatic,
}

/// Settings of one vehicle type in the TOML file. Absent values come from SUMO or the general settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TypeOptions {
    /// Response time t1 of the driver in s.
    pub response_time: Option<Second>,
    /// Brake coordination time t2 in s.
    pub brake_delay: Option<Second>,
    /// Build-up time t3 in s.
    pub build_up: Option<Second>,
    /// Deceleration in m/s².
    pub decel: Option<MetrePerSecondSquared>,
    /// Brake system, which determines t2 if `brake_delay` is absent.
    pub brakes: Option<BrakeSystem>,
    /// Length in m.
    pub length: Option<Metre>,
    /// Width in m.
    pub width: Option<Metre>,
    /// Mass in kg.
    pub mass: Option<Kilogram>,
    /// Its drivers.
    #[serde(default)]
    pub driver: DriverOptions,
}

impl TypeOptions {
    /// Checks the values that are set.
    ///
    /// # Errors
    /// A text that names the value and what it must be.
    pub fn check(&self) -> Result<(), String> {
        for (name, value, limit) in [
            ("response_time", self.response_time, &DURATION),
            ("brake_delay", self.brake_delay, &DURATION),
            ("build_up", self.build_up, &DURATION),
            ("decel", self.decel, &DECELERATION),
            ("length", self.length, &LENGTH),
            ("width", self.width, &WIDTH),
            ("mass", self.mass, &MASS),
        ] {
            value.map_or(Ok(0.0), |value| limit.check(name, value))?;
        }
        self.driver.check().map_err(|why| format!("driver: {why}"))
    }
}
