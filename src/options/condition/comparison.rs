//! A measure compared with a number, and how far ahead the pairs that meet it have to be looked for.

use super::look_ahead::{LONGEST_PET, LookAhead};
use super::measure::Measure;
use crate::util::units::Second;

/// A measure compared with a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Comparison {
    pub measure: Measure,
    pub operator: Operator,
    pub value: f64,
}

/// How a measure is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operator {
    Below,
    AtMost,
    Above,
    AtLeast,
}

impl Operator {
    /// With how each is written; the longer first.
    pub const ALL: [(&str, Self); 4] =
        [("<=", Self::AtMost), (">=", Self::AtLeast), ("<", Self::Below), (">", Self::Above)];

    pub fn text(self) -> &'static str {
        Self::ALL.iter().find(|(_, operator)| *operator == self).map_or("", |(text, _)| text)
    }

    pub(crate) fn is_upper_bound(self) -> bool {
        matches!(self, Self::Below | Self::AtMost)
    }

    pub fn holds(self, measured: f64, value: f64) -> bool {
        match self {
            Self::Below => measured < value,
            Self::AtMost => measured <= value,
            Self::Above => measured > value,
            Self::AtLeast => measured >= value,
        }
    }
}

/// Why a comparison alone selects no pairs near each other.
const UNBOUNDED: &str = "holds for pairs however far ahead they meet; join it by \"and\" with a bound such as \
                         \"margin < 0\" or \"ttc < 5\"";

impl Comparison {
    /// The default comparison.
    pub const MARGIN: Self = Self { measure: Measure::Margin, operator: Operator::Below, value: 0.0 };

    /// How far ahead the pairs that meet it have to be looked for; an error says why no distance is enough.
    pub fn look_ahead(&self) -> Result<LookAhead, String> {
        let &Self { measure, operator, value } = self;
        let at_least_0 = value.max(0.0);
        match (measure, operator.is_upper_bound()) {
            (Measure::Pet, false) => {
                Err("asks for a late PET; a PET can only be bounded above, as in \"pet < 2\"".into())
            }
            (Measure::Pet, true) if value > LONGEST_PET => {
                Err(format!("asks for a longer PET than is looked for, {LONGEST_PET} s at most"))
            }
            (Measure::Pet, true) => Ok(LookAhead { pet: at_least_0, ..LookAhead::NONE }),
            (Measure::Gap | Measure::Margin, true) => Ok(LookAhead { metres: at_least_0, ..LookAhead::NONE }),
            (Measure::Ttc | Measure::Headway, true) => Ok(LookAhead { seconds: at_least_0, ..LookAhead::NONE }),
            (Measure::ResponseLeft, true) => Ok(LookAhead { response: at_least_0, ..LookAhead::NONE }),
            (Measure::CrashProbability, false) if operator.holds(0.0, value) => Err(UNBOUNDED.into()),
            // These exist only where the two would touch, which is looked for as long as a TTC is.
            (Measure::Drac | Measure::CrashProbability | Measure::ExtendedDeltaV, false) | (Measure::Ttb, true) => {
                Ok(LookAhead { seconds: Second::INFINITY, ..LookAhead::NONE })
            }
            // Current overlaps are always found.
            (Measure::Overlap, false) if operator.holds(0.0, value) => Err(UNBOUNDED.into()),
            (Measure::Overlap, false) => Ok(LookAhead::NONE),
            _ => Err(UNBOUNDED.into()),
        }
    }
}
