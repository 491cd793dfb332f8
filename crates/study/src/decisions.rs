//! Methods that decide whether two rectangles touch, and how often they are wrong, for two of the axes.

use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::contact;
use closecall::geometry::rectangle::Rectangle;

pub(super) type RectanglePair = (Rectangle, Rectangle);
pub(super) type ContactTest = (&'static str, fn(&RectanglePair) -> bool);

/// Measures every method on the same pairs, against exact arithmetic.
pub(super) fn measure(
    plan: &Plan,
    axis: Axis,
    scene: &str,
    draw: impl Fn(&mut Chance) -> RectanglePair,
    methods: &[ContactTest],
    default: &str,
) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (20_000, 15) } else { (200_000, 31) };
    let mut chance = Chance::new(1);
    let pairs = (0..count).map(|_| draw(&mut chance)).collect::<Vec<_>>();
    let truth = pairs.iter().map(|(a, b)| contact::touches(a, b)).collect::<Vec<_>>();
    let decide = |method: fn(&RectanglePair) -> bool| {
        let pairs = &pairs;
        Timed::new(count, move || pairs.iter().for_each(|pair| _ = black_box(method(black_box(pair)))))
    };
    let times = interleaved(&mut methods.iter().map(|(_, method)| decide(*method)).collect::<Vec<_>>(), rounds);
    let row = |(&(name, method), ns_per_item): (&ContactTest, f64)| {
        let found = pairs.iter().map(method).collect::<Vec<_>>();
        let [missed, invented] = rates(&found, &truth);
        let wrong = found.iter().zip(&truth).filter(|(found, truth)| found != truth).count();
        Measurement {
            axis,
            method: name,
            parameter: scene.to_owned(),
            error_name: "share of wrong decisions",
            error: wrong as f64 / count as f64,
            false_negative_rate: missed,
            false_positive_rate: invented,
            ns_per_item,
            items: count,
            on_pareto_front: false,
            scene: scene.to_owned(),
            default: name == default,
        }
    };
    methods.iter().zip(times).map(row).collect()
}

/// The share of true cases that was not found, and the share of false cases that was.
pub(super) fn rates(found: &[bool], truth: &[bool]) -> [f64; 2] {
    [true, false].map(|is| {
        let of = truth.iter().filter(|truth| **truth == is).count();
        let wrong = found.iter().zip(truth).filter(|(found, truth)| **truth == is && found != truth).count();
        wrong as f64 / of.max(1) as f64
    })
}
