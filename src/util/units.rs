//! Units as types: every quantity is an `f64` in SI units, named by its alias. Also counts in words.

/// A length or distance in m.
pub type Metre = f64;
/// A point in time or a duration in s.
pub type Second = f64;
/// Simulated times are sums of steps: times that differ by less are equal, in s.
pub const SAME_MOMENT: Second = 1e-6;
/// A speed in m/s.
pub type MetrePerSecond = f64;
/// A deceleration or acceleration in m/s².
pub type MetrePerSecondSquared = f64;
/// A duration times a duration, in s².
pub type SecondSquared = f64;
/// A change of kinetic energy per mass and time, in m²/s³.
pub type MetreSquaredPerSecondCubed = f64;
/// A number without unit.
pub type Ratio = f64;
/// An angle in rad, counter-clockwise from +x.
pub type Radian = f64;
/// An angle of longitude or latitude, in degrees: the only angle not in rad, as maps have it so.
pub type Degree = f64;
/// A probability, 0 to 1.
pub type Probability = f64;
/// A mass in kg.
pub(crate) type Kilogram = f64;

/// A count in words, as in `2 runs`.
pub fn counted(number: u64, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
