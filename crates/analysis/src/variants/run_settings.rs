//! What a run was made with, as texts by name: closecall's options, SUMO's, versions, step length.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::logged::LoggedRun;

/// Options of closecall that do not change what it finds.
const WITHOUT_EFFECT: [&str; 3] = ["keep_all", "log_series", "log_clips"];
/// Options of SUMO that do not change what it simulates, or whose effect is compared by other means; besides those for
/// files, outputs and messages, which [`of_sumo`] knows by their names.
const OF_SUMO_WITHOUT_EFFECT: [&str; 9] =
    ["seed", "step-length", "no-warnings", "verbose", "start", "quit-on-end", "delay", "breakpoints", "threads"];
/// Short options of SUMO.
const SHORT: [(&str, &str); 8] = [
    ("a", "additional-files"),
    ("b", "begin"),
    ("c", "configuration-file"),
    ("e", "end"),
    ("n", "net-file"),
    ("r", "route-files"),
    ("v", "verbose"),
    ("W", "no-warnings"),
];
/// What stands for a value that a run does not have.
pub(crate) const NONE: &str = "–";

/// A run's values: of settings, or the hashes of its input files by name.
pub type Values = BTreeMap<String, String>;

/// All that a run was made with, besides its seed and its files.
pub fn settings(run: &LoggedRun) -> Values {
    let mut values = of_sumo(&run.sumo_words);
    flatten("", &run.options, &mut values);
    values.retain(|name, _| !WITHOUT_EFFECT.contains(&name.as_str()));
    values.insert("closecall".to_owned(), run.versions.closecall.clone());
    values.insert("SUMO".to_owned(), run.versions.sumo.clone().unwrap_or_else(|| NONE.to_owned()));
    if let Some(length) = run.step_length {
        // A recording's times are sums of steps.
        values.insert("step_length".to_owned(), ((length * 1e6).round() / 1e6).to_string());
    }
    values
}

/// Options as text, `types.car.decel` for those of a type.
fn flatten(name: &str, value: &Value, into: &mut Values) {
    let text = match value {
        Value::Object(object) => {
            for (key, value) in object {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                flatten(&name, value, into);
            }
            return;
        }
        Value::Null => return,
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    into.insert(name.to_owned(), canonical(&text));
}

/// SUMO's options as `--vary` names them.
fn of_sumo(words: &[String]) -> Values {
    let name_of = |word: &str| {
        let is_option = word.starts_with('-') && word.parse::<f64>().is_err();
        is_option.then(|| word.trim_start_matches('-').to_owned())
    };
    let mut values = Values::new();
    let mut words = words.iter().peekable();
    while let Some(word) = words.next() {
        let Some(option) = name_of(word) else { continue };
        let (name, value) = match option.split_once('=') {
            Some((name, value)) => (name.to_owned(), value.to_owned()),
            None => {
                let value = words.next_if(|next| name_of(next).is_none());
                (option, value.map_or("true", |value| value).to_owned())
            }
        };
        let name = SHORT.iter().find(|(short, _)| *short == name).map_or(name, |(_, long)| (*long).to_owned());
        let is_file = name.ends_with("file") || name.ends_with("files");
        if !is_file
            && !["output", "log", "save-state"].iter().any(|part| name.contains(part))
            && !OF_SUMO_WITHOUT_EFFECT.contains(&name.as_str())
        {
            values.insert(format!("sumo:{name}"), canonical(&value));
        }
    }
    values
}

/// A number in one spelling.
fn canonical(text: &str) -> String {
    text.parse::<f64>().map_or_else(|_| text.to_owned(), |number| number.to_string())
}
