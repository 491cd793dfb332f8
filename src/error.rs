//! Errors of the method.

use crate::util::units::Radian;

/// The result of the library's functions.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of the method. Its `Display` is one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A dimension, mass or brake value of a profile is beyond its limit.
    #[error("type \"{name}\": {why}")]
    Profile {
        /// The profile's name.
        name: String,
        /// Which value, and what it must be.
        why: String,
    },
    /// The bounds between the kinds of conflict overlap.
    #[error("rear_end_below ({rear_end_below} rad) must not be above frontal_above ({frontal_above} rad)")]
    Kinds {
        /// A conflict is rear-end below this angle.
        rear_end_below: Radian,
        /// A conflict is frontal above this angle.
        frontal_above: Radian,
    },
    /// The condition of the log needs pairs that the paper's flow chart does not find.
    #[error(
        "log: \"{condition}\" needs pairs beyond the paper's detection radius, within which --mode paper finds them"
    )]
    BeyondPaper {
        /// The condition.
        condition: String,
    },
    /// A threshold is set that the rule of the severity does not ask for.
    #[error("{name}: it has no effect without severity_rule {rule}")]
    OtherRule {
        /// The threshold's option.
        name: &'static str,
        /// The rule that asks for it.
        rule: &'static str,
    },
    /// The path that is really driven is asked for where it is not known.
    #[error("path: driven is where road users drive afterwards, which only a recording knows: see closecall replay")]
    FutureUnknown,
}
