//! The settings of the method: name, default, unit and source.
//!
//! One struct serves the command line (clap, with the feature of that name), the TOML file and Python. `closecall-run` adds
//! those of the log, and parses both.

mod align;
mod choices;
mod clip_level;
pub mod condition;
mod defaults;
mod driver_presets;
pub mod measures;
mod severity_rule;
pub mod shortcut;
pub mod thresholds;
mod type_options;
#[cfg(feature = "clap")]
mod values;

use rustc_hash::FxHashMap;
use serde::Serialize;

use crate::braking::MuModel;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};
use crate::{Error, Result};
use condition::Condition;
use defaults::{
    CONTACT_TOLERANCE, FRONTAL_ABOVE, HYDRAULIC_DELAY, PNEUMATIC_DELAY, REAR_END_BELOW, RESPONSE_TIME, SERIOUS_DELTA_V,
    SERIOUS_DRAC, SERIOUS_PROBABILITY, SERIOUS_TTC,
};
use measures::Measures;
use shortcut::Shortcut;

pub use align::Align;
pub use choices::{Deceleration, Mode, PathModel};
pub use clip_level::ClipLevel;
pub use defaults::{BUILD_UP, EPSILON, RESPONSE};
pub use driver_presets::{DriverModel, DriverOptions};
pub use severity_rule::SeverityRule;
pub use type_options::{BrakeSystem, TypeOptions};
#[cfg(feature = "clap")]
pub use values::{
    angle, deceleration, deceleration_threshold, duration, probability, reserve, share, speed, step_length, time,
};

