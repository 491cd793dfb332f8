//! The first contact of two moving cars: checked at intervals, or swept.

use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::{contact, nearest};
use closecall::detection::measures::ttc::{HORIZON, SteadyMotion, time_to_collision};
use closecall::detection::path::Pose;
use closecall::geometry::Point;
use closecall::geometry::contact::touches;
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::util::units::{MetrePerSecond, Radian, Second};

const LENGTH: f64 = 4.6;
const WIDTH: f64 = 1.8;
/// Steps of the discrete check in s, from those of games to SUMO's default.
const STEPS: [Second; 5] = [0.01, 0.03, 0.1, 0.3, 1.0];
/// Closing speeds in m/s: in town, in the country, and head-on at high speed.
const SPEEDS: [(&str, MetrePerSecond, MetrePerSecond); 3] =
    [("closing at 1 to 15 m/s", 1.0, 15.0), ("15 to 50 m/s", 15.0, 50.0), ("50 to 140 m/s", 50.0, 140.0)];

/// A car that keeps its speed and heading.
#[derive(Clone, Copy)]
struct StraightCar {
    pose: [Pose; 1],
    speed: MetrePerSecond,
}

impl StraightCar {
    /// The car that reaches `place` in `arrives` s.
    fn towards(place: Point, heading: Radian, speed: MetrePerSecond, arrives: Second) -> Self {
        let axis = direction(heading);
        Self { pose: [Pose { distance: 0.0, front: place - axis * (speed * arrives), axis }], speed }
    }

    fn rectangle(&self, time: Second) -> Rectangle {
        let [Pose { front, axis, .. }] = self.pose;
        Rectangle::behind(front + axis * (self.speed * time), axis, LENGTH, WIDTH)
    }

    fn course(&self) -> SteadyMotion<'_> {
        SteadyMotion { poses: &self.pose, speed: self.speed, deceleration: 0.0, length: LENGTH, width: WIDTH }
    }
}

type CarPair = (StraightCar, StraightCar);

/// Two cars that cross near the origin at about the same time.
fn pair(chance: &mut Chance, low: MetrePerSecond, high: MetrePerSecond) -> CarPair {
    let closing = chance.between(low, high);
    let share = chance.between(0.0, 1.0);
    let arrives = chance.between(0.5, 9.0);
    let turn = std::f64::consts::PI * chance.between(0.4, 1.0);
    let first = StraightCar::towards(Point::origin(), 0.0, closing * share, arrives);
    let aside = Point::new(chance.between(-3.0, 3.0), chance.between(-3.0, 3.0));
    (first, StraightCar::towards(aside, turn, closing * (1.0 - share), arrives))
}

fn discrete((a, b): &CarPair, step: Second) -> Option<Second> {
    let steps = (HORIZON / step).round() as u32;
    (0..=steps).map(|number| f64::from(number) * step).find(|time| touches(&a.rectangle(*time), &b.rectangle(*time)))
}

fn swept((a, b): &CarPair) -> Option<Second> {
    time_to_collision(&a.course(), &b.course())
}

fn truth((a, b): &CarPair) -> Option<Second> {
    let velocity = |moving: &StraightCar| moving.pose[0].axis * moving.speed;
    let found = contact::first_contact(&a.rectangle(0.0), velocity(a) - velocity(b), &b.rectangle(0.0));
    found.map(|time| nearest(&time)).filter(|time| *time <= HORIZON)
}

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (1_000, 5) } else { (10_000, 9) };
    let mut rows = Vec::new();
    for (scene, low, high) in SPEEDS {
        let mut chance = Chance::new(1);
        let pairs = (0..count).map(|_| pair(&mut chance, low, high)).collect::<Vec<_>>();
        let truth = pairs.iter().map(truth).collect::<Vec<_>>();
        let discretes = STEPS.map(|step| ("discrete", format!(", every {step} s"), Some(step)));
        let methods = discretes.into_iter().chain([("swept", String::new(), None)]).collect::<Vec<_>>();
        let find = |step: Option<Second>, pair: &CarPair| step.map_or_else(|| swept(pair), |step| discrete(pair, step));
        let mut timed = methods
            .iter()
            .map(|(_, _, step)| Timed::new(count, || pairs.iter().for_each(|pair| _ = black_box(find(*step, pair)))))
            .collect::<Vec<_>>();
        let times = interleaved(&mut timed, rounds);
        drop(timed);
        for ((name, parameter, step), ns_per_item) in methods.into_iter().zip(times) {
            let found = pairs.iter().map(|pair| find(step, pair)).collect::<Vec<_>>();
            let mut late = 0.0;
            let mut both = 0;
            for (found, truth) in found.iter().zip(&truth) {
                if let (Some(found), Some(truth)) = (found, truth) {
                    late += (found - truth).abs();
                    both += 1;
                }
            }
            let is = |times: &[Option<Second>]| times.iter().map(Option::is_some).collect::<Vec<_>>();
            let [missed, invented] = super::decisions::rates(&is(&found), &is(&truth));
            rows.push(Measurement {
                axis: Axis::Time,
                method: name,
                parameter: format!("{scene}{parameter}"),
                error_name: "mean error of the first contact, s",
                error: late / f64::from(both.max(1)),
                false_negative_rate: missed,
                false_positive_rate: invented,
                ns_per_item,
                items: count,
                on_pareto_front: false,
                scene: scene.to_owned(),
                default: step.is_none(),
            });
        }
    }
    rows
}
