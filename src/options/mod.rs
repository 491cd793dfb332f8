//! Every setting once: its name, default, unit and source.
//!
//! One struct serves the command line (clap), the TOML file and Python: a TOML key or a Python keyword is the long
//! option with underscores, and all three end in the same parser ([`Options::from_settings`]).

pub mod shortcut;

use std::path::{Path, PathBuf};

use clap::{Args, CommandFactory, FromArgMatches, Parser, ValueEnum};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

use crate::braking::MuModel;
use crate::util::units::{Kilogram, Metre, MetrePerSecondSquared, Radian, Second};
use crate::{Error, Result};
use shortcut::Shortcut;

/// Which method finds the conflicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Paths, meeting places and the corrected μ.
    Closecall,
    /// The paper's flow chart as printed (Guan et al. 2008, fig. 5): to be compared with.
    Paper,
}

/// Where a road user will go while it brakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PathModel {
    /// Along the lanes of its route; needs a net.
    Lanes,
    /// On a circle of the curvature that it drives now.
    Arc,
    /// Straight on along its heading.
    Straight,
}

/// Which of SUMO's decelerations a vehicle brakes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Deceleration {
    /// `emergencyDecel`, the most that it can.
    Emergency,
    /// `decel`, what its driver brakes with ordinarily.
    Decel,
}

/// How a vehicle's brakes are worked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrakeSystem {
    /// Cars, bicycles, motorcycles.
    Hydraulic,
    /// Trucks, buses, coaches, trailers.
    Pneumatic,
}

/// The driver's response time t1 in s, unless it is set (Guan et al. 2008, fig. 4).
const RESPONSE_TIME: Second = 0.8;
/// Brake coordination time t2 of hydraulic brakes in s, unless it is set (the paper's lower bound).
const HYDRAULIC_DELAY: Second = 0.25;
/// Time t3 in which the deceleration builds up in s, unless it is set.
pub const BUILD_UP: Second = 0.1;
/// Redundancy ε of μ in m, unless it is set (eq. 21).
pub const EPSILON: Metre = 0.5;
/// t1 + t2 of a driver with hydraulic brakes in s, unless one of them is set.
pub const RESPONSE: Second = RESPONSE_TIME + HYDRAULIC_DELAY;

/// The settings of the detector and of what is logged.
#[derive(Clone, Debug, PartialEq, Args, Serialize)]
pub struct Options {
    /// Method: closecall's own, or the paper's flow chart as printed.
    #[arg(long, value_enum, default_value = "closecall")]
    pub mode: Mode,
    /// Model of the minimal collision distance μ.
    #[arg(long, value_enum, default_value = "minimal")]
    pub mu: MuModel,
    /// Where a road user will go while it brakes (straight where there is no net).
    #[arg(long, value_enum, default_value = "lanes")]
    pub path: PathModel,
    /// Deceleration of a vehicle type that gets no other value.
    #[arg(long, value_enum, default_value = "emergency")]
    pub decel: Deceleration,
    /// The driver's response time t1 in s (Guan et al. 2008, fig. 4).
    #[arg(long, value_name = "S", default_value_t = RESPONSE_TIME, value_parser = not_negative)]
    pub response_time: Second,
    /// Brake coordination time t2 of hydraulic brakes in s (the paper's lower bound).
    #[arg(long, value_name = "S", default_value_t = HYDRAULIC_DELAY, value_parser = not_negative)]
    pub hydraulic_delay: Second,
    /// Brake coordination time t2 of pneumatic brakes in s (the paper's lower bound).
    #[arg(long, value_name = "S", default_value_t = 0.35, value_parser = not_negative)]
    pub pneumatic_delay: Second,
    /// Time t3 in which the deceleration builds up, in s.
    #[arg(long, value_name = "S", default_value_t = BUILD_UP, value_parser = not_negative)]
    pub build_up: Second,
    /// Redundancy ε of μ in m (eq. 21).
    #[arg(long, value_name = "M", default_value_t = EPSILON, value_parser = not_negative)]
    pub epsilon: Metre,
    /// A pair is rear-end where the angle at the meeting place is below this, in rad (30°).
    #[arg(long, value_name = "RAD", default_value_t = std::f64::consts::FRAC_PI_6, value_parser = angle)]
    pub rear_end_below: Radian,
    /// A pair is frontal where the angle at the meeting place is above this, in rad (150°).
    #[arg(long, value_name = "RAD", default_value_t = 5.0 * std::f64::consts::FRAC_PI_6, value_parser = angle)]
    pub frontal_above: Radian,
    /// A conflict is serious where its TTC is below this, in s (FHWA-HRT-08-051).
    #[arg(long, value_name = "S", default_value_t = 1.5, value_parser = not_negative)]
    pub serious_ttc: Second,
    /// A conflict is serious where its DRAC is above this, in m/s² (Archer 2005).
    #[arg(long, value_name = "M/S²", default_value_t = 3.4, value_parser = not_negative)]
    pub serious_drac: MetrePerSecondSquared,
    /// Types of SUMO polygons that are static obstacles.
    #[arg(long, value_name = "TYPE,…", value_delimiter = ',')]
    pub obstacles: Vec<String>,
    /// Selection file of SUMO (edge:ID, lane:ID, junction:ID lines): only what happens there.
    #[arg(long, value_name = "FILE")]
    pub filter: Option<PathBuf>,
    /// Write encounters.csv too: a row per pair in conflict and step.
    #[arg(long)]
    pub log_encounters: bool,
    /// Run every test on every pair, also those that the scene does not need: the same result, later.
    #[arg(long)]
    pub keep_all: bool,
    /// The same for single ones, to measure what each saves.
    #[arg(long, value_enum, value_name = "WHAT,…", value_delimiter = ',', hide = true)]
    #[serde(skip)]
    pub keep: Vec<Shortcut>,
    /// Settings of single vehicle types (`[type.NAME]` in the TOML file).
    #[arg(skip)]
    pub types: FxHashMap<String, TypeOptions>,
}

