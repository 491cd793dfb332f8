//! Rectangles by their definition: exact corners, exact decisions, and distances and times in high precision.

use super::{BigFloat, absolute, exact, precise};
use closecall::geometry::rectangle::Rectangle;
use closecall::geometry::{Point, Vector};

type Coordinates = [BigFloat; 2];

/// The corners for the f64 centre, axis and half dimensions, counter-clockwise.
fn corners(rectangle: &Rectangle, number: fn(f64) -> BigFloat) -> [Coordinates; 4] {
    let [cx, cy, ux, uy, length, width] = [
        rectangle.centre.x,
        rectangle.centre.y,
        rectangle.axis.x,
        rectangle.axis.y,
        rectangle.half_length,
        rectangle.half_width,
    ]
    .map(number);
    let corner =
        |along: &BigFloat, across: &BigFloat| [&cx + &ux * along - &uy * across, &cy + &uy * along + &ux * across];
    let back = -&length;
    let right = -&width;
    [corner(&length, &width), corner(&back, &width), corner(&back, &right), corner(&length, &right)]
}

fn along(corner: &Coordinates, axis: &Coordinates) -> BigFloat {
    &corner[0] * &axis[0] + &corner[1] * &axis[1]
}

fn extent(corners: &[Coordinates; 4], axis: &Coordinates) -> (BigFloat, BigFloat) {
    let mut places = corners.each_ref().map(|corner| along(corner, axis));
    places.sort();
    let [low, _, _, high] = places;
    (low, high)
}

/// The four directions along which two rectangles can be separated.
fn axes(a: &Rectangle, b: &Rectangle, number: fn(f64) -> BigFloat) -> [Coordinates; 4] {
    [(a.axis.x, a.axis.y), (-a.axis.y, a.axis.x), (b.axis.x, b.axis.y), (-b.axis.y, b.axis.x)]
        .map(|(x, y)| [number(x), number(y)])
}

/// Whether two rectangles share a point, decided in exact arithmetic.
pub fn touches(a: &Rectangle, b: &Rectangle) -> bool {
    let first = corners(a, exact);
    let second = corners(b, exact);
    axes(a, b, exact).iter().all(|axis| {
        let ((low, high), (other_low, other_high)) = (extent(&first, axis), extent(&second, axis));
        low <= other_high && other_low <= high
    })
}

/// The smallest distance between two rectangles in m, in high precision.
pub fn distance(a: &Rectangle, b: &Rectangle) -> BigFloat {
    if touches(a, b) {
        return precise(0.0);
    }
    let first = corners(a, precise);
    let second = corners(b, precise);
    let mut least: Option<BigFloat> = None;
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

fn squared_to_side(point: &Coordinates, start: &Coordinates, end: &Coordinates) -> BigFloat {
    let side = minus(end, start);
    let to = minus(point, start);
    let length = along(&side, &side);
    let zero = precise(0.0);
    let mut part = if length == zero { zero.clone() } else { along(&to, &side) / &length };
    if part < zero {
        part = zero;
    } else if part > precise(1.0) {
        part = precise(1.0);
    }
    let apart = [&to[0] - &side[0] * &part, &to[1] - &side[1] * &part];
    along(&apart, &apart)
}

fn minus(a: &Coordinates, b: &Coordinates) -> Coordinates {
    [&a[0] - &b[0], &a[1] - &b[1]]
}

/// The time in s at which `moving` first touches `fixed` at a relative velocity in m/s; none if it never does.
pub(crate) fn first_contact(moving: &Rectangle, velocity: Vector, fixed: &Rectangle) -> Option<BigFloat> {
    let zero = precise(0.0);
    let first = corners(moving, precise);
    let second = corners(fixed, precise);
    let velocity = [precise(velocity.x), precise(velocity.y)];
    let mut enter = zero.clone();
    let mut leave = None::<BigFloat>;
    for axis in axes(moving, fixed, precise) {
        let ((low, high), (other_low, other_high)) = (extent(&first, &axis), extent(&second, &axis));
        let speed = along(&velocity, &axis);
        let before = other_low - high;
        let behind = other_high - low;
        if speed == zero {
            if before > zero || behind < zero {
                return None;
            }
            continue;
        }
        let mut early = &before / &speed;
        let mut late = &behind / &speed;
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

/// The distance of a point from a polyline in m, in high precision.
pub(crate) fn distance_to_line(point: Point, line: &[Point]) -> BigFloat {
    let of = |point: &Point| [precise(point.x), precise(point.y)];
    let squared = line.windows(2).map(|ends| squared_to_side(&of(&point), &of(&ends[0]), &of(&ends[1])));
    squared.min().map_or(precise(0.0), |least| absolute(least).sqrt())
}
