//! The result for a pair: which of the two is the ego, and where it meets the foe.

use super::conflict_point::ConflictPoint;

/// Which of a pair is the ego; the other is the foe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ego {
    /// The first of the pair.
    First,
    /// The second of the pair.
    Second,
}

impl Ego {
    /// The first of the pair if `first` holds, otherwise the second.
    pub fn first_if(first: bool) -> Self {
        if first { Self::First } else { Self::Second }
    }

    /// The pair in the order ego, foe.
    pub fn then_foe<T>(self, [first, second]: [T; 2]) -> [T; 2] {
        match self {
            Self::First => [first, second],
            Self::Second => [second, first],
        }
    }
}

/// How the two of a pair meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Which of the two is the ego.
    pub ego: Ego,
    /// Where the ego meets the foe.
    pub conflict_point: ConflictPoint,
}
