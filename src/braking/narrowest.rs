//! How much farther the ego travels than a foe that drives the same way (σ > 0) and brakes at once.
//!
//! f(t) = travel_ego(t) − σ · travel_foe(t) grows as long as g = v_ego − σ v_foe is above 0. While both move, v_ego is
//! concave and σ v_foe is linear, so g is concave and has at most one crossing from + to −:
//!
//! - If the foe stands first, g ends above 0: without such a crossing, the narrowest moment is at rest.
//! - If the ego stands first, the narrowest moment is that crossing. It lies in the build-up or after it, never during
//!   the response, when only the foe brakes.
//!
//! f at the crossing is computed from the relative speed g0 = V − σ Vi, so that the part common to both never enters.

use super::brakes::{Brakes, Braking};
use super::needed::Needed;
use crate::util::double_double::Number;
use crate::util::units::MetrePerSecond;

/// The stopping distance S(V), in either precision.
pub fn stopping_distance<N: Number>(speed: MetrePerSecond, brakes: &Brakes) -> N {
    let n = N::from;
    let (v, r, t3, a) = (n(speed), n(brakes.response), n(brakes.build_up), n(brakes.deceleration));
    if speed >= brakes.deceleration * brakes.build_up / 2.0 {
        v * r + v * t3 / n(2.0) + v / (n(2.0) * a) * v - a * t3 * t3 / n(24.0)
    } else {
        v * r + n(2.0) * v * (n(2.0) * v / a * t3).root() / n(3.0)
    }
}

/// Si = Vi²/(2 ai): the brakes are fully applied at once.
fn braked_at_once<N: Number>(foe: Braking) -> N {
    let speed = N::from(foe.speed);
    speed / (N::from(2.0) * N::from(foe.brakes.deceleration)) * speed
}

/// The room once both have stopped: S − σ Si.
pub fn at_rest<N: Number>(ego: Braking, foe: Braking, sigma: f64) -> Needed<N> {
    let own = stopping_distance::<N>(ego.speed, ego.brakes);
    let other = N::from(sigma) * braked_at_once(foe);
    Needed { distance: own - other, scale: own.value() }
}

/// The room by the paper: S − Si by eq. 17 and 18.
pub(crate) fn on_paper<N: Number>(ego: Braking, foe: Braking) -> Needed<N> {
    let n = N::from;
    let (v, a) = (n(ego.speed), n(ego.brakes.deceleration));
    let own = v * (n(ego.brakes.response) + n(ego.brakes.build_up)) + v / (n(2.0) * a) * v;
    let other = braked_at_once::<N>(foe);
    Needed { distance: own - other, scale: own.value().max(other.value()) }
}

/// The largest f over all times; at most 0 where f never grows.
pub fn minimal<N: Number>(ego: Braking, foe: Braking, sigma: f64) -> Needed<N> {
    let Brakes { response, build_up, deceleration } = *ego.brakes;
    let ramp_is_enough = ego.speed < deceleration * build_up / 2.0;
    let n = N::from;
    let (a, t3) = (n(deceleration), n(build_up));
    // Whichever stops first decides which moment is the narrowest. Twice the precision tells a tie from a near tie.
    let left = if ramp_is_enough { (n(2.0) * n(ego.speed) / a * t3).root() } else { n(ego.speed) / a + t3 / n(2.0) };
    let foe_stands = n(foe.speed) / n(foe.brakes.deceleration);
    if (foe_stands - n(response) - left).value() <= 0.0 {
        return at_rest(ego, foe, sigma);
    }
    let foe_brakes = n(sigma) * n(foe.brakes.deceleration);
    // Relative speed and f at the end of the response.
    let (start, r) = (n(ego.speed) - n(sigma) * n(foe.speed), n(response));
    let speed = start + foe_brakes * r;
    let ahead = (start + foe_brakes * r / n(2.0)) * r;
    let terms = Terms { speeds: ego.speed + sigma * foe.speed, brakes: deceleration + foe_brakes.value() };
    // The relative speed at the end of the build-up.
    let after = speed + (foe_brakes - a / n(2.0)) * t3;
    let closing = a - foe_brakes;
    let rest = after / closing;
    if !ramp_is_enough && after.value() > 0.0 {
        if closing.value() <= 0.0 || (rest - (left - t3)).value() > 0.0 {
            // Both stand at the same time, up to rounding.
            return at_rest(ego, foe, sigma);
        }
        let further = (speed + (foe_brakes / n(2.0) - a / n(6.0)) * t3) * t3;
        let last = after * rest / n(2.0);
        let time = response + build_up + rest.value();
        let steep = last.value() * terms.brakes / closing.value();
        return Needed { distance: ahead + further + last, scale: terms.over(time) + steep };
    }
    // In the build-up: speed + foe_brakes·τ − a τ²/(2 t3) = 0, the later root, whose terms cannot cancel.
    let inside = foe_brakes * foe_brakes + n(2.0) * a * speed / t3;
    if build_up <= 0.0 || inside.value().is_nan() || inside.value() < 0.0 {
        return Needed { distance: n(0.0), scale: 0.0 };
    }
    let root = (foe_brakes + inside.root()) / a * t3;
    if root.value() > build_up || (root - left).value() > 0.0 {
        // The ego stands before that: g was never above 0, up to rounding.
        return at_rest(ego, foe, sigma);
    }
    let further = (speed + (foe_brakes / n(2.0) - a * root / t3 / n(6.0)) * root) * root;
    Needed { distance: ahead + further, scale: terms.over(response + root.value()) }
}

/// The magnitudes that the relative motion is formed from; they bound its rounding error.
struct Terms {
    speeds: f64,
    brakes: f64,
}

impl Terms {
    /// The largest distance that these speeds and decelerations amount to in a time.
    fn over(&self, time: f64) -> f64 {
        (self.speeds + self.brakes * time) * time
    }
}
