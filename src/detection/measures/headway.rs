//! Time headway (THW) of a follower: the time in which it reaches the place where the foe's rear is now.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_metres_at_twenty_metres_per_second_are_one_second() {
        assert_eq!(headway(Kind::RearEnd, 20.0, 20.0), Some(1.0));
    }

    #[test]
    fn only_a_follower_that_moves_has_a_headway() {
        assert_eq!(headway(Kind::Side, 20.0, 20.0), None);
        assert_eq!(headway(Kind::Frontal, 20.0, 20.0), None);
        assert_eq!(headway(Kind::RearEnd, 20.0, 0.0), None);
    }
}
