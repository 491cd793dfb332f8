//! A small convex polygon.

use nalgebra::Point2;

/// A convex polygon, corners counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The corners.
    pub corners: Vec<Point2<f64>>,
}
