//! The time left to respond: the inverse of μ.

use super::brakes::{Braking, MuModel};
use super::late::{LateBraking, Leader};
use super::{narrowest, rss};
use crate::util::units::{Metre, Second};

/// The longest response time T = t1 + t2 of the ego, in s, with which μ(T) does not exceed the gap: 0 where even an immediate
/// response needs more room, infinite where the ego stands and any response would do.
///
/// The arguments are those of [`super::mu`], where a foe for σ > 0 brakes at once. The relative error is below 1e-9
/// where gap and μ do not nearly cancel.
///
/// ```
/// use closecall::{Brakes, Braking, MuModel, response_left};
/// let brakes = Brakes { response: 1.05, build_up: 0.0, deceleration: 8.0 };
/// let (ego, foe) = (Braking { speed: 20.0, brakes: &brakes }, Braking { speed: 0.0, brakes: &brakes });
/// // 25 m to stop and 10 m more, at 20 m/s.
/// assert_eq!(response_left(MuModel::Minimal, ego, foe, 1.0, 0.5, 35.5), 0.5);
/// ```
pub fn response_left(model: MuModel, ego: Braking, foe: Braking, sigma: f64, epsilon: Metre, gap: Metre) -> Second {
    let brakes = ego.brakes;
    let left = match (model, leader(foe, sigma, gap - epsilon)) {
        (MuModel::Paper, _) => {
            let needed = ego.speed * brakes.build_up + ego.speed / (2.0 * brakes.deceleration) * ego.speed;
            let others = foe.speed / (2.0 * foe.brakes.deceleration) * foe.speed;
            (gap - epsilon + others - needed) / ego.speed
        }
        (MuModel::Rss, _) => rss::longest_response(ego.speed, foe.speed, sigma, gap - epsilon),
        (model, leader) => {
            let ego = LateBraking {
                speed: ego.speed,
                present: 0.0,
                build_up: brakes.build_up,
                deceleration: brakes.deceleration,
            };
            let leader = match model {
                MuModel::AtRest => Leader { room: leader.room + stands_after(&leader), speed: 0.0, deceleration: 0.0 },
                _ => leader,
            };
            ego.longest_wait_behind(&leader)
        }
    };
    // A gap below ε is too small for any response.
    if gap < epsilon && model != MuModel::Paper { 0.0 } else { left.max(0.0) }
}

/// The foe as μ sees it, in line with the ego: for σ > 0 it brakes at once and fully, with the share σ of its speed; for
/// σ ≤ 0 its whole way takes room away.
pub fn leader(foe: Braking, sigma: f64, room: Metre) -> Leader {
    if sigma > 0.0 {
        Leader { room, speed: sigma * foe.speed, deceleration: sigma * foe.brakes.deceleration }
    } else {
        let stopping = narrowest::stopping_distance::<f64>(foe.speed, foe.brakes);
        Leader { room: room + sigma * stopping, speed: 0.0, deceleration: 0.0 }
    }
}

/// How far a leader travels until it stands.
fn stands_after(leader: &Leader) -> Metre {
    if leader.speed > 0.0 { leader.speed / (2.0 * leader.deceleration) * leader.speed } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::braking::tests::brakes;
    use crate::braking::{Brakes, mu};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn mu_with_the_response_left_is_the_gap(
            ego_brakes in brakes(), foe_brakes in brakes(), v in 0.0..60.0, vi in 0.0..60.0, sigma in -1.0..=1.0,
            gap in 0.0..150.0, model in prop::sample::select(&MuModel::ALL[..]),
        ) {
            let foe_brakes = if sigma > 0.0 { foe_brakes.at_once() } else { foe_brakes };
            let foe = Braking { speed: vi, brakes: &foe_brakes };
            let left = response_left(model, Braking { speed: v, brakes: &ego_brakes }, foe, sigma, 0.5, gap);
            prop_assert!(left >= 0.0);
            let needed = |response| mu(model, Braking { speed: v, brakes: &Brakes { response, ..ego_brakes } }, foe, sigma, 0.5);
            if left == 0.0 {
                prop_assert!(needed(1e-6) > gap - 1e-6 * (1.0 + gap));
            } else if left < f64::INFINITY {
                prop_assert!((needed(left) - gap).abs() < 1e-8 * (1.0 + gap + v * left), "{} m for {left} s", needed(left));
            } else {
                prop_assert!(needed(1e6) <= gap);
            }
        }
    }

    #[test]
    fn one_that_stands_has_any_time() {
        let brakes = Brakes { response: 1.0, build_up: 0.1, deceleration: 8.0 };
        let at = |speed| Braking { speed, brakes: &brakes };
        assert_eq!(response_left(MuModel::Minimal, at(0.0), at(5.0), 1.0, 0.5, 0.6), f64::INFINITY);
        assert_eq!(response_left(MuModel::Minimal, at(5.0), at(5.0), 1.0, 0.5, 0.4), 0.0);
    }
}
