//! How a road user brakes, and the minimal collision distance μ (Guan et al. 2008, eq. 5–21, corrected).
//!
//! A braking road user keeps its speed V for its response time r = t1 + t2. Then its deceleration rises linearly to a
//! over t3 and stays there until the road user stands, which may be before t3 is over. μ is the room that the ego needs
//! so that both can brake without contact. [`MuModel`] lists its models.
//!
//! μ is logged with 15 digits, which must be right also where S − Si cancels. [`mu`] computes the formulas in plain
//! f64; where the result is much smaller than its terms, it computes them again in twice the precision
//! ([`crate::util::double_double`]).

mod brakes;
mod late;
mod narrowest;
mod needed;
mod response_left;
pub mod rss;

use crate::util::double_double::{DoubleDouble, Number};
use crate::util::units::{Metre, MetrePerSecond};
use needed::Needed;

pub use brakes::{Brakes, Braking, MuModel};
pub use late::{LateBraking, Leader};
pub use response_left::{leader, response_left};

/// The stopping distance in m, exactly, with V₃ = V − a·t3/2:
///
/// ```text
/// V₃ ≥ 0:  S(V) = V (t1+t2) + V t3/2 + V²/(2a) − a t3²/24
/// V₃ < 0:  S(V) = V (t1+t2) + (2/3) V √(2 V t3 / a)
/// ```
pub fn stopping_distance(speed: MetrePerSecond, brakes: &Brakes) -> Metre {
    narrowest::stopping_distance(speed, brakes)
}

/// The stopping distance in m as printed (eq. 17): t3 at full speed, then V² at the undiminished speed.
pub(crate) fn stopping_distance_paper(speed: MetrePerSecond, brakes: &Brakes) -> Metre {
    speed * (brakes.response + brakes.build_up) + speed / (2.0 * brakes.deceleration) * speed
}

/// The minimal collision distance in m, with σ = cos α of the angle between the headings at the conflict point:
///
/// ```text
/// minimal:  max over t ≥ 0 of ( travel_ego(t) − σ · travel_foe(t) ) + ε,  never below ε
/// at_rest:  S − σ Si + ε,  never below ε
/// paper:    S − Si + ε  (eq. 17–21; Si = Vi²/(2 ai))
/// rss:      the safe distance of RSS, whatever the brakes, + ε
/// ```
///
/// For σ > 0 the foe brakes at once and fully; for σ ≤ 0 it needs response and build-up like the ego. The relative
/// error is below 1e-12 as long as no intermediate value leaves the range of normal f64.
///
/// ```
/// use closecall::{Brakes, Braking, MuModel, mu};
/// let strong = Brakes { response: 1.0, build_up: 0.0, deceleration: 8.0 };
/// let weak = Brakes { deceleration: 4.0, ..strong };
/// let (ego, foe) = (Braking { speed: 30.0, brakes: &strong }, Braking { speed: 25.0, brakes: &weak });
/// assert_eq!(mu(MuModel::AtRest, ego, foe, 1.0, 0.0), 8.125);
/// assert_eq!(mu(MuModel::Minimal, ego, foe, 1.0, 0.0), 17.125);
/// ```
pub fn mu(model: MuModel, ego: Braking, foe: Braking, sigma: f64, epsilon: Metre) -> Metre {
    if let (MuModel::Minimal | MuModel::AtRest, true) = (model, sigma <= 0.0) {
        // Both distances add: nothing cancels, and the narrowest moment is at rest.
        return stopping_distance(ego.speed, ego.brakes) - sigma * stopping_distance(foe.speed, foe.brakes) + epsilon;
    }
    let plain = needed::<f64>(model, ego, foe, sigma);
    // The paper's model has no floor: ε may cancel the rest.
    let sum = if model == MuModel::Paper { plain.distance + epsilon } else { plain.distance };
    if plain.trusted(sum) {
        return add_epsilon(model, plain.distance, epsilon);
    }
    let twofold = needed::<DoubleDouble>(model, ego, foe, sigma).distance + DoubleDouble::from(epsilon);
    if model == MuModel::Paper { twofold.value() } else { twofold.value().max(epsilon) }
}

fn add_epsilon(model: MuModel, distance: Metre, epsilon: Metre) -> Metre {
    if model == MuModel::Paper { distance + epsilon } else { distance.max(0.0) + epsilon }
}

