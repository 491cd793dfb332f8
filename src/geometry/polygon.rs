//! Polygons of any shape, cut into convex parts: static obstacles.

use parry2d_f64::math::Pose;
use parry2d_f64::query;
use parry2d_f64::shape::{ConvexPolygon, TriMesh};
use parry2d_f64::transformation::{convex_hull, hertel_mehlhorn};

use super::convex::ConvexOutline;
use super::rectangle::Rectangle;
use super::{Bounds, Point, parry};
use crate::util::units::Metre;

/// A convex polygon with three to eight corners.
#[derive(Clone, Copy, Debug)]
pub struct Polygon {
    /// Its outline, counter-clockwise.
    pub outline: ConvexOutline,
    /// The box around it.
    pub bounds: Bounds,
}

impl Polygon {
    fn new(corners: &[Point]) -> Option<Self> {
        ConvexOutline::try_from(corners).ok().map(Self::from)
    }

    /// The same polygon for parry2d.
    fn shape(&self) -> Option<ConvexPolygon> {
        ConvexPolygon::from_convex_polyline(
            self.outline.corners().iter().map(|&corner| parry::vector(corner)).collect(),
        )
    }
}

impl From<ConvexOutline> for Polygon {
    fn from(outline: ConvexOutline) -> Self {
        Self { outline, bounds: outline.bounds() }
    }
}

/// The convex parts of a polygon. Its outline may run in either sense and may be closed or not. Parts with more than
/// eight corners are cut into fans. An outline that crosses itself has no partition and returns its convex hull; fewer
/// than three different points return nothing.
pub fn convex_parts(outline: &[Point]) -> Vec<Polygon> {
    let mut points = outline.to_vec();
    points.dedup();
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 || points.iter().any(|point| !(point.x + point.y).is_finite()) {
        return Vec::new();
    }
    let twice_area: f64 = (0..points.len())
        .map(|index| super::cross(&(points[index] - points[0]), &(points[(index + 1) % points.len()] - points[0])))
        .sum();
    if twice_area < 0.0 {
        points.reverse();
    }
    let vectors = points.iter().map(|&point| parry::vector(point)).collect::<Vec<_>>();
    let parts = match TriMesh::from_polygon(vectors.clone()) {
        Some(triangles) => hertel_mehlhorn(&vectors, triangles.indices()),
        None => vec![convex_hull(&vectors)],
    };
    parts.iter().flat_map(|part| fans(&part.iter().map(|&v| parry::point(v)).collect::<Vec<_>>())).collect()
}

/// The smallest distance between a polygon in convex parts and a rectangle, in m; 0 where they touch or overlap.
pub fn distance(parts: &[Polygon], rectangle: &Rectangle) -> Metre {
    let (pose, cuboid) = parry::cuboid(rectangle);
    let found = parts.iter().filter_map(|part| query::distance(&Pose::IDENTITY, &part.shape()?, &pose, &cuboid).ok());
    found.map(|found| found.distance).fold(f64::INFINITY, f64::min)
}

/// How deep a rectangle overlaps a polygon in convex parts, in m; 0 where it does not.
pub fn overlap(parts: &[Polygon], rectangle: &Rectangle) -> Metre {
    let (pose, cuboid) = parry::cuboid(rectangle);
    let depth = |part: &Polygon| {
        let contact = query::contact(&Pose::IDENTITY, &part.shape()?, &pose, &cuboid, 0.0).ok()??;
        Some(-contact.dist)
    };
    parts.iter().filter_map(depth).fold(0.0, f64::max)
}

/// Cuts a convex polygon into pieces of up to eight corners that all share the first corner.
fn fans(corners: &[Point]) -> Vec<Polygon> {
    let Some((&first, rest)) = corners.split_first() else { return Vec::new() };
    let mut pieces = Vec::new();
    let mut start = 0;
    while start + 1 < rest.len() {
        let end = (start + 6).min(rest.len() - 1);
        let mut piece = vec![first];
        piece.extend_from_slice(&rest[start..=end]);
        pieces.extend(Polygon::new(&piece));
        start = end;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(parts: &[Polygon]) -> f64 {
        parts
            .iter()
            .map(|part| {
                let corners = part.outline.corners();
                (1..corners.len() - 1)
                    .map(|i| super::super::cross(&(corners[i] - corners[0]), &(corners[i + 1] - corners[0])) / 2.0)
                    .sum::<f64>()
            })
            .sum()
    }

    #[test]
    fn an_l_shape_keeps_its_area_in_either_sense() {
        let mut corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0), (0.0, 0.0)]
            .map(|(x, y)| Point::new(x, y));
        assert!((area(&convex_parts(&corners)) - 6.0).abs() < 1e-12);
        corners.reverse();
        assert!((area(&convex_parts(&corners)) - 6.0).abs() < 1e-12);
    }

    #[test]
    fn a_circle_of_many_corners_keeps_its_area() {
        let corners: Vec<_> = (0..40)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 40.0)
            .map(|a| Point::new(a.cos(), a.sin()))
            .collect();
        assert!((area(&convex_parts(&corners)) - 20.0 * (std::f64::consts::TAU / 40.0).sin()).abs() < 1e-9);
    }

    #[test]
    fn the_overlap_with_a_wall_is_how_far_the_front_is_in_it() {
        let wall = convex_parts(&[(10.0, -5.0), (12.0, -5.0), (12.0, 5.0), (10.0, 5.0)].map(|(x, y)| Point::new(x, y)));
        let car = |front: f64| Rectangle::behind(Point::new(front, 0.0), crate::geometry::Vector::x(), 5.0, 1.8);
        assert!((overlap(&wall, &car(10.3)) - 0.3).abs() < 1e-6);
        assert_eq!(overlap(&wall, &car(9.9)), 0.0);
    }

    #[test]
    fn a_line_is_not_an_obstacle() {
        assert!(convex_parts(&[Point::new(0.0, 0.0), Point::new(1.0, 0.0)]).is_empty());
    }
}
