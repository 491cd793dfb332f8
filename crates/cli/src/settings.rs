//! Options from a TOML file, for all commands.

use std::path::Path;

use clap::{Arg, Command};

use closecall_run::Result;
use closecall_run::RunOptions;
use closecall_run::options::OptionsFile;

/// Reads a TOML file. Its keys may be long options of any command, so that one file can serve several commands.
pub fn read(all: &Command, path: &Path) -> Result<OptionsFile> {
    OptionsFile::read(path, &known(all), RunOptions::check_setting)
}

/// The long options of all commands.
pub fn known(all: &Command) -> Vec<String> {
    all.get_subcommands().flat_map(options_of).collect()
}

/// The long options of one command.
pub(crate) fn long_options(all: &Command, name: &str) -> Vec<String> {
    all.find_subcommand(name).map(options_of).unwrap_or_default()
}

/// The name of the option in a word such as `--mu=paper`.
pub(crate) fn option_of(word: &str) -> &str {
    let name = word.trim_start_matches('-');
    name.split_once('=').map_or(name, |(name, _)| name)
}

/// The long options of one command, also under their old names.
fn options_of(command: &Command) -> Vec<String> {
    let names = |argument| Arg::get_long(argument).into_iter().chain(argument.get_all_aliases().unwrap_or_default());
    let named = command.get_arguments().flat_map(names);
    named.filter(|name| !["config", "help", "version"].contains(name)).map(str::to_owned).collect()
}
