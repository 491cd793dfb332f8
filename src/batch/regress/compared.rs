//! How two outcomes were compared, and what differs.

use super::exact::Differences;
use super::statistics::Comparison;

/// How two outcomes were compared, and what differs.
#[derive(Clone, Debug, PartialEq)]
pub enum Compared {
    /// Byte for byte.
    Exactly(Differences),
    /// By the statistical test, and why not exactly, where that was asked for.
    Statistically(Vec<Comparison>, Option<String>),
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
