//! Whether two rectangles touch: from bounding spheres to the exact predicate, on ordinary pairs and on hard ones.

use std::hint::black_box;

use parry2d_f64::query;

use super::clock::{Timed, interleaved};
use super::{Axis, Measurement, Plan};
use crate::accurate::paper::a_vertex_touches_a_side;
use crate::geometry::rectangle::{Rectangle, plainly_touches, touches};
use crate::geometry::{Vector, parry};
use crate::reference::chance::Chance;
use crate::reference::{contact, pairs};

type Pair = (Rectangle, Rectangle);
type Family = (&'static str, fn(&mut Chance) -> Pair);
type Method = (&'static str, fn(&Rectangle, &Rectangle) -> bool);

const FAMILIES: [Family; 5] = [
    ("random", pairs::random),
    ("touching", pairs::touching),
    ("nearly parallel", pairs::nearly_parallel),
    ("nested", pairs::nested),
    ("cross", pairs::cross),
];

const DEFAULT: &str = "exact predicate";
const METHODS: [Method; 7] = [
    ("bounding sphere", spheres),
    ("AABB", boxes),
    ("8-DOP", octagons),
    ("OBB", plainly_touches),
    ("vertex in side (paper)", a_vertex_touches_a_side),
    ("parry2d contact", parry2d),
    (DEFAULT, touches),
];

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (20_000, 15) } else { (200_000, 31) };
    let mut rows = Vec::new();
    for (family, draw) in FAMILIES {
        let mut chance = Chance::new(1);
        let pairs = (0..count).map(|_| draw(&mut chance)).collect::<Vec<_>>();
        let truth = pairs.iter().map(|(a, b)| contact::touches(a, b)).collect::<Vec<_>>();
        let mut timed = METHODS
            .iter()
            .map(|(_, method)| {
                Timed::new(count, || pairs.iter().for_each(|(a, b)| _ = black_box(method(black_box(a), b))))
            })
            .collect::<Vec<_>>();
        let times = interleaved(&mut timed, rounds);
        for ((name, method), ns_per_item) in METHODS.into_iter().zip(times) {
            let found = pairs.iter().map(|(a, b)| method(a, b)).collect::<Vec<_>>();
            let [missed, invented] = rates(&found, &truth);
            let wrong = found.iter().zip(&truth).filter(|(found, truth)| found != truth).count();
            rows.push(Measurement {
                axis: Axis::Volume,
                method: name,
                parameter: family.to_owned(),
                error_name: "share of wrong decisions",
                error: wrong as f64 / count as f64,
                false_negative_rate: missed,
                false_positive_rate: invented,
                ns_per_item,
                items: count,
                on_pareto_front: false,
                scene: family.to_owned(),
                default: name == DEFAULT,
            });
        }
    }
    rows
}

/// Share of the true that was not found, and of the false that was.
pub(super) fn rates(found: &[bool], truth: &[bool]) -> [f64; 2] {
    [true, false].map(|is| {
        let of = truth.iter().filter(|truth| **truth == is).count();
        let wrong = found.iter().zip(truth).filter(|(found, truth)| **truth == is && found != truth).count();
        wrong as f64 / of.max(1) as f64
    })
}

fn spheres(a: &Rectangle, b: &Rectangle) -> bool {
    let radius = |r: &Rectangle| (r.half_length * r.half_length + r.half_width * r.half_width).sqrt();
    let reach = radius(a) + radius(b);
    (b.centre - a.centre).norm_squared() <= reach * reach
}

fn boxes(a: &Rectangle, b: &Rectangle) -> bool {
    a.bounds().meet(&b.bounds())
}

/// Boxes along the axes, and along the diagonals (k-DOP with k = 8; Klosowski et al. 1998).
fn octagons(a: &Rectangle, b: &Rectangle) -> bool {
    let between = b.centre - a.centre;
    boxes(a, b)
        && [Vector::new(1.0, 1.0), Vector::new(1.0, -1.0)].iter().all(|diagonal| {
            let reach =
                |r: &Rectangle| r.axis.dot(diagonal).abs() * r.half_length + r.axis.perp(diagonal).abs() * r.half_width;
            between.dot(diagonal).abs() <= reach(a) + reach(b)
        })
}

fn parry2d(a: &Rectangle, b: &Rectangle) -> bool {
    let ((pose_a, shape_a), (pose_b, shape_b)) = (parry::cuboid(a), parry::cuboid(b));
    let contact = query::contact(&pose_a, &shape_a, &pose_b, &shape_b, 0.0);
    contact.ok().flatten().is_some_and(|contact| contact.dist <= 0.0)
}
