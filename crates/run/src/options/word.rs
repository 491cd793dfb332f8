//! Settings as words of a command line.

/// The command-line word of a setting; none for a flag that is off.
pub(super) fn word(name: &str, value: &str) -> Option<String> {
    let option = name.replace('_', "-");
    match value {
        "true" => Some(format!("--{option}")),
        "false" => None,
        _ => Some(format!("--{option}={value}")),
    }
}
