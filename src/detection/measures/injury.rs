//! The probability that the worse-off road user of a collision is fatally injured: in a vehicle from its ΔV, unprotected from
//! the speed of the impact.

use crate::detection::kind::Kind;
use crate::traffic::profile::Profile;
use crate::util::units::MetrePerSecond;

/// A road user in a collision.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Its change of speed.
    pub delta_v: MetrePerSecond,
    /// Whether nothing protects its occupants.
    pub unprotected: bool,
}

impl Body {
    /// That of a road user of this profile.
    pub const fn of(profile: &Profile, delta_v: MetrePerSecond) -> Self {
        Self { delta_v, unprotected: profile.unprotected }
    }
}

/// Where a vehicle is hit.
#[derive(Clone, Copy)]
enum Hit {
    Front,
    Side,
    Rear,
}

/// The larger probability of a fatal injury, of the ego's occupants and of the foe's.
///
/// Those that nothing protects: 1 / (1 + exp(6.9 − 0.090 v)) with the impact speed v in km/h, for adult pedestrians that the front of
/// a car hits (Rosén and Sander 2009). The impact speed is the speed at which the two close in, which is the sum of both ΔV. No
/// curve is known for two that nothing protects: there v is the ΔV of each, as nothing heavier hits it. Occupants of vehicles:
/// 1 / (1 + exp(9.032 − 0.198 v − 1.462 side + 1.921 rear)) with ΔV v in mph (Malliaris, Digges and DeBlois 1997). The ego hits
/// with its front; where the foe is hit follows from the kind.
pub fn injury_probability(kind: Kind, ego: Body, foe: Body) -> f64 {
    let foe_is_hit_at = match kind {
        Kind::Frontal => Hit::Front,
        Kind::Side => Hit::Side,
        Kind::RearEnd => Hit::Rear,
    };
    let impact = ego.delta_v + foe.delta_v;
    let speed = |one: Body, other: Body| if one.unprotected && !other.unprotected { impact } else { one.delta_v };
    let of_ego = fatal(speed(ego, foe), ego.unprotected, Hit::Front);
    of_ego.max(fatal(speed(foe, ego), foe.unprotected, foe_is_hit_at))
}

fn fatal(speed: MetrePerSecond, unprotected: bool, hit: Hit) -> f64 {
    /// Kilometres per hour and miles per hour in 1 m/s.
    const KILOMETRES_PER_HOUR: f64 = 3.6;
    const MILES_PER_HOUR: f64 = 3600.0 / 1609.344;
    let exponent = if unprotected {
        0.090 * KILOMETRES_PER_HOUR * speed - 6.9
    } else {
        let direction = match hit {
            Hit::Front => 0.0,
            Hit::Side => 1.462,
            Hit::Rear => -1.921,
        };
        0.198 * MILES_PER_HOUR * speed + direction - 9.032
    };
    1.0 / (1.0 + (-exponent).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detection::measures::delta_v;

    const STANDS: Body = Body { delta_v: 0.0, unprotected: false };

    #[test]
    fn a_pedestrian_hit_at_50_kilometres_per_hour_dies_with_8_per_cent() {
        // Whatever the car weighs.
        for mass in [900.0, 1500.0, 3500.0] {
            let [of_car, of_walker] = delta_v((50.0 / 3.6, mass), (0.0, 75.0), std::f64::consts::FRAC_PI_2);
            let car = Body { delta_v: of_car, unprotected: false };
            let walker = Body { delta_v: of_walker, unprotected: true };
            let found = injury_probability(Kind::Side, car, walker);
            assert!((found - 0.083).abs() < 5e-4, "{found}");
            assert_eq!(found, injury_probability(Kind::Side, walker, car), "whichever is the ego");
        }
    }

    #[test]
    fn a_bicycle_hits_a_pedestrian_less_hard_than_a_car() {
        let walker = Body { delta_v: 3.0, unprotected: true };
        let found = |unprotected| injury_probability(Kind::Side, Body { delta_v: 3.0, unprotected }, walker);
        assert!(found(true) < found(false));
    }

    #[test]
    fn a_side_is_worse_than_a_front_and_a_front_than_a_rear() {
        let foe = Body { delta_v: 15.0, unprotected: false };
        let [rear, front, side] =
            [Kind::RearEnd, Kind::Frontal, Kind::Side].map(|kind| injury_probability(kind, STANDS, foe));
        assert!(rear < front && front < side, "{rear}, {front}, {side}");
    }
}
