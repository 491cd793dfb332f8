//! Any text as a TOML file of options gives words for the command line or an error, never a panic.

#![no_main]

use std::path::Path;

use closecall::Options;
use closecall::internals::options::OptionsFile;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let known = ["mu", "epsilon", "obstacles", "keep-all", "response-time"].map(str::to_owned);
    let Ok(file) = OptionsFile::parse(Path::new("fuzz"), text, &known) else { return };
    let settings = file.words.iter().filter_map(|word| word.trim_start_matches("--").split_once('='));
    let settings = settings.map(|(name, value)| (name, value.to_owned())).collect::<Vec<_>>();
    let _ = Options::from_settings(settings);
});