/// What the TOML file sets for one vehicle type; what is absent comes from SUMO or the general settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TypeOptions {
    /// The driver's response time t1 in s.
    pub response_time: Option<Second>,
    /// Brake coordination time t2 in s.
    pub brake_delay: Option<Second>,
    /// Build-up time t3 in s.
    pub build_up: Option<Second>,
    /// Deceleration in m/s².
    pub decel: Option<MetrePerSecondSquared>,
    /// Brake system, which gives t2 where `brake_delay` is absent.
    pub brakes: Option<BrakeSystem>,
    /// Length in m.
    pub length: Option<Metre>,
    /// Width in m.
    pub width: Option<Metre>,
    /// Mass in kg.
    pub mass: Option<Kilogram>,
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
struct Settings {
    #[command(flatten)]
    options: Options,
}

impl Options {
    /// Options from names and values, as a TOML file or Python keywords give them: a name is the long option with
    /// underscores, a flag's value `true` or `false`.
    ///
    /// # Errors
    /// [`Error::Value`] that names the setting that is unknown or out of its range.
    pub fn from_settings<'a>(settings: impl IntoIterator<Item = (&'a str, String)>) -> Result<Self> {
        let mut command = Settings::command();
        let mut given = Vec::new();
        for (name, value) in settings {
            let option = name.replace('_', "-");
            if !command.get_arguments().any(|known| known.get_long() == Some(&option)) {
                return Err(Error::Value(format!("unexpected argument '--{option}' found")));
            }
            given.extend(words(name, &value));
        }
        let matches = command.try_get_matches_from_mut(given).map_err(plain)?;
        let settings = Settings::from_arg_matches(&matches).map_err(plain)?;
        settings.options.checked()
    }

    /// These options, if they fit together.
    ///
    /// # Errors
    /// [`Error::Value`] where the bounds of the kinds overlap.
    pub fn checked(self) -> Result<Self> {
        if self.rear_end_below > self.frontal_above {
            return Err(Error::Value(format!(
                "rear_end_below is {} rad, above frontal_above, {} rad",
                self.rear_end_below, self.frontal_above
            )));
        }
        Ok(self)
    }
}

/// What a TOML file of options holds.
#[derive(Debug, Default)]
pub struct OptionsFile {
    /// The settings as command-line words, to stand before those that the user typed, so that these win.
    pub words: Vec<String>,
    /// The `[type.NAME]` tables.
    pub types: FxHashMap<String, TypeOptions>,
    /// The `[regress]` table, for the command of that name.
    pub regress: Option<toml::Table>,
}

impl OptionsFile {
    /// Reads a TOML file; `known` are the long options that a key may name.
    ///
    /// # Errors
    /// An error that names the file and the line or key: unreadable, no TOML, an unknown key.
    pub fn read(path: &Path, known: &[String]) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::file(path, source))?;
        Self::parse(path, &text, known)
    }

    /// The same of a text; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`OptionsFile::read`] has them.
    pub fn parse(path: &Path, text: &str, known: &[String]) -> Result<Self> {
        let table: toml::Table = toml::from_str(text).map_err(|error| toml_error(path, text, &error))?;
        let mut file = Self::default();
        for (key, value) in table {
            match (key.as_str(), value) {
                ("type", toml::Value::Table(types)) => {
                    for (name, settings) in types {
                        let parsed = settings.try_into().map_err(|error: toml::de::Error| {
                            Error::content(path, format!("[type.{name}]: {}", error.message()))
                        })?;
                        file.types.insert(name, parsed);
                    }
                }
                ("regress", toml::Value::Table(regress)) => file.regress = Some(regress),
                (name, value) => {
                    let option = name.replace('_', "-");
                    if !known.contains(&option) {
                        return Err(Error::content(path, format!("unknown key \"{name}\"")));
                    }
                    file.words.extend(words(name, &plain_value(path, name, &value)?));
                }
            }
        }
        Ok(file)
    }
}

fn words(name: &str, value: &str) -> Option<String> {
    let option = name.replace('_', "-");
    match value {
        "true" => Some(format!("--{option}")),
        "false" => None,
        _ => Some(format!("--{option}={value}")),
    }
}

fn plain_value(path: &Path, name: &str, value: &toml::Value) -> Result<String> {
    match value {
        toml::Value::String(text) => Ok(text.clone()),
        toml::Value::Integer(number) => Ok(number.to_string()),
        toml::Value::Float(number) => Ok(number.to_string()),
        toml::Value::Boolean(flag) => Ok(flag.to_string()),
        toml::Value::Array(items) => {
            let items = items.iter().map(|item| plain_value(path, name, item)).collect::<Result<Vec<_>>>()?;
            Ok(items.join(","))
        }
        _ => {
            Err(Error::content(path, format!("\"{name}\" must be a text, a number, true or false, or a list of these")))
        }
    }
}

fn toml_error(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count() as u64);
    Error::line(path, line, error.message())
}

/// clap's message without its usage lines: one line.
fn plain(error: clap::Error) -> Error {
    let text = error.to_string();
    Error::Value(text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned())
}

/// A number of 0 or more.
pub(crate) fn not_negative(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("it must be a finite number, 0 or more".to_owned()),
    }
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("it must be a number above 0".to_owned()),
    }
}

/// An angle in rad, 0 to π.
pub(crate) fn angle(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=std::f64::consts::PI).contains(&value) => Ok(value),
        _ => Err("it must be an angle in rad, 0 to π".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_those_of_the_design() {
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
