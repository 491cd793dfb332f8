//! All settings: name, default, unit and source.
//!
//! One struct serves the command line (clap), the TOML file and Python. A TOML key or a Python keyword is the long
//! option with underscores, and all three use the same parser ([`Options::from_settings`]).

pub mod shortcut;
pub mod thresholds;
mod toml_file;
mod type_options;
mod values;

use std::path::PathBuf;

use clap::{Args, CommandFactory, FromArgMatches, Parser, ValueEnum};
use rustc_hash::FxHashMap;
use serde::Serialize;

use crate::braking::MuModel;
use crate::util::units::{Metre, MetrePerSecondSquared, Radian, Second};
use crate::{Error, Result};
use shortcut::Shortcut;
use values::word;

pub use toml_file::OptionsFile;
pub use type_options::{BrakeSystem, TypeOptions};
pub(crate) use values::{angle, not_negative, positive};

/// The method that finds the conflicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// closecall's own method: paths, conflict points and the corrected μ.
    Closecall,
    /// The paper's flow chart as printed (Guan et al. 2008, fig. 5), for comparison.
    Paper,
}

/// The path that a road user is expected to take while it brakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathModel {
    /// Along the lanes of its route; needs a net.
    Lanes,
    /// On a circle with its current curvature.
    Arc,
    /// Straight on along its heading.
    Straight,
}

/// The deceleration of SUMO's vehicle type that a vehicle brakes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Deceleration {
    /// `emergencyDecel`, its maximum.
    Emergency,
    /// `decel`, that of ordinary driving.
    Decel,
}

/// Default of the driver's response time t1, in s (Guan et al. 2008, fig. 4).
const RESPONSE_TIME: Second = 0.8;
/// Default of the brake coordination time t2 of hydraulic brakes, in s (the paper's lower bound).
const HYDRAULIC_DELAY: Second = 0.25;
/// Default of the build-up time t3, in s.
pub const BUILD_UP: Second = 0.1;
/// Default of the reserve ε of μ, in m (eq. 21).
pub const EPSILON: Metre = 0.5;
/// Default of t1 + t2 with hydraulic brakes, in s.
pub const RESPONSE: Second = RESPONSE_TIME + HYDRAULIC_DELAY;

/// The settings of the detector and of what is logged.
#[derive(Clone, Debug, PartialEq, Args, Serialize)]
pub struct Options {
    /// Method that finds conflicts: closecall's own, or the paper's flow chart as printed.
    #[arg(long, value_enum, default_value = "closecall")]
    pub mode: Mode,
    /// Model of the minimal collision distance μ.
    #[arg(long, value_enum, default_value = "minimal")]
    pub mu: MuModel,
    /// Expected path of a braking road user; without a net, `lanes` means straight on.
    #[arg(long, value_enum, default_value = "lanes")]
    pub path: PathModel,
    /// SUMO attribute that sets the deceleration of a vehicle type without a value of its own.
    #[arg(long, value_enum, default_value = "emergency")]
    pub decel: Deceleration,
    /// Response time t1 of the driver, in s (Guan et al. 2008, fig. 4).
    #[arg(long, value_name = "S", default_value_t = RESPONSE_TIME, value_parser = not_negative)]
    pub response_time: Second,
    /// Brake coordination time t2 of hydraulic brakes, in s (the paper's lower bound).
    #[arg(long, value_name = "S", default_value_t = HYDRAULIC_DELAY, value_parser = not_negative)]
    pub hydraulic_delay: Second,
    /// Brake coordination time t2 of pneumatic brakes, in s (the paper's lower bound).
    #[arg(long, value_name = "S", default_value_t = 0.35, value_parser = not_negative)]
    pub pneumatic_delay: Second,
    /// Build-up time t3 of the deceleration, in s.
    #[arg(long, value_name = "S", default_value_t = BUILD_UP, value_parser = not_negative)]
    pub build_up: Second,
    /// Reserve ε of μ, in m (eq. 21).
    #[arg(long, value_name = "M", default_value_t = EPSILON, value_parser = not_negative)]
    pub epsilon: Metre,
    /// A conflict is rear-end if the angle at the conflict point is below this, in rad (default 30°).
    #[arg(long, value_name = "RAD", default_value_t = std::f64::consts::FRAC_PI_6, value_parser = angle)]
    pub rear_end_below: Radian,
    /// A conflict is frontal if the angle at the conflict point is above this, in rad (default 150°).
    #[arg(long, value_name = "RAD", default_value_t = 5.0 * std::f64::consts::FRAC_PI_6, value_parser = angle)]
    pub frontal_above: Radian,
    /// A conflict is serious if its TTC is below this, in s (FHWA-HRT-08-051).
    #[arg(long, value_name = "S", default_value_t = 1.5, value_parser = not_negative)]
    pub serious_ttc: Second,
    /// A conflict is serious if its DRAC is above this, in m/s² (Archer 2005).
    #[arg(long, value_name = "M/S²", default_value_t = 3.4, value_parser = not_negative)]
    pub serious_drac: MetrePerSecondSquared,
    /// Types of the SUMO polygons that are static obstacles.
    #[arg(long, value_name = "TYPE,…", value_delimiter = ',')]
    pub obstacles: Vec<String>,
    /// Report only conflicts on the edges, lanes and junctions of this SUMO selection file.
    #[arg(long, value_name = "FILE")]
    pub filter: Option<PathBuf>,
    /// Also write encounters.csv, with a row per step of each pair in conflict.
    #[arg(long)]
    pub log_encounters: bool,
    /// Run every test on every pair, even where the scene does not need it; slower, with the same result.
    #[arg(long)]
    pub keep_all: bool,
    /// Keep single tests, to measure what leaving out each one saves.
    #[arg(long, value_enum, value_name = "WHAT,…", value_delimiter = ',', hide = true)]
    #[serde(skip)]
    pub keep: Vec<Shortcut>,
    /// Settings of vehicle types (`[type.NAME]` in the TOML file).
    #[arg(skip)]
    pub types: FxHashMap<String, TypeOptions>,
}

