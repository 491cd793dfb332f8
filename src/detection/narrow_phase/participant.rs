//! One road user of a pair, or one carriage of it, as the narrow phase needs it.

use super::SweptBounds;
use crate::braking::{Brakes, Braking};
use crate::detection::path::Pose;
use crate::geometry::movement::Movement;
use crate::geometry::polygon::Polygon;
use crate::geometry::rectangle::Rectangle;
use crate::traffic::profile::Carriage;
use crate::util::units::{Metre, MetrePerSecond};

/// One road user of a pair, or one carriage of it.
#[derive(Clone, Copy, Debug)]
pub struct Participant<'a> {
    /// Its current rectangle.
    pub rectangle: Rectangle,
    /// The carriage that its poses are those of: the first where all of the road user is one rectangle.
    pub carriage: Carriage,
    /// How far the rectangle's front is behind the front bumper in m; 0 unless it is `shrunk`.
    pub setback: Metre,
    /// The convex parts of an obstacle; empty for other road users.
    pub shape: &'a [Polygon],
    /// Poses from now until it stands and ε further; may be empty for a pair in line.
    pub poses: &'a [Pose],
    /// Whether all its poses lie straight ahead.
    pub straight: bool,
    /// How far ahead its path is known: S + ε, or less where the path ends.
    pub reach: Metre,
    /// The boxes around the area that it covers along all poses.
    pub cover: &'a SweptBounds,
    /// The boxes between each two poses; empty if it drives straight on, where a part is hardly smaller than the whole.
    pub covers: &'a [SweptBounds],
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// Its brakes.
    pub brakes: &'a Brakes,
    /// Its stopping distance.
    pub stop: Metre,
}

impl Participant<'_> {
    /// Length in m.
    pub fn length(&self) -> Metre {
        2.0 * self.rectangle.half_length
    }

    /// Width in m.
    pub fn width(&self) -> Metre {
        2.0 * self.rectangle.half_width
    }

    /// The same road user, smaller by `by` m on every side.
    pub(crate) fn shrunk(&self, by: Metre) -> Self {
        let Rectangle { half_length, half_width, .. } = self.rectangle;
        let by = by.min(half_length).min(half_width);
        let rectangle = Rectangle { half_length: half_length - by, half_width: half_width - by, ..self.rectangle };
        Self { rectangle, setback: self.setback + by, ..*self }
    }

    /// Its movement from one pose to the next.
    pub fn movement(&self, from: &Pose, to: &Pose) -> Movement {
        let mut movement = from.movement_to(to, self.length(), self.width());
        movement.from -= from.axis * self.setback;
        movement.to -= to.axis * self.setback;
        movement
    }

    /// Its part in μ.
    pub fn braking(&self) -> Braking<'_> {
        Braking { speed: self.speed, brakes: self.brakes }
    }
}
