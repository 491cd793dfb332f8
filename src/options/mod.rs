//! All settings: name, default, unit and source.
//!
//! One struct serves the command line (clap), the TOML file and Python. A TOML key or a Python keyword is the long
//! option with underscores, and all three use the same parser ([`Options::from_settings`]).

mod align;
mod choices;
mod clip_level;
pub mod condition;
mod defaults;
mod driver;
pub mod measures;
#[cfg(feature = "cli")]
mod settings;
mod severity_rule;
pub mod shortcut;
pub mod thresholds;
#[cfg(feature = "cli")]
mod toml_file;
mod type_options;
#[cfg(feature = "cli")]
mod values;

use std::path::PathBuf;

use rustc_hash::FxHashMap;
use serde::Serialize;

use crate::braking::MuModel;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};
use crate::{Error, Result};
use choices::{ENCOUNTERS, SERIES, SERIES_PARQUET};
use condition::Condition;
use defaults::{
    CONTACT_TOLERANCE, FRONTAL_ABOVE, HYDRAULIC_DELAY, PNEUMATIC_DELAY, REAR_END_BELOW, RESPONSE_TIME, SERIOUS_DELTA_V,
    SERIOUS_DRAC, SERIOUS_PROBABILITY, SERIOUS_TTC,
};
use measures::Measures;
use shortcut::Shortcut;

pub use align::Align;
pub use choices::{Deceleration, Mode, PathModel, SERIES_FILES, SeriesFormat};
pub use clip_level::ClipLevel;
pub use defaults::{BUILD_UP, EPSILON, RESPONSE};
pub use driver::{DriverModel, DriverOptions};
pub use severity_rule::SeverityRule;
#[cfg(feature = "cli")]
pub use toml_file::OptionsFile;
pub use type_options::{BrakeSystem, TypeOptions};
#[cfg(feature = "cli")]
pub(crate) use values::{
    angle, deceleration, deceleration_threshold, duration, probability, reserve, share, speed, step_length, time,
};

