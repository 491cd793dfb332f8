//! Options from a TOML file.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::word::word;
use crate::util::input_file;
use crate::{Error, Result};
use closecall::options::{DriverOptions, TypeOptions};

/// Says what is wrong with the value of an option, if anything is; else what to tell the user of its name.
pub type Check = fn(&str, &str) -> std::result::Result<Option<String>, String>;

/// The content of a TOML file of options.
#[derive(Debug, Default)]
pub struct OptionsFile {
    /// The settings as command-line words. They precede the words that the user typed, so that the latter win.
    pub args: Vec<String>,
    /// The `[type.NAME]` tables.
    pub types: FxHashMap<String, TypeOptions>,
    /// The `[driver]` table.
    pub driver: DriverOptions,
    /// The `[regress]` table, for the command of that name.
    pub regress: Option<toml::Table>,
    /// What to tell the user of old names among its keys.
    pub remarks: Vec<String>,
}

impl OptionsFile {
    /// Reads a TOML file; `known` are the long options that a key may name, and `check` checks their values
    /// ([`RunOptions::check_setting`](super::RunOptions::check_setting)).
    ///
    /// # Errors
    /// An error that names the file and the line or key: unreadable, not TOML, an unknown key.
    pub fn read(path: &Path, known: &[String], check: Check) -> Result<Self> {
        let text = input_file::text(path)?;
        Self::parse(path, &text, known, check)
    }

    /// Reads TOML from a text; `path` names it in errors.
    ///
    /// # Errors
    /// As for [`OptionsFile::read`].
    pub fn parse(path: &Path, text: &str, known: &[String], check: Check) -> Result<Self> {
        let table: toml::Table = toml::from_str(text).map_err(|error| toml_error(path, text, &error))?;
        let mut file = Self::default();
        for (key, value) in table {
            match (key.as_str(), value) {
                ("type", toml::Value::Table(types)) => {
                    for (name, settings) in types {
                        let table = format!("type.{name}");
                        let parsed: TypeOptions = parse_table(path, &table, settings)?;
                        let line = line_of(text, &format!("[{table}"));
                        parsed.check().map_err(|why| Error::line(path, line, format!("[{table}]: {why}")))?;
                        file.types.insert(name, parsed);
                    }
                }
                ("driver", settings @ toml::Value::Table(_)) => {
                    file.driver = parse_table(path, "driver", settings)?;
                    file.driver.check().map_err(|why| Error::content(path, format!("[driver]: {why}")))?;
                }
                ("regress", toml::Value::Table(regress)) => file.regress = Some(regress),
                (name, value) => {
                    let option = name.replace('_', "-");
                    if !known.contains(&option) {
                        return Err(Error::content(path, format!("unknown key \"{name}\"")));
                    }
                    let value = plain_value(path, name, &value)?;
                    let line = line_of(text, name);
                    let remark = check(name, &value).map_err(|why| Error::line(path, line, why))?;
                    let place = || format!("{}, line {line}", path.display());
                    file.remarks.extend(remark.map(|remark| format!("{}: {remark}", place())));
                    file.args.extend(word(name, &value));
                }
            }
        }
        Ok(file)
    }
}

/// The line of a key, from 1.
fn line_of(text: &str, key: &str) -> u64 {
    let is_of = |line: &str| line.trim_start().trim_start_matches(['"', '\'']).starts_with(key);
    1 + text.lines().take_while(|line| !is_of(line)).count() as u64
}

/// The settings of a table that is not a list of command-line options.
fn parse_table<T: serde::de::DeserializeOwned>(path: &Path, name: &str, table: toml::Value) -> Result<T> {
    table.try_into().map_err(|error: toml::de::Error| Error::content(path, format!("[{name}]: {}", error.message())))
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
