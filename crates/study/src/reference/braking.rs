//! Stopping distance and μ by their definitions, in high precision.
//!
//! μ is the largest value of travel_ego(t) − σ travel_foe(t). Between the times at which either starts a new phase of
//! braking, this is a cubic. It is evaluated at all those times and wherever its derivative, a quadratic, is 0; no
//! assumption is made about which value is the largest.

use super::{BigFloat, precise};
use closecall::braking::{Braking, LateBraking, Leader, MuModel};

/// A phase of braking: from `start` on, distance = c0 + c1 τ + c2 τ² + c3 τ³ with τ = t − start.
#[derive(Clone)]
struct Phase {
    start: BigFloat,
    cubic: [BigFloat; 4],
}

/// The phases of one road user; the last one is its standstill.
fn phases(braking: &Braking, at_once: bool) -> Vec<Phase> {
    let Braking { speed, brakes } = *braking;
    let (response, build_up) = if at_once { (0.0, 0.0) } else { (brakes.response, brakes.build_up) };
    late_phases(&LateBraking { speed, present: 0.0, build_up, deceleration: brakes.deceleration }, Some(response))
}

/// The phases of a vehicle that keeps its present deceleration for a wait, or for ever, and then brakes fully. If it stops, its
/// standstill is the last one.
fn late_phases(braking: &LateBraking, wait: Option<f64>) -> Vec<Phase> {
    let zero = || precise(0.0);
    let two = || precise(2.0);
    let [v, d, t3, a] = [braking.speed, braking.present, braking.build_up, braking.deceleration].map(precise);
    let wait = wait.map(precise);
    let mut phases = vec![Phase { start: zero(), cubic: [zero(), v.clone(), -(&d / two()), zero()] }];
    let stands = |time: BigFloat, distance: BigFloat| Phase { start: time, cubic: [distance, zero(), zero(), zero()] };
    let by_itself = (v == zero() || d > zero()).then(|| if v == zero() { zero() } else { &v / &d });
    let Some(wait) = wait.filter(|wait| by_itself.as_ref().is_none_or(|stands| wait < stands)) else {
        phases.extend(by_itself.map(|time| {
            let distance = &v * &time / two();
            stands(time, distance)
        }));
        return phases;
    };
    let mut distance = &v * &wait - &d * &wait * &wait / two();
    let mut speed = &v - &d * &wait;
    let mut time = wait;
    if t3 > zero() {
        // On the ramp: speed − d τ − jerk τ²/2.
        let jerk = (&a - &d) / &t3;
        let to_stand = two() * &speed / (&d + (&d * &d + two() * &jerk * &speed).sqrt());
        let stands = to_stand < t3;
        let lasts = if stands { to_stand } else { t3 };
        let cubic = [distance.clone(), speed.clone(), -(&d / two()), -(&jerk / precise(6.0))];
        phases.push(Phase { start: time.clone(), cubic });
        distance += &speed * &lasts - &d * &lasts * &lasts / two() - &jerk * &lasts * &lasts * &lasts / precise(6.0);
        time += &lasts;
        speed = if stands { zero() } else { &speed - &d * &lasts - &jerk * &lasts * &lasts / two() };
    }
    if speed > zero() {
        phases.push(Phase { start: time.clone(), cubic: [distance.clone(), speed.clone(), -(&a / two()), zero()] });
        distance += &speed * &speed / (two() * &a);
        time += &speed / &a;
    }
    phases.push(stands(time, distance));
    phases
}

/// The cubic of a road user's distance from `time` on, in τ = t − time.
fn from(phases: &[Phase], time: &BigFloat) -> [BigFloat; 4] {
    let phase = phases.iter().rev().find(|phase| phase.start <= *time).unwrap_or(&phases[0]);
    let s = time - &phase.start;
    let [c0, c1, c2, c3] = &phase.cubic;
    let three = precise(3.0);
    [
        c0 + c1 * &s + c2 * &s * &s + c3 * &s * &s * &s,
        c1 + precise(2.0) * c2 * &s + &three * c3 * &s * &s,
        c2 + &three * c3 * &s,
        c3.clone(),
    ]
}

