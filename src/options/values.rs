//! Values of options: their ranges, and the command-line form of a setting.

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

/// A probability, 0 to 1.
pub(crate) fn probability(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("it must be a probability, 0 to 1".to_owned()),
    }
}

/// An angle in rad, 0 to π.
pub(crate) fn angle(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=std::f64::consts::PI).contains(&value) => Ok(value),
        _ => Err("it must be an angle in rad, 0 to π".to_owned()),
    }
}

/// The command-line word of a setting; none for a flag that is off.
pub(super) fn word(name: &str, value: &str) -> Option<String> {
    let option = name.replace('_', "-");
    match value {
        "true" => Some(format!("--{option}")),
        "false" => None,
        _ => Some(format!("--{option}={value}")),
    }
}
