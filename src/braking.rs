//! How a road user brakes.

use crate::units::{MetrePerSecondSquared, Second};

/// How one road user brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brakes {
    /// Response time t1 + t2 in s: full speed until it is over.
    pub response: Second,
    /// Build-up time t3 in s, in which the deceleration rises linearly.
    pub build_up: Second,
    /// Deceleration in m/s² from then on.
    pub deceleration: MetrePerSecondSquared,
}

/// Which model of μ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MuModel {
    /// The narrowest moment on the way to rest.
    Minimal,
    /// Both at rest.
    AtRest,
    /// Eq. 19 and 21 as printed.
    Paper,
}
/// Stopping distance.
pub fn stopping_distance(speed: f64, brakes: &Brakes) -> f64 {
    let after = speed - brakes.deceleration * brakes.build_up / 2.0;
    let free = speed * brakes.response;
    if after >= 0.0 {
        free + speed * brakes.build_up / 2.0 + speed * speed / (2.0 * brakes.deceleration)
            - brakes.deceleration * brakes.build_up * brakes.build_up / 24.0
    } else {
        free + 2.0 / 3.0 * speed * (2.0 * speed * brakes.build_up / brakes.deceleration).sqrt()
    }
}
/// As in eq. 17.
pub fn stopping_distance_paper(speed: f64, brakes: &Brakes) -> f64 {
    speed * (brakes.response + brakes.build_up) + speed * speed / (2.0 * brakes.deceleration)
}
/// Temporary: by small steps.
pub fn mu(
    _model: MuModel,
    ego_speed: f64,
    ego: &Brakes,
    foe_speed: f64,
    foe: &Brakes,
    sigma: f64,
    epsilon: f64,
) -> f64 {
    let foe = if sigma > 0.0 { Brakes { response: 0.0, build_up: 0.0, ..*foe } } else { *foe };
    let (mut ve, mut vf, mut x, mut best, dt) = (ego_speed, foe_speed, 0.0, 0.0_f64, 0.005);
    let a = |b: &Brakes, t: f64| {
        if t < b.response {
            0.0
        } else if t < b.response + b.build_up {
            b.deceleration * (t - b.response) / b.build_up
        } else {
            b.deceleration
        }
    };
    let mut t = 0.0;
    while (ve > 0.0 || vf > 0.0) && t < 100.0 {
        x += (ve - sigma * vf) * dt;
        best = best.max(x);
        ve = (ve - a(ego, t) * dt).max(0.0);
        vf = (vf - a(&foe, t) * dt).max(0.0);
        t += dt;
    }
    best + epsilon
}
