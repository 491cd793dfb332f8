//! Options from names and values: the parser behind the TOML file and Python keywords is that of the command line.

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, FromArgMatches, Parser};

use super::word::word;
use super::{RunOptions, old_names};
use crate::{Error, Result};

#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct SettingsParser {
    #[command(flatten)]
    options: RunOptions,
}

impl RunOptions {
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
            if !is_option(&command, &option) {
                let similar = command.try_get_matches_from_mut([format!("--{option}")]).err();
                let similar = similar.and_then(|error| text(&error, ContextKind::SuggestedArg));
                let similar = similar.map(|similar| format!("; did you mean \"{}\"?", name_of(&similar)));
                return Err(Error::Value(format!("unknown option \"{name}\"{}", similar.unwrap_or_default())));
            }
            given.extend(word(name, &value));
        }
        let matches = command.try_get_matches_from_mut(given).map_err(|error| plain(&error))?;
        let settings = SettingsParser::from_arg_matches(&matches).map_err(|error| plain(&error))?;
        settings.options.checked()
    }

    /// Which name replaces that of a setting; none for a current name.
    pub fn old_name(name: &str) -> Option<String> {
        old_names::remark(&SettingsParser::command(), name)
    }

    /// Checks the value of a setting in a file, unless the option is one of another command; says which name replaces an old
    /// one.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn check_setting(name: &str, value: &str) -> std::result::Result<Option<String>, String> {
        let mut command = SettingsParser::command();
        let option = name.replace('_', "-");
        if !is_option(&command, &option) {
            return Ok(None);
        }
        let checked = command.try_get_matches_from_mut(word(name, value));
        checked.map(|_| old_names::remark(&command, name)).map_err(|error| plain(&error).to_string())
    }
}

/// Whether this is a long option, or the old name of one.
fn is_option(command: &clap::Command, option: &str) -> bool {
    let is_this = |known: &clap::Arg| {
        known.get_long() == Some(option) || known.get_all_aliases().is_some_and(|old| old.contains(&option))
    };
    command.get_arguments().any(is_this)
}

/// clap's message as one line that names the setting, not the long option.
fn plain(error: &clap::Error) -> Error {
    let message = error.to_string();
    let mut line = message.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
    if let Some(argument) = text(error, ContextKind::InvalidArg) {
        line = line.replace(&format!("'{argument}'"), &format!("\"{}\"", name_of(&argument)));
    }
    if let Some(ContextValue::Strings(values)) = error.get(ContextKind::ValidValue) {
        line += &format!("; possible values: {}", values.join(", "));
    }
    Error::Value(line)
}

/// A part of clap's error.
fn text(error: &clap::Error, kind: ContextKind) -> Option<String> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    }
}

/// The name of the setting whose long option clap shows as `--serious-ttc <S>`.
fn name_of(argument: &str) -> String {
    let option = argument.trim_start_matches('-').split([' ', '=']).next().unwrap_or_default();
    option.replace('-', "_")
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::braking::MuModel;
    use closecall::options::shortcut::Shortcut;

    #[test]
    fn the_defaults_are_the_documented_ones() {
        let options = RunOptions::from_settings([]).unwrap();
        assert_eq!(options, RunOptions::default());
        assert_eq!(options.model.mu, MuModel::Minimal);
        assert_eq!(
            (options.model.response_time, options.model.hydraulic_delay, options.model.epsilon),
            (0.8, 0.25, 0.5)
        );
    }

    #[test]
    fn a_setting_has_the_name_of_the_long_option() {
        let options =
            RunOptions::from_settings([("mu", "at-rest".to_owned()), ("artefacts", "true".to_owned())]).unwrap();
        assert_eq!(options.model.mu, MuModel::AtRest);
        assert!(options.model.artefacts);
    }

    #[test]
    fn shortcuts_are_disabled_all_or_by_name_also_under_the_old_name() {
        let of = |name, value: &str| RunOptions::from_settings([(name, value.to_owned())]).unwrap().model.no_shortcuts;
        assert_eq!(of("no_shortcuts", "true"), Shortcut::ALL);
        assert_eq!(of("no_shortcuts", "areas-apart,in_line"), [Shortcut::AreasApart, Shortcut::InLine]);
        assert_eq!(of("no_shortcuts", "false"), []);
        assert_eq!(of("keep_all", "true"), Shortcut::ALL);
        assert!(RunOptions::old_name("keep_all").is_some() && RunOptions::old_name("no_shortcuts").is_none());
    }

    #[test]
    fn a_value_of_two_words_has_both_spellings() {
        for spelling in ["at-rest", "at_rest"] {
            assert_eq!(RunOptions::from_settings([("mu", spelling.to_owned())]).unwrap().model.mu, MuModel::AtRest);
        }
    }

    #[test]
    fn an_unknown_or_impossible_setting_is_named() {
        for (name, value, said) in [
            ("colour", "red", "unknown option \"colour\""),
            ("colour", "false", "unknown option \"colour\""),
            ("serious_tcc", "1", "unknown option \"serious_tcc\"; did you mean \"serious_ttc\"?"),
            ("serious_ttc", "-1", "invalid value '-1' for \"serious_ttc\": it must be 0 to 3600 s"),
            ("mu", "big", "invalid value 'big' for \"mu\"; possible values: minimal, at-rest, paper, rss"),
            ("artefacts", "3", "unexpected value '3' for \"artefacts\" found; no more were expected"),
        ] {
            let message = RunOptions::from_settings([(name, value.to_owned())]).unwrap_err().to_string();
            assert_eq!(message, said);
        }
    }
}
