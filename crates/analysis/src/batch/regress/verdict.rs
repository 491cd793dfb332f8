//! The result of comparing two outcomes.

use super::exact::Differences;
use super::statistics::MeasureComparison;

/// The result of comparing two outcomes, by the level of the comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Compared {
    /// Byte for byte.
    Exactly(Differences),
    /// By the statistical test; with the reason if an exact comparison was asked for.
    Statistically(Vec<MeasureComparison>, Option<String>),
}

impl Compared {
    /// Whether nothing differs.
    pub fn is_same(&self) -> bool {
        match self {
            Self::Exactly(differences) => differences.is_empty(),
            Self::Statistically(comparisons, _) => comparisons.iter().all(|comparison| !comparison.differs),
        }
    }
}
