//! A convex outline with few corners, stored inline: the shape that sweeping works on.

use super::rectangle::Rectangle;
use super::{Bounds, Point, Vector, cross};
use crate::util::units::Metre;

/// The hull of two rectangles has at most eight corners.
const MOST_CORNERS: usize = 8;

/// Room and overlap below this may be rounding errors, in m.
pub(super) const UNSURE: Metre = 1e-6;

/// A convex polygon with up to eight corners, counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct ConvexOutline {
    corners: [Point; MOST_CORNERS],
    count: usize,
    /// Number of edges with a normal of their own: in a rectangle opposite edges share one.
    edges: usize,
}

impl ConvexOutline {
    /// The outline of a rectangle.
    pub fn rectangle(rectangle: &Rectangle) -> Self {
        let mut outline = Self { corners: [Point::origin(); MOST_CORNERS], count: 4, edges: 2 };
        outline.corners[..4].copy_from_slice(&rectangle.corners());
        outline
    }

    /// The convex hull of two rectangles, by Andrew's monotone chain.
    pub fn hull(a: &Rectangle, b: &Rectangle) -> Self {
        let mut points = [Point::origin(); MOST_CORNERS];
        points[..4].copy_from_slice(&a.corners());
        points[4..].copy_from_slice(&b.corners());
        points.sort_unstable_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        let mut chain = [Point::origin(); 2 * MOST_CORNERS];
        let mut count = 0;
        for upper in [false, true] {
            let start = count;
            for index in 0..MOST_CORNERS {
                let point = points[if upper { MOST_CORNERS - 1 - index } else { index }];
                while count >= start + 2
                    && cross(&(chain[count - 1] - chain[count - 2]), &(point - chain[count - 2])) <= 0.0
                {
                    count -= 1;
                }
                chain[count] = point;
                count += 1;
            }
            count -= 1;
        }
        let mut outline = Self { corners: [Point::origin(); MOST_CORNERS], count, edges: count };
        outline.corners[..count].copy_from_slice(&chain[..count]);
        outline
    }

    /// The corners, counter-clockwise.
    pub fn corners(&self) -> &[Point] {
        &self.corners[..self.count]
    }

    /// The normals of the edges, not normalised; a rectangle has two.
    pub fn normals(&self) -> impl Iterator<Item = Vector> + '_ {
        (0..self.edges).map(|index| {
            let edge = self.corners[(index + 1) % self.count] - self.corners[index];
            Vector::new(edge.y, -edge.x)
        })
    }

    /// Smallest and largest coordinate along a direction.
    pub fn extent(&self, direction: &Vector) -> (Metre, Metre) {
        let mut low = f64::INFINITY;
        let mut high = f64::NEG_INFINITY;
        for corner in self.corners() {
            let along = corner.coords.dot(direction);
            // Not `f64::min`, which also handles NaN: this is the innermost loop of the narrow phase.
            low = if along < low { along } else { low };
            high = if along > high { along } else { high };
        }
        (low, high)
    }

    /// Whether another outline is certainly further away than `room`, in m; only edge normals are tried.
    pub(crate) fn is_further_than(&self, room: Metre, other: &Self) -> bool {
        self.room_to(other, room, room) > room
    }

    /// A lower bound on the distance to another outline, in m: the widest room between an edge of the one and the
    /// other, or the first room above `enough`. Negative where the two overlap; −∞ where the room is below `little`.
    pub(super) fn room_to(&self, other: &Self, little: Metre, enough: Metre) -> Metre {
        let room = self.room_beside_edges(other, little, enough);
        if room > enough { room } else { room.max(other.room_beside_edges(self, little, enough)) }
    }

    fn room_beside_edges(&self, other: &Self, little: Metre, enough: Metre) -> Metre {
        let mut widest = f64::NEG_INFINITY;
        let mut start = self.corners[self.count - 1];
        for end in self.corners() {
            let normal = Vector::new(end.y - start.y, start.x - end.x);
            // Without a square root: the sum is at least the length, so the room is at most the true one.
            let length = normal.x.abs() + normal.y.abs();
            // For most edges the first or second corner shows that the other outline is not beside them.
            let too_near = (little - UNSURE) * length;
            let nearest = other.corners().iter().try_fold(f64::INFINITY, |nearest, corner| {
                let beside = (corner - start).dot(&normal);
                (beside >= too_near).then_some(if beside < nearest { beside } else { nearest })
            });
            widest = nearest.map_or(widest, |nearest| widest.max(nearest / length));
            if widest > enough {
                break;
            }
            start = *end;
        }
        widest
    }

    /// The axis-parallel box around it.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for corner in self.corners() {
            bounds.include(*corner);
        }
        bounds
    }
}

impl TryFrom<&[Point]> for ConvexOutline {
    type Error = usize;

    /// The outline of a convex polygon, corners counter-clockwise.
    ///
    /// # Errors
    /// The number of corners, if it is not three to eight.
    fn try_from(corners: &[Point]) -> Result<Self, usize> {
        let count = corners.len();
        if !(3..=MOST_CORNERS).contains(&count) {
            return Err(count);
        }
        let mut outline = Self { corners: [Point::origin(); MOST_CORNERS], count, edges: count };
        outline.corners[..count].copy_from_slice(corners);
        Ok(outline)
    }
}

#[cfg(test)]
mod tests {
    use crate::geometry::convex::*;

    #[test]
    fn the_hull_of_a_shifted_rectangle_is_the_swept_area() {
        let here = Rectangle::new(Point::origin(), 0.0, 4.0, 2.0);
        let there = Rectangle::new(Point::new(10.0, 0.0), 0.0, 4.0, 2.0);
        let hull = ConvexOutline::hull(&here, &there);
        assert_eq!(hull.corners().len(), 4);
        assert_eq!(hull.bounds(), Bounds { low: Point::new(-2.0, -1.0), high: Point::new(12.0, 1.0) });
    }

    #[test]
    fn the_hull_of_one_rectangle_twice_is_that_rectangle() {
        let here = Rectangle::new(Point::new(3.0, 4.0), 0.7, 4.0, 2.0);
        assert_eq!(ConvexOutline::hull(&here, &here).corners().len(), 4);
    }
}
