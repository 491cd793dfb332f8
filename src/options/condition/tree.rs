//! Comparisons joined by `and` and `or`.

use std::fmt;

use super::comparison::{Comparison, Operator};
use super::look_ahead::LookAhead;
use super::measure::Measure;
use crate::util::units::Second;

/// Comparisons, and how they are joined.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Tree {
    Compare(Comparison),
    And(Vec<Tree>),
    Or(Vec<Tree>),
}

impl Tree {
    /// `Condition::pet_below` has what it is.
    pub fn pet_below(&self, measure: &impl Fn(Measure) -> Option<f64>, may_have_pet: bool) -> Second {
        match self {
            Self::Compare(Comparison { measure: Measure::Pet, operator, value }) if may_have_pet => match operator {
                Operator::AtMost => value.next_up(),
                _ => *value,
            },
            Self::Compare(Comparison { measure: of, operator, value }) => {
                if measure(*of).is_some_and(|measured| operator.holds(measured, *value)) {
                    Second::INFINITY
                } else {
                    Second::NEG_INFINITY
                }
            }
            Self::And(parts) => {
                parts.iter().map(|part| part.pet_below(measure, may_have_pet)).fold(Second::INFINITY, Second::min)
            }
            Self::Or(parts) => {
                parts.iter().map(|part| part.pet_below(measure, may_have_pet)).fold(Second::NEG_INFINITY, Second::max)
            }
        }
    }

    pub(crate) fn needs_pet(&self) -> bool {
        match self {
            Self::Compare(comparison) => comparison.measure == Measure::Pet,
            Self::And(parts) | Self::Or(parts) => parts.iter().any(Self::needs_pet),
        }
    }

    /// The largest bound of the PET; 0 where there is none.
    pub(crate) fn longest_pet(&self) -> Second {
        match self {
            Self::Compare(Comparison { measure: Measure::Pet, value, .. }) => *value,
            Self::Compare(_) => 0.0,
            Self::And(parts) | Self::Or(parts) => parts.iter().map(Self::longest_pet).fold(0.0, Second::max),
        }
    }

    /// If all parts have to hold, the shortest look-ahead is enough.
    pub fn look_ahead(&self) -> Result<LookAhead, String> {
        match self {
            Self::Compare(comparison) => comparison.look_ahead().map_err(|why| format!("\"{self}\" {why}")),
            Self::Or(parts) => {
                parts.iter().try_fold(LookAhead::NONE, |furthest, part| Ok(furthest.or(part.look_ahead()?)))
            }
            Self::And(parts) => {
                let mut bounded = parts.iter().map(Self::look_ahead);
                let first = bounded.next().unwrap_or(Ok(LookAhead::NONE));
                bounded.fold(first, |least, part| match (least, part) {
                    (Ok(least), Ok(part)) => Ok(least.nearer(part)),
                    (least, part) => least.or(part),
                })
            }
        }
    }
}

impl fmt::Display for Tree {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let joined = |f: &mut fmt::Formatter, parts: &[Self], word: &str| {
            parts.iter().enumerate().try_for_each(|(number, part)| {
                let word = if number > 0 { word } else { "" };
                match part {
                    Self::Compare(_) => write!(f, "{word}{part}"),
                    _ => write!(f, "{word}({part})"),
                }
            })
        };
        match self {
            Self::Compare(Comparison { measure, operator, value }) => {
                write!(f, "{measure} {} {value}", operator.text())
            }
            Self::And(parts) => joined(f, parts, " and "),
            Self::Or(parts) => joined(f, parts, " or "),
        }
    }
}
