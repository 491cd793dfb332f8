//! The result for a pair: which of the two is the ego, and where it meets the foe.

use super::conflict_point::ConflictPoint;
use super::participant::Participant;

/// Values that differ by less than this are equal but for rounding, in m²/s or m.
pub(super) const ALIKE: f64 = 1e-9;

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
    pub(crate) fn first_if(first: bool) -> Self {
        if first { Self::First } else { Self::Second }
    }

    /// The ego of two that are equally far from the conflict point, as two in contact are: the one that moves faster towards the
    /// other's middle, so of a follower and its leader the follower; then the one that faces the other; of mirror images the
    /// first.
    pub(crate) fn of_equals([first, second]: [&Participant; 2]) -> Self {
        let between = second.rectangle.centre - first.rectangle.centre;
        let [of_first, of_second] = [first.rectangle.axis.dot(&between), -second.rectangle.axis.dot(&between)];
        let closes = first.speed * of_first - second.speed * of_second;
        Self::first_if(if closes.abs() > ALIKE { closes > 0.0 } else { of_first - of_second >= -ALIKE })
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
