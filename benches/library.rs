//! closecall's own functions for one pair against those of parry2d: contact and distance of two rectangles, first contact
//! of two moving ones. `cargo bench --bench library`. For the search for pairs see benches/detector.rs and `closecall
//! study`.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]

use std::hint::black_box;
use std::time::Instant;

use closecall::Point;
use closecall::geometry::Vector;
use closecall::geometry::contact::{distance, plainly_touches, touches};
use closecall::geometry::convex::ConvexOutline;
use closecall::geometry::rectangle::Rectangle;
use closecall::geometry::separating_axes::{slide, translation};
use closecall_study::reference::chance::Chance;
use parry2d_f64::math::{Pose, Rotation, Vector as ParryVector};
use parry2d_f64::query::{self, ShapeCastOptions};
use parry2d_f64::shape::Cuboid;

fn nanoseconds(items: usize, mut action: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..7 {
        let started = Instant::now();
        action();
        best = best.min(started.elapsed().as_secs_f64());
    }
    best / items as f64 * 1e9
}

fn contacts(chance: &mut Chance) {
    const PAIRS: usize = 100_000;
    let mut rectangle = || {
        let centre = Point::new(chance.between(0.0, 12.0), chance.between(0.0, 12.0));
        Rectangle::new(centre, chance.between(-3.0, 3.0), 5.0, 2.0)
    };
    let pairs = (0..PAIRS).map(|_| (rectangle(), rectangle())).collect::<Vec<_>>();
    let shape = Cuboid::new(ParryVector::new(2.5, 1.0));
    let pose = |r: &Rectangle| Pose {
        rotation: Rotation { re: r.axis.x, im: r.axis.y },
        translation: ParryVector::new(r.centre.x, r.centre.y),
    };
    let ours = nanoseconds(PAIRS, || pairs.iter().for_each(|(a, b)| _ = black_box(touches(a, b))));
    let theirs = nanoseconds(PAIRS, || {
        pairs.iter().for_each(|(a, b)| _ = black_box(query::intersection_test(&pose(a), &shape, &pose(b), &shape)));
    });
    let plain = nanoseconds(PAIRS, || pairs.iter().for_each(|(a, b)| _ = black_box(plainly_touches(a, b))));
    println!("contact: exact {ours:.0} ns, separating axes {plain:.0} ns, parry2d's intersection_test {theirs:.0} ns");
    let ours = nanoseconds(PAIRS, || pairs.iter().for_each(|(a, b)| _ = black_box(distance(a, b))));
    let theirs = nanoseconds(PAIRS, || {
        pairs.iter().for_each(|(a, b)| _ = black_box(query::distance(&pose(a), &shape, &pose(b), &shape)));
    });
    println!("distance: of the corners {ours:.0} ns, parry2d's distance {theirs:.0} ns");
    let by = Vector::new(20.0, 3.0);
    let ours = nanoseconds(PAIRS, || pairs.iter().for_each(|(a, b)| _ = black_box(slide(a, &by, b))));
    let outlines = nanoseconds(PAIRS, || {
        pairs.iter().for_each(|(a, b)| {
            _ = black_box(translation(&ConvexOutline::rectangle(a), &by, &ConvexOutline::rectangle(b)));
        });
    });
    let still = ParryVector::new(0.0, 0.0);
    let moving = ParryVector::new(by.x, by.y);
    let options = ShapeCastOptions::with_max_time_of_impact(1.0);
    let theirs = nanoseconds(PAIRS, || {
        pairs.iter().for_each(|(a, b)| {
            _ = black_box(query::cast_shapes(&pose(a), moving, &shape, &pose(b), still, &shape, options));
        });
    });
    println!(
        "first contact: of rectangles {ours:.0} ns, of outlines {outlines:.0} ns, parry2d's cast_shapes {theirs:.0} ns"
    );
}

fn main() {
    let mut chance = Chance::new(1);
    contacts(&mut chance);
}
