//! Tests whether two rectangles touch, from bounding spheres to the exact predicate, on ordinary and on hard pairs.

use parry2d_f64::query;

use super::decisions::{self, ContactTest, RectanglePair};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::pairs;
use closecall::detection::narrow_phase::paper_mode::a_vertex_touches_a_side;
use closecall::geometry::contact::{plainly_touches, touches};
use closecall::geometry::rectangle::Rectangle;
use closecall::geometry::{Vector, parry};

type Family = (&'static str, fn(&mut Chance) -> RectanglePair);

const FAMILIES: [Family; 5] = [
    ("random", pairs::random),
    ("touching", pairs::touching),
    ("nearly parallel", pairs::nearly_parallel),
    ("nested", pairs::nested),
    ("cross", pairs::cross),
];

const DEFAULT: &str = "exact predicate";
const METHODS: [ContactTest; 7] = [
    ("bounding sphere", |(a, b)| spheres(a, b)),
    ("AABB", |(a, b)| boxes(a, b)),
    ("8-DOP", |(a, b)| octagons(a, b)),
    ("OBB", |(a, b)| plainly_touches(a, b)),
    ("vertex in side (paper)", |(a, b)| a_vertex_touches_a_side(a, b)),
    ("parry2d contact", |(a, b)| parry2d(a, b)),
    (DEFAULT, |(a, b)| touches(a, b)),
];

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let of = |(family, draw): Family| decisions::measure(plan, Axis::Volume, family, draw, &METHODS, DEFAULT);
    FAMILIES.into_iter().flat_map(of).collect()
}

fn spheres(a: &Rectangle, b: &Rectangle) -> bool {
    let radius = |r: &Rectangle| (r.half_length * r.half_length + r.half_width * r.half_width).sqrt();
    let reach = radius(a) + radius(b);
    (b.centre - a.centre).norm_squared() <= reach * reach
}

fn boxes(a: &Rectangle, b: &Rectangle) -> bool {
    a.bounds().meet(&b.bounds())
}

/// Boxes along the axes and along the diagonals (k-DOP with k = 8; Klosowski et al. 1998).
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
