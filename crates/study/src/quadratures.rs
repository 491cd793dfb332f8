//! The probability that a driver does not brake in time: by quadratures of several sizes, and by draws.

use std::f64::consts::PI;
use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::{nearest, probability as reference};
use closecall::braking::{LateBraking, Leader};
use closecall::detection::measures::crash_probability::{bounds, crash_probability};
use closecall::detection::measures::ttb::Evasion;
use closecall::options::{DriverModel, DriverOptions};
use closecall::traffic::driver_distributions::Driver;
use closecall::util::units::{Metre, MetrePerSecondSquared, Second};

const SCENES: [&str; 2] = ["behind a leader", "across a foe's way"];
/// Nodes of the other quadratures; closecall has 16.
const NODES: [usize; 3] = [4, 8, 32];
const DRAWS: [u32; 2] = [1_000, 10_000];
/// The attentive driver: mean and standard deviation of its response time, and of its deceleration, with its range.
pub(super) const RESPONSE: [Second; 2] = [0.92, 0.28];
pub(super) const BRAKING: [MetrePerSecondSquared; 4] = [8.45, 1.42, 4.23, 12.68];
/// Moments at which a foe is examined that crosses or turns: about as many as the detector needs where each may decide,
/// because the foe also drives on along the ego's way.
const MOMENTS: u32 = 35;

/// A driver that approaches another road user.
struct Approach {
    braking: LateBraking,
    leader: Leader,
    /// The distances that must not be passed before the foe has left; empty behind a leader.
    limits: Vec<(Second, Metre)>,
}

impl Approach {
    fn draw(chance: &mut Chance, scene: &str) -> Self {
        let speed = chance.between(5.0, 30.0);
        let braking = LateBraking { speed, present: 0.0, build_up: 0.1, deceleration: BRAKING[0] };
        // Contact in 0.5 to 4 s: from hardly avoidable to harmless.
        let meets = chance.between(0.5, 4.0);
        let leader = Leader { room: speed * meets, speed: 0.0, deceleration: 0.0 };
        let leaves = meets + chance.between(0.2, 2.0);
        let moment = |number: u32| meets + (leaves - meets) * f64::from(number) / f64::from(MOMENTS - 1);
        let along = chance.between(0.1, 0.5) * speed;
        let limits = if scene == SCENES[0] { 0..0 } else { 0..MOMENTS };
        let limit = |number| (moment(number), leader.room + along * (moment(number) - meets));
        Self { braking, leader, limits: limits.map(limit).collect() }
    }

    /// The longest wait of a driver that brakes with this.
    fn wait(&self, deceleration: MetrePerSecondSquared) -> Second {
        let evasion = if self.limits.is_empty() { Evasion::Behind(self.leader) } else { Evasion::At(&self.limits[..]) };
        evasion.longest_wait(&LateBraking { deceleration, ..self.braking })
    }
}

/// A method that computes the probability.
enum Method {
    Closecall,
    /// The bounds between which it is, without working it out; an error is how far it is outside.
    Bounds,
    /// Decelerations and their weights.
    Nodes(Vec<(MetrePerSecondSquared, f64)>),
    /// Pairs of response time and deceleration.
    Draws(Vec<(Second, MetrePerSecondSquared)>),
}

impl Method {
    /// The probability; of bounds, what is nearest to `truth` between them.
    fn probability(&self, approach: &Approach, driver: &Driver, truth: f64) -> f64 {
        match self {
            Self::Bounds => {
                let [least, most] = bounds(driver, false, |deceleration| approach.wait(deceleration));
                truth.clamp(least, most)
            }
            Self::Closecall => crash_probability(driver, false, |deceleration| approach.wait(deceleration)),
            Self::Nodes(nodes) => {
                let late = |value| driver.responds_later_than(approach.wait(value));
                nodes.iter().map(|(value, weight)| weight * late(*value)).sum()
            }
            Self::Draws(draws) => {
                let late = draws.iter().filter(|(response, value)| *response > approach.wait(*value)).count();
                late as f64 / draws.len() as f64
            }
        }
    }
}

