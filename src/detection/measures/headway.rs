//! Headways of a follower: the time gap (`headway`) and the time headway (THW, Vogel 2003).

use crate::detection::kind::Kind;
use crate::util::units::{Metre, MetrePerSecond, Second};

/// The headway in s: the room between the ego's front bumper and the foe's rear over the ego's speed (the time gap of SAE
/// J2944). None if the conflict is not rear-end or the ego stands.
///
/// ```text
/// headway = gap / speed
/// ```
pub fn headway(kind: Kind, gap: Metre, speed: MetrePerSecond) -> Option<Second> {
    (kind == Kind::RearEnd && speed > 0.0).then(|| gap / speed)
}

/// The time headway in s: from front to front, after which time the follower is where its leader's front is now. None in the
/// same cases.
///
/// ```text
/// THW = (gap + leader's length) / speed
/// ```
pub(crate) fn time_headway(kind: Kind, gap: Metre, leader: Metre, speed: MetrePerSecond) -> Option<Second> {
    headway(kind, gap + leader, speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_metres_at_twenty_metres_per_second_are_one_second() {
        assert_eq!(headway(Kind::RearEnd, 20.0, 20.0), Some(1.0));
        assert_eq!(time_headway(Kind::RearEnd, 20.0, 5.0, 20.0), Some(1.25));
    }

    #[test]
    fn only_a_follower_that_moves_has_a_headway() {
        assert_eq!(headway(Kind::Side, 20.0, 20.0), None);
        assert_eq!(headway(Kind::Frontal, 20.0, 20.0), None);
        assert_eq!(headway(Kind::RearEnd, 20.0, 0.0), None);
        assert_eq!(time_headway(Kind::RearEnd, 20.0, 5.0, 0.0), None);
    }
}
