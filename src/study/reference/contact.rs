//! Rectangles by their definition: exact corners, exact decisions, high-precision distances and times.

use super::{Number, absolute, exact, precise};
use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Point, Vector};

type Corner = [Number; 2];

/// The corners that follow from the f64 centre, axis and half dimensions, counter-clockwise.
fn corners(rectangle: &Rectangle, number: fn(f64) -> Number) -> [Corner; 4] {
    let [cx, cy, ux, uy, length, width] = [
        rectangle.centre.x,
        rectangle.centre.y,
        rectangle.axis.x,
        rectangle.axis.y,
        rectangle.half_length,
        rectangle.half_width,
    ]
    .map(number);
    let corner = |along: &Number, across: &Number| [&cx + &ux * along - &uy * across, &cy + &uy * along + &ux * across];
    let (back, right) = (-&length, -&width);
    [corner(&length, &width), corner(&back, &width), corner(&back, &right), corner(&length, &right)]
}

fn along(corner: &Corner, axis: &Corner) -> Number {
    &corner[0] * &axis[0] + &corner[1] * &axis[1]
}

fn extent(corners: &[Corner; 4], axis: &Corner) -> (Number, Number) {
    let mut places = corners.each_ref().map(|corner| along(corner, axis));
    places.sort();
    let [low, _, _, high] = places;
    (low, high)
}

/// The four directions across which two rectangles can be apart.
fn axes(a: &Rectangle, b: &Rectangle, number: fn(f64) -> Number) -> [Corner; 4] {
    [(a.axis.x, a.axis.y), (-a.axis.y, a.axis.x), (b.axis.x, b.axis.y), (-b.axis.y, b.axis.x)]
        .map(|(x, y)| [number(x), number(y)])
}

/// Whether two rectangles share a point, decided in exact arithmetic.
pub fn touches(a: &Rectangle, b: &Rectangle) -> bool {
    let (first, second) = (corners(a, exact), corners(b, exact));
    axes(a, b, exact).iter().all(|axis| {
        let ((low, high), (other_low, other_high)) = (extent(&first, axis), extent(&second, axis));
        low <= other_high && other_low <= high
    })
}

/// The smallest distance between two rectangles in m, in high precision.
pub fn distance(a: &Rectangle, b: &Rectangle) -> Number {
    if touches(a, b) {
        return precise(0.0);
    }
    let (first, second) = (corners(a, precise), corners(b, precise));
    let mut least: Option<Number> = None;
    for (from, to) in [(&first, &second), (&second, &first)] {
        for corner in from {
            for side in 0..4 {
                let found = squared_to_side(corner, &to[side], &to[(side + 1) % 4]);
                if least.as_ref().is_none_or(|least| found < *least) {
                    least = Some(found);
                }
            }
        }
    }
    least.map_or(precise(0.0), |squared| squared.sqrt())
}

fn squared_to_side(point: &Corner, start: &Corner, end: &Corner) -> Number {
    let (side, to) = (minus(end, start), minus(point, start));
    let (length, zero) = (along(&side, &side), precise(0.0));
    let mut part = if length == zero { zero.clone() } else { along(&to, &side) / &length };
    if part < zero {
        part = zero;
    } else if part > precise(1.0) {
        part = precise(1.0);
    }
    let apart = [&to[0] - &side[0] * &part, &to[1] - &side[1] * &part];
    along(&apart, &apart)
}

fn minus(a: &Corner, b: &Corner) -> Corner {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

/// When `moving` first touches `fixed`, at a relative velocity in m/s, in s; none where it never does.
pub fn first_contact(moving: &Rectangle, velocity: Vector, fixed: &Rectangle) -> Option<Number> {
    let zero = precise(0.0);
    let (first, second) = (corners(moving, precise), corners(fixed, precise));
    let velocity = [precise(velocity.x), precise(velocity.y)];
    let (mut enter, mut leave) = (zero.clone(), None::<Number>);
    for axis in axes(moving, fixed, precise) {
        let ((low, high), (other_low, other_high)) = (extent(&first, &axis), extent(&second, &axis));
        let speed = along(&velocity, &axis);
        let (before, behind) = (other_low - high, other_high - low);
        if speed == zero {
            if before > zero || behind < zero {
                return None;
            }
            continue;
        }
        let (mut early, mut late) = (&before / &speed, &behind / &speed);
        if speed < zero {
            std::mem::swap(&mut early, &mut late);
        }
        if early > enter {
            enter = early;
        }
        if leave.as_ref().is_none_or(|leave| late < *leave) {
            leave = Some(late);
        }
    }
    leave.is_none_or(|leave| enter <= leave).then_some(enter)
}

/// How far a point is from a polyline in m, in high precision.
pub fn distance_to_line(point: Point, line: &[Point]) -> Number {
    let of = |point: &Point| [precise(point.x), precise(point.y)];
    let squared = line.windows(2).map(|ends| squared_to_side(&of(&point), &of(&ends[0]), &of(&ends[1])));
    squared.min().map_or(precise(0.0), |least| absolute(least).sqrt())
}