impl Default for Options {
    fn default() -> Self {
        match Self::from_settings([]) {
            Ok(options) => options,
            Err(_) => unreachable!("the defaults are parsed by a test"),
        }
    }
}

#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct SettingsParser {
    #[command(flatten)]
    options: Options,
}

impl Options {
    /// Options from names and values, as in a TOML file or Python keywords. A name is the long option with underscores;
    /// the value of a flag is `true` or `false`.
    ///
    /// # Errors
    /// [`Error::Value`] that names the setting if it is unknown or out of range.
    pub fn from_settings<'a>(settings: impl IntoIterator<Item = (&'a str, String)>) -> Result<Self> {
        let mut command = SettingsParser::command();
        let mut given = Vec::new();
        for (name, value) in settings {
            let option = name.replace('_', "-");
            if !command.get_arguments().any(|known| known.get_long() == Some(&option)) {
                return Err(Error::Value(format!("unexpected argument '--{option}' found")));
            }
            given.extend(word(name, &value));
        }
        let matches = command.try_get_matches_from_mut(given).map_err(plain)?;
        let settings = SettingsParser::from_arg_matches(&matches).map_err(plain)?;
        settings.options.checked()
    }

    /// Checks that the options are consistent.
    ///
    /// # Errors
    /// [`Error::Value`] if the bounds of the kinds overlap.
    pub fn checked(self) -> Result<Self> {
        if self.rear_end_below > self.frontal_above {
            return Err(Error::Value(format!(
                "rear_end_below ({} rad) must not be above frontal_above ({} rad)",
                self.rear_end_below, self.frontal_above
            )));
        }
        Ok(self)
    }
}

/// clap's message as one line, without the usage.
fn plain(error: clap::Error) -> Error {
    let text = error.to_string();
    Error::Value(text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_the_documented_ones() {
        let options = Options::from_settings([]).unwrap();
        assert_eq!(options.mu, MuModel::Minimal);
        assert_eq!((options.response_time, options.hydraulic_delay, options.epsilon), (0.8, 0.25, 0.5));
    }

    #[test]
    fn a_setting_has_the_name_of_the_long_option() {
        let options = Options::from_settings([("mu", "at-rest".to_owned()), ("keep_all", "true".to_owned())]).unwrap();
        assert_eq!(options.mu, MuModel::AtRest);
        assert!(options.keep_all);
    }

    #[test]
    fn an_unknown_or_impossible_setting_is_named() {
        let unknown = Options::from_settings([("colour", "red".to_owned())]).unwrap_err().to_string();
        assert!(unknown.contains("--colour"), "{unknown}");
        let unset = Options::from_settings([("colour", "false".to_owned())]).unwrap_err().to_string();
        assert!(unset.contains("--colour"), "{unset}");
        let negative = Options::from_settings([("epsilon", "-1".to_owned())]).unwrap_err().to_string();
        assert!(negative.contains("--epsilon") && !negative.contains('\n'), "{negative}");
    }
}
