//! Boxes around the area that a road user covers along its path: they rule out quickly that a pair can meet.

use crate::detection::path::Pose;
use crate::geometry::contact::plainly_touches;
use crate::geometry::movement::TOLERANCE;
use crate::geometry::rectangle::Rectangle;
use crate::geometry::{Bounds, Point, Vector};
use crate::util::units::Metre;

/// Boxes around the area that a road user covers between poses.
#[derive(Clone, Copy, Debug)]
pub struct SweptBounds {
    /// The axis-parallel box.
    pub bounds: Bounds,
    /// The box along the direction of travel: narrow whatever that direction is.
    pub around: Rectangle,
}

impl SweptBounds {
    /// The boxes around a road user of this length and width at these poses and between them; none without poses.
    ///
    /// Between two poses it leaves the hull of both by less than the sweep's tolerance.
    pub fn of(poses: &[Pose], length: Metre, width: Metre) -> Option<Self> {
        let rectangles = || poses.iter().map(|pose| Rectangle::behind(pose.front, pose.axis, length, width));
        let mut bounds = Bounds::EMPTY;
        for rectangle in rectangles() {
            bounds.join(&rectangle.bounds());
        }
        let (first, last) = (poses.first()?, poses.last()?);
        let rear = first.front - first.axis * length;
        let axis = (last.front - rear).try_normalize(0.0).unwrap_or(first.axis);
        let around = Rectangle::around(axis, rectangles(), TOLERANCE)?;
        Some(Self { bounds: bounds.grown(TOLERANCE), around })
    }

    /// The boxes around a road user that goes straight on from one pose to another; the axis-parallel box is known.
    pub fn straight(first: &Pose, last: &Pose, length: Metre, width: Metre, bounds: Bounds) -> Self {
        let now = Rectangle::behind(first.front, first.axis, length, width);
        let around = now.swept(&(last.front - first.front), TOLERANCE);
        Self { bounds, around }
    }

    /// Whether the boxes of two road users meet.
    pub fn meets(&self, other: &Self) -> bool {
        self.bounds.meet(&other.bounds) && plainly_touches(&self.around, &other.around)
    }
}

impl SweptBounds {
    /// Boxes that meet nothing.
    pub const NOWHERE: Self = Self {
        bounds: Bounds::EMPTY,
        around: Rectangle {
            centre: Point::new(0.0, 0.0),
            axis: Vector::new(1.0, 0.0),
            half_length: 0.0,
            half_width: 0.0,
        },
    };
    /// Boxes that meet everything, so that nothing is left out.
    pub const EVERYWHERE: Self = Self {
        bounds: Bounds::EVERYTHING,
        around: Rectangle {
            centre: Point::new(0.0, 0.0),
            axis: Vector::new(1.0, 0.0),
            half_length: 1e12,
            half_width: 1e12,
        },
    };
}

impl From<Bounds> for SweptBounds {
    fn from(bounds: Bounds) -> Self {
        Self { bounds, around: bounds.into() }
    }
}
