//! Outlines of any shape: their sides, and whether a place is within.

use super::{Point, cross};

/// The sides of an area, of which the last one closes it.
pub fn sides(area: &[Point]) -> impl Iterator<Item = [Point; 2]> {
    let closing = area.last().zip(area.first()).map(|(last, first)| [*last, *first]);
    area.windows(2).map(|side| [side[0], side[1]]).chain(closing)
}

/// Whether an outline is around a place: a ray from there crosses it an odd number of times.
pub fn is_inside(sides: impl Iterator<Item = [Point; 2]>, place: Point) -> bool {
    let crossed = sides.filter(|[from, to]| {
        let is_above = |point: &Point| point.y > place.y;
        let is_left = cross(&(to - from), &(place - from)) > 0.0;
        is_above(from) != is_above(to) && is_left == is_above(to)
    });
    crossed.count() % 2 == 1
}
