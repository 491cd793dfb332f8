//! Values of options and their ranges, as texts are read.
//!
//! # Errors
//! Each says what the value must be.

use crate::util::limits::{DECELERATION, DURATION, Limit, RESERVE, SPEED, TIME};

/// A duration in s.
pub fn duration(text: &str) -> std::result::Result<f64, String> {
    within(&DURATION, text)
}

/// The length of a step in s.
pub fn step_length(text: &str) -> std::result::Result<f64, String> {
    within(&Limit { is_open: true, ..DURATION }, text)
}

/// A simulated time in s, 0 or more.
pub fn time(text: &str) -> std::result::Result<f64, String> {
    within(&Limit { least: 0.0, ..TIME }, text)
}

/// A distance in m that is kept in reserve.
pub fn reserve(text: &str) -> std::result::Result<f64, String> {
    within(&RESERVE, text)
}

/// A speed in m/s.
pub fn speed(text: &str) -> std::result::Result<f64, String> {
    within(&SPEED, text)
}

/// A deceleration in m/s².
pub fn deceleration(text: &str) -> std::result::Result<f64, String> {
    within(&DECELERATION, text)
}

/// A threshold of decelerations in m/s²; 0 for none.
pub fn deceleration_threshold(text: &str) -> std::result::Result<f64, String> {
    within(&Limit { least: 0.0, ..DECELERATION }, text)
}

fn within(limit: &Limit, text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|value| limit.holds(*value));
    value.ok_or_else(|| format!("it must be {}", limit.range()))
}

/// A probability, 0 to 1.
pub fn probability(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("it must be a probability, 0 to 1".to_owned()),
    }
}

/// A share above 0, up to 1.
pub fn share(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value <= 1.0 => Ok(value),
        _ => Err("it must be a share above 0, up to 1".to_owned()),
    }
}

/// An angle in rad, 0 to π.
pub fn angle(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=std::f64::consts::PI).contains(&value) => Ok(value),
        _ => Err("it must be an angle in rad, 0 to π".to_owned()),
    }
}
