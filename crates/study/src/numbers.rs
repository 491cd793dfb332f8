//! Contact decided in f32 and f64, near and far from the origin, with and without a local origin.

use nalgebra::{RealField, Vector2, convert};

use super::decisions::{self, ContactTest, RectanglePair};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::pairs;
use closecall::geometry::Vector;
use closecall::geometry::contact::touches;
use closecall::geometry::rectangle::Rectangle;

const DEFAULT: &str = "f64, exact where it is close";
const METHODS: [ContactTest; 5] = [
    ("f32", |pair| separating_axes::<f32>(pair)),
    ("f32, local origin", |pair| separating_axes::<f32>(&local(pair))),
    ("f64", |pair| separating_axes::<f64>(pair)),
    ("f64, local origin", |pair| separating_axes::<f64>(&local(pair))),
    (DEFAULT, |(a, b)| touches(a, b)),
];
/// Distances from the origin in m: a small net, UTM's easting, its northing.
const PLACES: [(&str, f64); 3] = [("at the origin", 0.0), ("at 1e5 m", 1e5), ("at 1e7 m", 1e7)];

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let of = |(scene, far): (&str, f64)| {
        decisions::measure(plan, Axis::Numbers, scene, |chance| pair(chance, far), &METHODS, DEFAULT)
    };
    PLACES.into_iter().flat_map(of).collect()
}

/// Two rectangles with a gap or an overlap of 1e-12 to 1 m, each order of magnitude equally likely.
fn pair(chance: &mut Chance, far: f64) -> RectanglePair {
    let (a, b) = pairs::touching(chance);
    let apart = a.axis * (chance.magnitude(1e-12, 1.0) * chance.pick(&[-1.0, 1.0]));
    let by = Vector::new(far, far);
    (Rectangle { centre: a.centre + by, ..a }, Rectangle { centre: b.centre + by + apart, ..b })
}

/// The same pair relative to the first one's centre.
fn local((a, b): &RectanglePair) -> RectanglePair {
    let origin = a.centre.coords;
    (Rectangle { centre: a.centre - origin, ..*a }, Rectangle { centre: b.centre - origin, ..*b })
}

/// Separating axes in any type of number, to which the inputs are rounded.
fn separating_axes<T: RealField + Copy>((a, b): &RectanglePair) -> bool {
    let number = convert::<f64, T>;
    let vector = |vector: &Vector| Vector2::new(number(vector.x), number(vector.y));
    let side = |axis: Vector2<T>| Vector2::new(-axis.y, axis.x);
    let between = vector(&b.centre.coords) - vector(&a.centre.coords);
    let axis_a = vector(&a.axis);
    let axis_b = vector(&b.axis);
    let halves = [a, b].map(|r| (vector(&r.axis), number(r.half_length), number(r.half_width)));
    [axis_a, side(axis_a), axis_b, side(axis_b)].iter().all(|axis| {
        let reach = halves.iter().fold(number(0.0), |sum, (along, length, width)| {
            sum + along.dot(axis).abs() * *length + side(*along).dot(axis).abs() * *width
        });
        between.dot(axis).abs() <= reach
    })
}