fn value(cubic: &[BigFloat; 4], at: &BigFloat) -> BigFloat {
    let [c0, c1, c2, c3] = cubic;
    c0 + at * (c1 + at * (c2 + at * c3))
}

/// The real roots of c1 + 2 c2 τ + 3 c3 τ².
fn stationary(cubic: &[BigFloat; 4]) -> Vec<BigFloat> {
    let zero = precise(0.0);
    let a = precise(3.0) * &cubic[3];
    let b = precise(2.0) * &cubic[2];
    let c = cubic[1].clone();
    if a == zero {
        return if b == zero { Vec::new() } else { vec![-(&c / &b)] };
    }
    let inside = &b * &b - precise(4.0) * &a * &c;
    if inside < zero {
        return Vec::new();
    }
    let root = inside.sqrt();
    let sum = if b < zero { -&b + &root } else { -&b - &root };
    if sum == zero {
        return vec![zero];
    }
    vec![&sum / (precise(2.0) * &a), precise(2.0) * &c / &sum]
}

/// The stopping distance in m.
pub fn stopping_distance(braking: &Braking) -> BigFloat {
    rest(&phases(braking, false))
}

fn rest(phases: &[Phase]) -> BigFloat {
    phases.last().map_or(precise(0.0), |last| last.cubic[0].clone())
}

/// The stopping distance of a vehicle that brakes late or never, in m; 0 if it never stops.
pub(crate) fn late_distance(braking: &LateBraking, wait: Option<f64>) -> BigFloat {
    rest(&late_phases(braking, wait))
}

/// Its distance at a time, in m.
pub(crate) fn late_distance_at(braking: &LateBraking, wait: Option<f64>, time: f64) -> BigFloat {
    let [distance, ..] = from(&late_phases(braking, wait), &precise(time));
    distance
}

/// The least room behind its leader of a vehicle that brakes late or never, in m: below 0 where they touch.
pub(crate) fn least_room_behind(leader: &Leader, braking: &LateBraking, wait: Option<f64>) -> BigFloat {
    let Leader { room, speed, deceleration } = *leader;
    let ahead = LateBraking { speed, present: deceleration, build_up: 0.0, deceleration };
    precise(room) - narrowest(&late_phases(braking, wait), &late_phases(&ahead, None), &precise(1.0), precise(0.0))
}

/// The minimal collision distance in m.
pub fn mu(model: MuModel, ego: &Braking, foe: &Braking, sigma: f64, epsilon: f64) -> BigFloat {
    let zero = precise(0.0);
    let s = precise(sigma);
    let epsilon = precise(epsilon);
    if model == MuModel::Paper {
        let own = |braking: &Braking| {
            let v = precise(braking.speed);
            &v * &v / (precise(2.0) * precise(braking.brakes.deceleration))
        };
        let response = precise(ego.brakes.response) + precise(ego.brakes.build_up);
        return precise(ego.speed) * response + own(ego) - own(foe) + epsilon;
    }
    let own = phases(ego, false);
    let other = phases(foe, sigma > 0.0);
    let at_rest = rest(&own) - &s * rest(&other);
    let most = if model == MuModel::AtRest { at_rest } else { narrowest(&own, &other, &s, at_rest) };
    if most > zero { most + epsilon } else { epsilon }
}

fn narrowest(own: &[Phase], other: &[Phase], sigma: &BigFloat, at_rest: BigFloat) -> BigFloat {
    let mut times = own.iter().chain(other).map(|phase| phase.start.clone()).collect::<Vec<_>>();
    times.sort();
    let mut most = at_rest;
    for (index, start) in times.iter().enumerate() {
        let ego = from(own, start);
        let foe = from(other, start);
        let difference: [BigFloat; 4] = std::array::from_fn(|power| &ego[power] - sigma * &foe[power]);
        let lasts = times.get(index + 1).map(|end| end - start);
        let inside = |at: &BigFloat| *at >= precise(0.0) && lasts.as_ref().is_none_or(|lasts| at <= lasts);
        for at in stationary(&difference).into_iter().filter(inside).chain([precise(0.0)]) {
            let found = value(&difference, &at);
            if found > most {
                most = found;
            }
        }
    }
    most
}