/// The settings of the method: what a conflict is, and how it is measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Model"))]
pub struct Options {
    /// Method that finds conflicts: closecall's own, or the paper's flow chart as printed.
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t))]
    pub mode: Mode,
    /// Model of the minimal collision distance μ.
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t))]
    pub mu: MuModel,
    /// Expected path of a braking road user; without a net, `lanes` means straight on. `driven` is for recordings only.
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t))]
    pub path: PathModel,
    /// SUMO attribute that sets the deceleration of a vehicle type without a value of its own.
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t))]
    pub decel: Deceleration,
    /// Response time t1 of the driver, in s (Guan et al. 2008, fig. 4).
    #[cfg_attr(feature = "clap", arg(long, value_name = "S", default_value_t = RESPONSE_TIME, value_parser = duration))]
    pub response_time: Second,
    /// Brake coordination time t2 of hydraulic brakes, in s (the paper's lower bound).
    #[cfg_attr(feature = "clap", arg(long, value_name = "S", default_value_t = HYDRAULIC_DELAY, value_parser = duration))]
    pub hydraulic_delay: Second,
    /// Brake coordination time t2 of pneumatic brakes, in s (the paper's lower bound).
    #[cfg_attr(feature = "clap", arg(long, value_name = "S", default_value_t = PNEUMATIC_DELAY, value_parser = duration))]
    pub pneumatic_delay: Second,
    /// Build-up time t3 of the deceleration, in s.
    #[cfg_attr(feature = "clap", arg(long, value_name = "S", default_value_t = BUILD_UP, value_parser = duration))]
    pub build_up: Second,
    /// Reserve ε of μ, in m (eq. 21).
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", default_value_t = EPSILON, value_parser = reserve))]
    pub epsilon: Metre,
    /// Two road users that overlap by up to this touch but do not collide, in m.
    #[cfg_attr(feature = "clap", arg(long, value_name = "M", default_value_t = CONTACT_TOLERANCE, value_parser = reserve))]
    pub contact_tolerance: Metre,
    /// A conflict is rear-end if the angle at the conflict point is below this, in rad (default 30°).
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD", default_value_t = REAR_END_BELOW, value_parser = angle))]
    pub rear_end_below: Radian,
    /// A conflict is frontal if the angle at the conflict point is above this, in rad (default 150°).
    #[cfg_attr(feature = "clap", arg(long, value_name = "RAD", default_value_t = FRONTAL_ABOVE, value_parser = angle))]
    pub frontal_above: Radian,
    /// Rule of the severity: nearness and consequence, time left and crash probability, or thresholds of TTC and DRAC.
    #[cfg_attr(
        feature = "clap",
        arg(long, alias = "severity", value_enum, default_value_t, help_heading = "Severity")
    )]
    pub severity_rule: SeverityRule,
    /// With `--severity-rule time-left`, a conflict is serious from this crash probability on.
    #[cfg_attr(feature = "clap", arg(long, value_name = "P", default_value_t = SERIOUS_PROBABILITY, value_parser = probability, help_heading = "Severity"))]
    pub serious_probability: f64,
    /// With `--severity-rule time-left`, a conflict is serious only if the two, colliding at their present speeds, would change
    /// the velocity of one of them by at least this, in m/s (default 10 km/h).
    #[cfg_attr(feature = "clap", arg(long, value_name = "M/S", default_value_t = SERIOUS_DELTA_V, value_parser = speed, help_heading = "Severity"))]
    pub serious_delta_v: MetrePerSecond,
    /// With `--severity-rule fhwa`, a conflict is serious if its TTC is below this, in s (FHWA-HRT-08-051).
    #[cfg_attr(feature = "clap", arg(long, value_name = "S", default_value_t = SERIOUS_TTC, value_parser = duration, help_heading = "Severity"))]
    pub serious_ttc: Second,
    /// With `--severity-rule fhwa`, a conflict is serious if its DRAC is above this, in m/s² (Archer 2005).
    #[cfg_attr(feature = "clap", arg(long, value_name = "M/S²", default_value_t = SERIOUS_DRAC, value_parser = deceleration_threshold, help_heading = "Severity"))]
    pub serious_drac: MetrePerSecondSquared,
    /// Count artefacts, conflicts made by SUMO or a tracker, not traffic; otherwise they are only logged.
    #[cfg_attr(feature = "clap", arg(long, help_heading = "Severity"))]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub artefacts: bool,
    /// Driver that crash probabilities assume.
    #[cfg_attr(feature = "clap", arg(long, value_enum, default_value_t, help_heading = "Severity"))]
    pub driver: DriverModel,
    /// Move road users back by half a step, to the moment to which their speeds belong: where SUMO's Euler update has moved
    /// them (`auto`), `always` or `never`.
    #[cfg_attr(feature = "clap", arg(long, value_enum, value_name = "WHEN", default_value_t))]
    pub align: Align,
    /// Log a pair in steps that meet this: `ssm`, `ssam`, `paper`, or comparisons of per-step columns and of the PET, as
    /// `ttc < 3 or pet < 2 or margin < 0`.
    #[cfg_attr(feature = "clap", arg(long, value_name = "CONDITION", default_value_t, help_heading = "Log"))]
    pub log: Condition,
    /// Measures to log besides the default columns: `all`, or names such as `tadv,t2` (docs/measures.md).
    #[cfg_attr(feature = "clap", arg(long, value_name = "default|all|NAME,…", default_value_t, help_heading = "Log"))]
    #[serde(skip_serializing_if = "Measures::is_empty")]
    pub measures: Measures,
    /// Disable all shortcuts, or only the named ones; slower, with the same result.
    #[cfg_attr(feature = "clap", arg(
        long, alias = "keep-all", value_enum, value_name = "NAME,…", value_delimiter = ',', num_args = 0..=1,
        require_equals = true, default_missing_values = Shortcut::names()
    ))]
    #[serde(rename = "keep_all", serialize_with = "shortcut::are_all")]
    pub no_shortcuts: Vec<Shortcut>,
    /// Settings of vehicle types (`[type.NAME]` in the TOML file).
    #[cfg_attr(feature = "clap", arg(skip))]
    pub types: FxHashMap<String, TypeOptions>,
    /// Values of all drivers (`[driver]` in the TOML file).
    #[cfg_attr(feature = "clap", arg(skip))]
    pub driver_options: DriverOptions,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            mode: Mode::default(),
            mu: MuModel::default(),
            path: PathModel::default(),
            decel: Deceleration::default(),
            response_time: RESPONSE_TIME,
            hydraulic_delay: HYDRAULIC_DELAY,
            pneumatic_delay: PNEUMATIC_DELAY,
            build_up: BUILD_UP,
            epsilon: EPSILON,
            contact_tolerance: CONTACT_TOLERANCE,
            rear_end_below: REAR_END_BELOW,
            frontal_above: FRONTAL_ABOVE,
            severity_rule: SeverityRule::default(),
            serious_probability: SERIOUS_PROBABILITY,
            serious_delta_v: SERIOUS_DELTA_V,
            serious_ttc: SERIOUS_TTC,
            serious_drac: SERIOUS_DRAC,
            artefacts: false,
            driver: DriverModel::default(),
            align: Align::default(),
            log: Condition::default(),
            measures: Measures::default(),
            no_shortcuts: Vec::new(),
            types: FxHashMap::default(),
            driver_options: DriverOptions::default(),
        }
    }
}

impl Options {
    /// Checks that the options are possible for road users whose future is not known.
    ///
    /// # Errors
    /// [`Error::FutureUnknown`] if predictions are to use the path really driven.
    pub fn check_future_is_unknown(&self) -> Result<()> {
        if self.path != PathModel::Driven {
            return Ok(());
        }
        Err(Error::FutureUnknown)
    }

    /// Checks that the options are consistent.
    ///
    /// # Errors
    /// [`Error::Kinds`] if the bounds of the kinds overlap, [`Error::BeyondPaper`] if the paper's flow chart would have to look further,
    /// [`Error::OtherRule`] if a threshold of another severity rule is set.
    pub fn checked(self) -> Result<Self> {
        if self.rear_end_below > self.frontal_above {
            return Err(Error::Kinds { rear_end_below: self.rear_end_below, frontal_above: self.frontal_above });
        }
        if self.mode == Mode::Paper && !self.log.look_ahead().is_none() {
            return Err(Error::BeyondPaper { condition: self.log.to_string() });
        }
        self.check_thresholds()?;
        Ok(self)
    }
}
