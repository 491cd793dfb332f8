//! μ by its three models in closed form, and by numerical integration of the braking equations.

use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::{braking, deviation};
use closecall::braking::{Brakes, Braking, MuModel, mu};
use closecall::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

const DEFAULT: &str = "minimal";
/// One σ per kind of conflict.
const SCENES: [(&str, f64); 3] = [("rear-end", 1.0), ("side, 60 degrees", 0.5), ("frontal", -1.0)];
const STEPS: [Second; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// A μ whose error is larger than this counts as too short or too long, in m.
const NOTICED: Metre = 1e-3;

/// Two road users that brake.
struct BrakingPair {
    speeds: [MetrePerSecond; 2],
    brakes: [Brakes; 2],
}

impl BrakingPair {
    fn draw(chance: &mut Chance) -> Self {
        let ego = Brakes {
            response: chance.between(0.5, 1.5),
            build_up: chance.between(0.0, 0.5),
            deceleration: chance.between(3.0, 9.0),
        };
        let foe = Brakes { deceleration: chance.between(3.0, 9.0), ..ego };
        Self { speeds: [chance.between(0.0, 50.0), chance.between(0.0, 50.0)], brakes: [ego, foe] }
    }

    fn braking(&self) -> [Braking<'_>; 2] {
        [0, 1].map(|who| Braking { speed: self.speeds[who], brakes: &self.brakes[who] })
    }
}

/// A scheme of numerical integration.
#[derive(Clone, Copy, PartialEq)]
enum Scheme {
    Euler,
    RungeKutta,
}

/// A method that computes μ.
#[derive(Clone, Copy)]
enum MuMethod {
    Closed(MuModel),
    Integrated(Scheme, Second),
}

impl MuMethod {
    fn mu(self, pair: &BrakingPair, sigma: f64) -> Metre {
        let [ego, foe] = pair.braking();
        match self {
            Self::Closed(model) => mu(model, ego, foe, sigma, 0.0),
            Self::Integrated(scheme, step) => integrated(scheme, step, ego, foe, sigma),
        }
    }
}

/// The largest travel_ego − σ travel_foe over all steps.
fn integrated(scheme: Scheme, step: Second, ego: Braking, foe: Braking, sigma: f64) -> Metre {
    let foe_brakes = if sigma > 0.0 { foe.brakes.at_once() } else { *foe.brakes };
    let mut own = (0.0, ego.speed);
    let mut other = (0.0, foe.speed);
    let mut most = 0.0;
    let mut steps = 0_u32;
    while own.1 > 0.0 || other.1 > 0.0 {
        let time = f64::from(steps) * step;
        own = advance(scheme, own, time, step, ego.brakes);
        other = advance(scheme, other, time, step, &foe_brakes);
        most = f64::max(most, own.0 - sigma * other.0);
        steps += 1;
    }
    most
}

/// (distance, speed) after a step of x' = v, v' = −a(t), while v > 0.
fn advance(
    scheme: Scheme,
    (distance, speed): (Metre, MetrePerSecond),
    time: Second,
    step: Second,
    brakes: &Brakes,
) -> (Metre, MetrePerSecond) {
    if speed <= 0.0 {
        return (distance, 0.0);
    }
    let brake = |time| deceleration(brakes, time);
    match scheme {
        Scheme::Euler => (distance + speed * step, (speed - brake(time) * step).max(0.0)),
        Scheme::RungeKutta => {
            // The four slopes of v depend only on the time; those of x are the resulting speeds.
            let [start, middle, end] = [0.0, 0.5, 1.0].map(|part| brake(time + part * step));
            let second = speed - start * step / 2.0;
            let third = speed - middle * step / 2.0;
            let fourth = speed - middle * step;
            let slope = [speed, 2.0 * second, 2.0 * third, fourth].map(|speed| speed.max(0.0));
            let after = speed - (start + 4.0 * middle + end) * step / 6.0;
            (distance + slope.iter().sum::<f64>() * step / 6.0, after.max(0.0))
        }
    }
}

fn deceleration(brakes: &Brakes, time: Second) -> MetrePerSecondSquared {
    let since = time - brakes.response;
    if since < 0.0 {
        0.0
    } else if since < brakes.build_up {
        brakes.deceleration * since / brakes.build_up
    } else {
        brakes.deceleration
    }
}

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (50, 3) } else { (1_000, 5) };
    let models = [(DEFAULT, MuModel::Minimal), ("at_rest", MuModel::AtRest), ("paper", MuModel::Paper)];
    let mut methods =
        models.map(|(name, model)| (name, String::new(), MuMethod::Closed(model))).into_iter().collect::<Vec<_>>();
    for (name, scheme) in [("Euler", Scheme::Euler), ("RK4", Scheme::RungeKutta)] {
        methods.extend(STEPS.map(|step| (name, format!(", step {step} s"), MuMethod::Integrated(scheme, step))));
    }
    let mut rows = Vec::new();
    for (scene, sigma) in SCENES {
        let mut chance = Chance::new(1);
        let pairs = (0..count).map(|_| BrakingPair::draw(&mut chance)).collect::<Vec<_>>();
        let truth = pairs.iter().map(|pair| {
            let [ego, foe] = pair.braking();
            braking::mu(MuModel::Minimal, &ego, &foe, sigma, 0.0)
        });
        let truth = truth.collect::<Vec<_>>();
        let mut timed = methods
            .iter()
            .map(|(_, _, method)| {
                // A closed form is faster than the clock's resolution, so all pairs are repeated.
                let again = if matches!(method, MuMethod::Closed(_)) { 200 } else { 1 };
                let pairs = &pairs;
                Timed::new(count * again, move || {
                    for pair in std::iter::repeat_n(pairs, again).flatten() {
                        black_box(method.mu(black_box(pair), sigma));
                    }
                })
            })
            .collect::<Vec<_>>();
        let times = interleaved(&mut timed, rounds);
        drop(timed);
        for ((name, parameter, method), ns_per_item) in methods.iter().zip(times) {
            let mut worst = 0.0;
            let mut short = 0;
            let mut long = 0;
            for (pair, truth) in pairs.iter().zip(&truth) {
                let found = method.mu(pair, sigma);
                let off = deviation(found, truth).absolute;
                worst = f64::max(worst, off);
                if off > NOTICED {
                    *(if found < crate::reference::nearest(truth) { &mut short } else { &mut long }) += 1;
                }
            }
            rows.push(Measurement {
                axis: Axis::Braking,
                method: name,
                parameter: format!("{scene}{parameter}"),
                error_name: "largest error of mu, m",
                error: worst,
                false_negative_rate: f64::from(short) / count as f64,
                false_positive_rate: f64::from(long) / count as f64,
                ns_per_item,
                items: count,
                on_pareto_front: false,
                scene: scene.to_owned(),
                default: *name == DEFAULT,
            });
        }
    }
    rows
}
