//! Options from names and values: the parser behind the TOML file and Python keywords is that of the command line.

use clap::{CommandFactory, FromArgMatches, Parser};

use super::Options;
use super::values::word;
use crate::{Error, Result};

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
}

/// clap's message as one line, without the usage.
fn plain(error: clap::Error) -> Error {
    let text = error.to_string();
    Error::Value(text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::braking::MuModel;

    #[test]
    fn the_defaults_are_the_documented_ones() {
        let options = Options::from_settings([]).unwrap();
        assert_eq!(options, Options::default());
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
