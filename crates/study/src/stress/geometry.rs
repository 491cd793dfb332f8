//! Rectangles that barely touch, barely differ, have almost no size, or are far from the origin.

use super::cars;
use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::chance::Chance;
use crate::reference::contact as reference;
use crate::reference::pairs::{self, against, beside, car};
use closecall::detection::path::rotated;
use closecall::geometry::contact::{distance, touches};
use closecall::geometry::rectangle::Rectangle;
use closecall::geometry::{Point, Vector};
use closecall::traffic::frame::{Frame, SUMO_INVALID, State};
use closecall::traffic::roster::UserIndex;
use closecall::util::units::Metre;

const DECIDED: Property = Property::always("contact as in exact arithmetic");
const EXCHANGED: Property = Property::always("the same for foe and ego");
const MIRRORED: Property = Property::always("the same in the mirror");
const AGREES: Property = Property::always("distance 0 where they touch");
/// In units in the last place of the largest coordinate; rounding the corners alone costs several.
const ULPS: f64 = 8.0;
const APART: Property = Property::within("distance, in ulps of the place", ULPS, Unit::Ulps);
const MOVED: Property = Property::within("change of distance when moved", ULPS, Unit::Ulps);
const TURNED: Property = Property::within("change of distance when turned", ULPS, Unit::Ulps);
const REFUSED: Property = Property::always("no road user in this step");
const CLOSER: Property = Property::always("a foe that is closer leaves less gap");

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Geometry, "random", |chance, tally| {
        let pair = pairs::random(chance);
        check(chance, pair, tally);
    }),
    Case::new(Group::Geometry, "touching to the last place", |chance, tally| {
        let pair = pairs::touching(chance);
        check(chance, pair, tally);
    }),
    Case::new(Group::Geometry, "nearly parallel", |chance, tally| {
        let pair = pairs::nearly_parallel(chance);
        check(chance, pair, tally);
    }),
    Case::new(Group::Geometry, "identical", |chance, tally| {
        let a = car(chance);
        check(chance, (a, a), tally);
    }),
    Case::new(Group::Geometry, "nested", |chance, tally| {
        let pair = pairs::nested(chance);
        check(chance, pair, tally);
    }),
    Case::new(Group::Geometry, "cross without a corner inside", |chance, tally| {
        let pair = pairs::cross(chance);
        check(chance, pair, tally);
    }),
    Case::new(Group::Geometry, "no width or no length", |chance, tally| {
        let a = flat(chance);
        let turn = chance.angle();
        let b = Rectangle { axis: rotated(&a.axis, turn), ..flat(chance) };
        let b = against(chance, &a, b);
        check(chance, (a, b), tally);
    }),
    Case::new(Group::Geometry, "1 mm beside 100 m", |chance, tally| {
        let a = Rectangle { half_length: 50.0, ..car(chance) };
        let axis = rotated(&a.axis, chance.angle());
        let b = Rectangle { axis, half_length: 5e-4, half_width: 5e-4, ..a };
        let b = against(chance, &a, b);
        check(chance, (a, b), tally);
    }),
    Case::new(Group::Geometry, "far from the origin", |chance, tally| {
        let utm = Vector::new(chance.pick(&[3.6e5, 6.9e5, 1e7, -1e7]), chance.pick(&[5.3e6, 5.8e6, 1e7, -1e7]));
        let a = car(chance);
        let a = Rectangle { centre: a.centre + utm, ..a };
        let turn = chance.angle();
        let b = beside(chance, &a, turn);
        check(chance, (a, b), tally);
    }),
    Case::new(Group::Geometry, "no place, no number", |chance, tally| {
        let mut values = [chance.between(-1e7, 1e7), 3.0, 0.0, chance.angle(), chance.between(0.0, 300.0)];
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, SUMO_INVALID];
        // SUMO's value for "none" exists only for positions in the plane.
        let column = chance.below(5);
        values[column] = bad[chance.below(if column < 2 { 4 } else { 3 })];
        let [x, y, z, heading, speed] = values;
        let mut frame = Frame::default();
        let taken = frame.push(UserIndex(0), State { x, y, z, heading, speed });
        tally.holds(REFUSED, !taken && frame.is_empty(), &values);
    }),
    Case::new(Group::Geometry, "a foe that comes closer", |chance, tally| {
        let v = chance.between(5.0, 40.0);
        let vi = chance.between(0.0, 5.0);
        let turn = chance.pick(&[0.0, 1.5, std::f64::consts::PI]);
        // Nearer, the two overlap: up to the contact tolerance both are taken to be smaller then, which opens a gap.
        let distance = chance.between(5.1, 20.0);
        let gap = |ahead: Metre| cars::gap((v, 0.0), (ahead, 0.0, turn, vi));
        let near = gap(distance);
        let far = gap(distance + chance.magnitude(1e-6, 1.0));
        // A foe that is out of reach leaves an infinite gap.
        let holds = near.unwrap_or(f64::INFINITY) <= far.unwrap_or(f64::INFINITY);
        tally.holds(CLOSER, holds, &(v, vi, turn, distance, near, far));
    })
    .costing(4),
];

fn flat(chance: &mut Chance) -> Rectangle {
    let all = car(chance);
    match chance.below(3) {
        0 => Rectangle { half_width: 0.0, ..all },
        1 => Rectangle { half_length: 0.0, ..all },
        _ => Rectangle { half_length: 0.0, half_width: 0.0, ..all },
    }
}

fn check(chance: &mut Chance, inputs: (Rectangle, Rectangle), tally: &mut Tally) {
    let (a, b) = inputs;
    let touching = touches(&a, &b);
    let apart = distance(&a, &b);
    tally.holds(DECIDED, touching == reference::touches(&a, &b), &inputs);
    tally.holds(EXCHANGED, touching == touches(&b, &a), &inputs);
    tally.holds(MIRRORED, touching == touches(&mirrored(&a), &mirrored(&b)), &inputs);
    tally.holds(AGREES, apart == 0.0 || !touching, &inputs);
    let ulp = |extra: Metre| largest(&a).max(largest(&b)).max(extra) * f64::EPSILON;
    tally.error(APART, crate::reference::deviation(apart, &reference::distance(&a, &b)).absolute / ulp(0.0), &inputs);
    let by = Vector::new(chance.between(-1e4, 1e4), chance.between(-1e4, 1e4));
    let moved = |r: &Rectangle| Rectangle { centre: r.centre + by, ..*r };
    let change = (distance(&moved(&a), &moved(&b)) - apart).abs();
    tally.error(MOVED, change / ulp(by.norm()), &(inputs, by));
    let angle = chance.angle();
    let turned = |r: &Rectangle| Rectangle {
        centre: Point::from(rotated(&r.centre.coords, angle)),
        axis: rotated(&r.axis, angle),
        ..*r
    };
    let change = (distance(&turned(&a), &turned(&b)) - apart).abs();
    tally.error(TURNED, change / ulp(0.0), &(inputs, angle));
}

fn mirrored(r: &Rectangle) -> Rectangle {
    Rectangle { centre: Point::new(r.centre.x, -r.centre.y), axis: Vector::new(r.axis.x, -r.axis.y), ..*r }
}

/// An upper bound on the coordinates of the corners.
fn largest(r: &Rectangle) -> Metre {
    r.centre.coords.amax() + r.half_length + r.half_width
}
