//! The options of a run as a `closecall.toml`.

use std::fmt::Write;

use serde_json::{Map, Value};

use closecall::options::Options;

/// Options that a cut-out has values of its own for, and those that only write more files or count.
const OTHERS: [&str; 6] = ["filter", "keep_all", "log_clips", "log_encounters", "log_series", "warmup"];

/// The options of a `run.json` that differ from the defaults, as TOML, with these lines before them. Texts, numbers and lists
/// look the same in JSON and TOML.
pub fn toml(options: &Value, first: &str) -> String {
    let none = Map::new();
    let options = options.as_object().unwrap_or(&none);
    let defaults = serde_json::to_value(Options::default()).unwrap_or_default();
    let mut text = first.to_owned();
    for (name, value) in options.iter().filter(|(name, _)| !OTHERS.contains(&name.as_str())) {
        if !value.is_null() && !value.is_object() && defaults.get(name) != Some(value) {
            line(&mut text, name, value);
        }
    }
    if let Some(driver) = options.get("driver_options").and_then(Value::as_object) {
        table(&mut text, "driver", driver);
    }
    for (name, settings) in options.get("types").and_then(Value::as_object).into_iter().flatten() {
        let name = format!("type.{}", Value::from(name.as_str()));
        let Some(settings) = settings.as_object() else { continue };
        table(&mut text, &name, settings);
        if let Some(driver) = settings.get("driver").and_then(Value::as_object) {
            table(&mut text, &format!("{name}.driver"), driver);
        }
    }
    text
}

fn table(text: &mut String, name: &str, settings: &Map<String, Value>) {
    let set = settings.iter().filter(|(_, value)| !value.is_null() && !value.is_object()).collect::<Vec<_>>();
    if !set.is_empty() {
        let _ = writeln!(text, "\n[{name}]");
        set.into_iter().for_each(|(name, value)| line(text, name, value));
    }
}

fn line(text: &mut String, name: &str, value: &Value) {
    let _ = writeln!(text, "{name} = {value}");
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use closecall::options::{BrakeSystem, DriverOptions, TypeOptions};
    use closecall_run::options::OptionsFile;
    use closecall_run::options::{LogOptions, RunOptions};

    #[test]
    fn settings_are_read_back_as_the_run_had_them() {
        let given =
            [("mu", "at-rest"), ("response_time", "1"), ("obstacles", "crate,box"), ("log", "ttc < 3 or pet < 2")];
        let given = given.into_iter().chain([("measures", "tadv,t2"), ("align", "never"), ("epsilon", "0.1")]);
        let mut options = RunOptions::from_settings(given.map(|(name, value)| (name, value.to_owned()))).unwrap();
        let driver = DriverOptions { response_mean: Some(1.25), ..DriverOptions::default() };
        options.model.driver_options = driver.clone();
        let bus = TypeOptions { brakes: Some(BrakeSystem::Pneumatic), driver, ..TypeOptions::default() };
        options.model.types.extend([("a \"bus\"".to_owned(), bus)]);
        let text = toml(&serde_json::to_value(&options).unwrap(), "warmup = 2.5\n");
        let known = ["mu", "response-time", "obstacles", "log", "measures", "align", "epsilon", "warmup"];
        let file =
            OptionsFile::parse(Path::new("closecall.toml"), &text, &known.map(str::to_owned), |_, _| Ok(None)).unwrap();
        let args = file.args.iter().map(|word| word.trim_start_matches("--").split_once('=').unwrap());
        let mut read = RunOptions::from_settings(args.map(|(name, value)| (name, value.to_owned()))).unwrap();
        read.set_tables(file);
        assert_eq!(read, RunOptions { log: LogOptions { warmup: 2.5, ..options.log.clone() }, ..options });
    }
}