/// The nodes and weights of a Gauss–Legendre quadrature for the truncated normal distribution of the deceleration.
fn gauss_legendre(count: usize) -> Vec<(MetrePerSecondSquared, f64)> {
    let [mean, deviation, low, high] = BRAKING;
    let node = |index: usize| {
        let mut x = (PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let mut slope = 1.0;
        // Newton's method on the Legendre polynomial.
        for _ in 0..20 {
            let [mut before, mut value] = [1.0, x];
            for degree in 2..=count {
                let degree = degree as f64;
                (before, value) = (value, ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * before) / degree);
            }
            slope = count as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        let value = low + (high - low) * (1.0 + x) / 2.0;
        (value, (-((value - mean) / deviation).powi(2) / 2.0).exp() / ((1.0 - x * x) * slope * slope))
    };
    let nodes = (0..count).map(node).collect::<Vec<_>>();
    let sum = nodes.iter().map(|(_, weight)| weight).sum::<f64>();
    nodes.into_iter().map(|(value, weight)| (value, weight / sum)).collect()
}

fn draws(chance: &mut Chance, count: u32) -> Vec<(Second, MetrePerSecondSquared)> {
    let [mean, deviation, low, high] = BRAKING;
    let spread = (RESPONSE[1] / RESPONSE[0]).powi(2).ln_1p();
    let mut draw = || {
        let response = (RESPONSE[0].ln() - spread / 2.0 + spread.sqrt() * chance.normal()).exp();
        loop {
            let value = mean + deviation * chance.normal();
            if (low..=high).contains(&value) {
                return (response, value);
            }
        }
    };
    (0..count).map(|_| draw()).collect()
}

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (50, 5) } else { (500, 9) };
    let options = DriverOptions::default();
    let driver = Driver::new(DriverModel::Attentive, &options, &options, 1.0);
    let response = reference::Lognormal::new(RESPONSE[0], RESPONSE[1]);
    let mut rows = Vec::new();
    for scene in SCENES {
        let mut chance = Chance::new(1);
        let approaches = (0..count).map(|_| Approach::draw(&mut chance, scene)).collect::<Vec<_>>();
        let truth = approaches.iter().map(|approach| {
            reference::mean_over_normal(BRAKING, 256, |value| match approach.wait(value) {
                wait if wait <= 0.0 => 1.0,
                f64::INFINITY => 0.0,
                wait => nearest(&response.above(wait)),
            })
        });
        let truth = truth.collect::<Vec<_>>();
        let mut methods =
            vec![("closecall", String::new(), Method::Closecall), ("bounds alone", String::new(), Method::Bounds)];
        methods.extend(
            NODES.map(|nodes| ("Gauss-Legendre", format!(", {nodes} nodes"), Method::Nodes(gauss_legendre(nodes)))),
        );
        methods.extend(DRAWS.map(|count| ("draws", format!(", {count}"), Method::Draws(draws(&mut chance, count)))));
        let mut timed = methods
            .iter()
            .map(|(_, _, method)| {
                // A quadrature of all pairs takes hardly longer than the clock's resolution.
                let again = if matches!(method, Method::Draws(_)) { 1 } else { 20 };
                let (approaches, driver) = (&approaches, &driver);
                Timed::new(count * again, move || {
                    for approach in std::iter::repeat_n(approaches, again).flatten() {
                        black_box(method.probability(black_box(approach), driver, 0.5));
                    }
                })
            })
            .collect::<Vec<_>>();
        let times = interleaved(&mut timed, rounds);
        drop(timed);
        for ((name, parameter, method), ns_per_item) in methods.iter().zip(times) {
            let off =
                |(approach, truth): (&Approach, &f64)| (method.probability(approach, &driver, *truth) - truth).abs();
            rows.push(Measurement {
                axis: Axis::Probability,
                method: name,
                parameter: format!("{scene}{parameter}"),
                error_name: if matches!(method, Method::Bounds) {
                    "furthest that the crash probability is outside its bounds"
                } else {
                    "largest error of the crash probability"
                },
                error: approaches.iter().zip(&truth).map(off).fold(0.0, f64::max),
                false_negative_rate: 0.0,
                false_positive_rate: 0.0,
                ns_per_item,
                items: count,
                on_pareto_front: false,
                // Bounds answer another question.
                scene: if matches!(method, Method::Bounds) { format!("{scene}, bounds") } else { scene.to_owned() },
                default: matches!(method, Method::Closecall),
            });
        }
    }
    rows
}