/// The settings of the detector and of what is logged.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct Options {
    /// Method that finds conflicts: closecall's own, or the paper's flow chart as printed.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    pub mode: Mode,
    /// Model of the minimal collision distance μ.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    pub mu: MuModel,
    /// Expected path of a braking road user; without a net, `lanes` means straight on. `driven` is for recordings only.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    pub path: PathModel,
    /// SUMO attribute that sets the deceleration of a vehicle type without a value of its own.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    pub decel: Deceleration,
    /// Response time t1 of the driver, in s (Guan et al. 2008, fig. 4).
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = RESPONSE_TIME, value_parser = duration))]
    pub response_time: Second,
    /// Brake coordination time t2 of hydraulic brakes, in s (the paper's lower bound).
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = HYDRAULIC_DELAY, value_parser = duration))]
    pub hydraulic_delay: Second,
    /// Brake coordination time t2 of pneumatic brakes, in s (the paper's lower bound).
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = PNEUMATIC_DELAY, value_parser = duration))]
    pub pneumatic_delay: Second,
    /// Build-up time t3 of the deceleration, in s.
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = BUILD_UP, value_parser = duration))]
    pub build_up: Second,
    /// Reserve ε of μ, in m (eq. 21).
    #[cfg_attr(feature = "cli", arg(long, value_name = "M", default_value_t = EPSILON, value_parser = reserve))]
    pub epsilon: Metre,
    /// Two road users that overlap by up to this touch but do not collide, in m.
    #[cfg_attr(feature = "cli", arg(long, value_name = "M", default_value_t = CONTACT_TOLERANCE, value_parser = reserve))]
    pub contact_tolerance: Metre,
    /// A conflict is rear-end if the angle at the conflict point is below this, in rad (default 30°).
    #[cfg_attr(feature = "cli", arg(long, value_name = "RAD", default_value_t = REAR_END_BELOW, value_parser = angle))]
    pub rear_end_below: Radian,
    /// A conflict is frontal if the angle at the conflict point is above this, in rad (default 150°).
    #[cfg_attr(feature = "cli", arg(long, value_name = "RAD", default_value_t = FRONTAL_ABOVE, value_parser = angle))]
    pub frontal_above: Radian,
    /// Rule of the severity: nearness and consequence, time left and crash probability, or thresholds of TTC and DRAC.
    #[cfg_attr(feature = "cli", arg(long, alias = "severity", value_enum, default_value_t))]
    pub severity_rule: SeverityRule,
    /// With `--severity-rule time-left`, a conflict is serious from this crash probability on.
    #[cfg_attr(feature = "cli", arg(long, value_name = "P", default_value_t = SERIOUS_PROBABILITY, value_parser = probability))]
    pub serious_probability: f64,
    /// With `--severity-rule time-left`, a conflict is serious only if the two, colliding at their present speeds, would change
    /// the velocity of one of them by at least this, in m/s (default 10 km/h).
    #[cfg_attr(feature = "cli", arg(long, value_name = "M/S", default_value_t = SERIOUS_DELTA_V, value_parser = speed))]
    pub serious_delta_v: MetrePerSecond,
    /// With `--severity-rule fhwa`, a conflict is serious if its TTC is below this, in s (FHWA-HRT-08-051).
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = SERIOUS_TTC, value_parser = duration))]
    pub serious_ttc: Second,
    /// With `--severity-rule fhwa`, a conflict is serious if its DRAC is above this, in m/s² (Archer 2005).
    #[cfg_attr(feature = "cli", arg(long, value_name = "M/S²", default_value_t = SERIOUS_DRAC, value_parser = deceleration_threshold))]
    pub serious_drac: MetrePerSecondSquared,
    /// Count conflicts that are SUMO's or a tracker's making, not traffic's; else they are only logged.
    #[cfg_attr(feature = "cli", arg(long))]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub artefacts: bool,
    /// Driver that crash probabilities assume.
    #[cfg_attr(feature = "cli", arg(long, value_enum, default_value_t))]
    pub driver: DriverModel,
    /// Move road users back by half a step, to the moment to which their speeds belong: where SUMO's Euler update has moved
    /// them (`auto`), `always` or `never`.
    #[cfg_attr(feature = "cli", arg(long, value_enum, value_name = "WHEN", default_value_t))]
    pub align: Align,
    /// Types of the SUMO polygons that are static obstacles.
    #[cfg_attr(feature = "cli", arg(long, value_name = "TYPE,…", value_delimiter = ','))]
    pub obstacles: Vec<String>,
    /// Report only conflicts on the edges, lanes and junctions of this SUMO selection file.
    #[cfg_attr(feature = "cli", arg(long, value_name = "FILE"))]
    pub filter: Option<PathBuf>,
    /// Log a pair in steps that meet this: `ssm`, `ssam`, `paper`, or comparisons of per-step columns and of the PET, as
    /// `ttc < 3 or pet < 2 or margin < 0`.
    #[cfg_attr(feature = "cli", arg(long, value_name = "CONDITION", default_value_t))]
    pub log: Condition,
    /// Measures that the log has besides its default columns: `all`, or names such as `tadv,t2` (docs/measures.md).
    #[cfg_attr(feature = "cli", arg(long, value_name = "default|all|NAME,…", default_value_t))]
    #[serde(skip_serializing_if = "Measures::is_empty")]
    pub measures: Measures,
    /// Count traffic and log conflicts only after this time from the begin, in s.
    #[cfg_attr(feature = "cli", arg(long, value_name = "S", default_value_t = 0.0, value_parser = duration))]
    pub warmup: Second,
    /// Also write series.csv, with a row per step of each logged conflict; `--log-series=parquet` writes series.parquet.
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "FORMAT", num_args = 0..=1, require_equals = true, default_missing_value = "csv")
    )]
    pub log_series: Option<SeriesFormat>,
    /// The former name of `log_series`; the file is then called encounters.csv.
    #[cfg_attr(feature = "cli", arg(long, hide = true))]
    #[serde(skip)]
    pub log_encounters: bool,
    /// Keep where the road users were around each conflict of at least this severity, in clips.jsonl.gz: `closecall clip`
    /// and `closecall show` play it.
    #[cfg_attr(feature = "cli", arg(long, value_enum, value_name = "SEVERITY", default_value_t))]
    #[serde(skip_serializing_if = "ClipLevel::is_default")]
    pub log_clips: ClipLevel,
    /// Run every test on every pair, even where the scene does not need it; slower, with the same result.
    #[cfg_attr(feature = "cli", arg(long))]
    pub keep_all: bool,
    /// Keep single tests, to measure what leaving out each one saves.
    #[cfg_attr(feature = "cli", arg(long, value_enum, value_name = "WHAT,…", value_delimiter = ',', hide = true))]
    #[serde(skip)]
    pub keep: Vec<Shortcut>,
    /// Settings of vehicle types (`[type.NAME]` in the TOML file).
    #[cfg_attr(feature = "cli", arg(skip))]
    pub types: FxHashMap<String, TypeOptions>,
    /// Values of all drivers (`[driver]` in the TOML file).
    #[cfg_attr(feature = "cli", arg(skip))]
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
            obstacles: Vec::new(),
            filter: None,
            log: Condition::default(),
            measures: Measures::default(),
            warmup: 0.0,
            log_series: None,
            log_encounters: false,
            log_clips: ClipLevel::default(),
            keep_all: false,
            keep: Vec::new(),
            types: FxHashMap::default(),
            driver_options: DriverOptions::default(),
        }
    }
}

impl Options {
    /// Sets what only a TOML file can: its tables of types and drivers.
    #[cfg(feature = "cli")]
    pub fn set_tables(&mut self, file: OptionsFile) {
        self.types = file.types;
        self.driver_options = file.driver;
    }

    /// The name of the file with each step of each conflict; none where it is not wanted.
    pub fn series_file(&self) -> Option<&'static str> {
        match self.log_series {
            Some(SeriesFormat::Csv) => Some(SERIES),
            #[cfg(feature = "parquet")]
            Some(SeriesFormat::Parquet) => Some(SERIES_PARQUET),
            None => self.log_encounters.then_some(ENCOUNTERS),
        }
    }

    /// Checks that the options are possible for road users whose future is not known.
    ///
    /// # Errors
    /// [`Error::Value`] if they are to be met where they really drive.
    pub fn check_future_is_unknown(&self) -> Result<()> {
        if self.path != PathModel::Driven {
            return Ok(());
        }
        Err(Error::Value(
            "path: driven is where road users drive afterwards, which only a recording knows: see closecall replay"
                .to_owned(),
        ))
    }

    /// Checks that the options are consistent.
    ///
    /// # Errors
    /// [`Error::Value`] if the bounds of the kinds overlap, the paper's flow chart would have to look further, or a threshold of
    /// another severity rule is set.
    pub fn checked(self) -> Result<Self> {
        if self.rear_end_below > self.frontal_above {
            return Err(Error::Value(format!(
                "rear_end_below ({} rad) must not be above frontal_above ({} rad)",
                self.rear_end_below, self.frontal_above
            )));
        }
        if self.mode == Mode::Paper && !self.log.look_ahead().is_none() {
            return Err(Error::Value(format!(
                "log: \"{}\" needs pairs beyond the paper's detection radius, within which --mode paper finds them",
                self.log
            )));
        }
        self.check_thresholds()?;
        Ok(self)
    }
}