/// The room that the ego needs, before ε and the floor.
fn needed<N: Number>(model: MuModel, ego: Braking, foe: Braking, sigma: f64) -> Needed<N> {
    match model {
        MuModel::Minimal => narrowest::minimal::<N>(ego, foe, sigma),
        MuModel::AtRest => narrowest::at_rest::<N>(ego, foe, sigma),
        MuModel::Paper => narrowest::on_paper::<N>(ego, foe),
        MuModel::Rss => Needed { distance: N::from(rss::safe_distance(ego.speed, foe.speed, sigma)), scale: 0.0 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The distance travelled by a time, by definition.
    fn travel(braking: Braking, time: f64) -> f64 {
        let Brakes { response, build_up, deceleration } = *braking.brakes;
        let speed = braking.speed;
        if time <= response {
            return speed * time;
        }
        let ramp = if speed < deceleration * build_up / 2.0 {
            (2.0 * speed * build_up / deceleration).sqrt()
        } else {
            build_up
        };
        let on_ramp = (time - response).min(ramp);
        let mut distance = speed * (response + on_ramp);
        if build_up > 0.0 {
            distance -= deceleration / (6.0 * build_up) * on_ramp.powi(3);
        }
        let left = speed - deceleration * build_up / 2.0;
        if left > 0.0 && time > response + build_up {
            let braking = (time - response - build_up).min(left / deceleration);
            distance += left * braking - deceleration * braking * braking / 2.0;
        }
        distance
    }

    /// Any brakes, some of them without a build-up.
    pub(super) fn brakes() -> impl Strategy<Value = Brakes> {
        (0.0..2.0, prop_oneof![Just(0.0), 0.0..3.0], 0.5..12.0).prop_map(|(response, build_up, deceleration)| Brakes {
            response,
            build_up,
            deceleration,
        })
    }

    proptest! {
        #[test]
        fn minimal_is_the_largest_over_all_moments(
            ego_brakes in brakes(), foe_brakes in brakes(), v in 0.0..60.0, vi in 0.0..60.0, sigma in -1.0..=1.0,
        ) {
            let foe_brakes = if sigma > 0.0 { foe_brakes.at_once() } else { foe_brakes };
            let ego = Braking { speed: v, brakes: &ego_brakes };
            let foe = Braking { speed: vi, brakes: &foe_brakes };
            let found = mu(MuModel::Minimal, ego, foe, sigma, 0.5);
            let most = (0..200_000)
                .map(|step| f64::from(step) * 1e-3)
                .map(|time| travel(ego, time) - sigma * travel(foe, time))
                .fold(0.0, f64::max) + 0.5;
            prop_assert!((found - most).abs() < 1e-4, "{found} against {most} by small steps");
        }

        #[test]
        fn both_precisions_agree_where_nothing_cancels(
            ego_brakes in brakes(), foe_brakes in brakes(), v in 20.0..60.0, vi in 0.0..20.0, sigma in 0.1..=1.0,
        ) {
            let ego = Braking { speed: v, brakes: &ego_brakes };
            let foe = Braking { speed: vi, brakes: &foe_brakes };
            let plain = needed::<f64>(MuModel::Minimal, ego, foe, sigma);
            let twofold = needed::<DoubleDouble>(MuModel::Minimal, ego, foe, sigma).distance.value();
            if plain.trusted(plain.distance) && twofold > 0.0 {
                prop_assert!((plain.distance / twofold - 1.0).abs() < 1e-13, "{} {twofold}", plain.distance);
            }
        }
    }

    #[test]
    fn standing_before_the_build_up_ends_needs_less() {
        let brakes = Brakes { response: 0.0, build_up: 2.0, deceleration: 8.0 };
        assert!((stopping_distance(1.0, &brakes) - 2.0 / 3.0 * 0.5_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn equal_speeds_and_brakes_need_only_the_response_and_epsilon() {
        let brakes = Brakes { response: 1.0, build_up: 0.0, deceleration: 7.3 };
        let both = Braking { speed: 33.3, brakes: &brakes };
        assert_eq!(mu(MuModel::AtRest, both, both, 1.0, 0.5), 33.8);
        let none = Braking { speed: 33.3, brakes: &brakes.at_once() };
        assert_eq!(mu(MuModel::Minimal, none, none, 1.0, 0.0), 0.0);
    }

    #[test]
    fn the_paper_always_subtracts() {
        let brakes = Brakes { response: 1.05, build_up: 0.1, deceleration: 8.0 };
        let (ego, foe) = (Braking { speed: 10.0, brakes: &brakes }, Braking { speed: 20.0, brakes: &brakes });
        let found = mu(MuModel::Paper, ego, foe, -1.0, 0.5);
        assert!((found - (11.5 + 6.25 - 25.0 + 0.5)).abs() < 1e-12);
    }
}
