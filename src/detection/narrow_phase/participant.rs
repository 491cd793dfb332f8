//! One road user of a pair, as the narrow phase sees it.

use super::SweptBounds;
use crate::braking::{Brakes, Braking};
use crate::detection::path::Pose;
use crate::geometry::polygon::Polygon;
use crate::geometry::rectangle::Rectangle;
use crate::util::units::{Metre, MetrePerSecond};

/// One road user of a pair: what phase 2 needs to know of it.
#[derive(Clone, Copy, Debug)]
pub struct Participant<'a> {
    /// The rectangle of now.
    pub rectangle: Rectangle,
    /// Convex parts of an obstacle; empty for all others.
    pub shape: &'a [Polygon],
    /// Poses from now until it stands and ε further; may be left out of who drives in line.
    pub poses: &'a [Pose],
    /// Whether it drives straight on all the way.
    pub straight: bool,
    /// How far ahead its path is known to go: S + ε, or less where the path ends.
    pub reach: Metre,
    /// The boxes around all that it covers on the way.
    pub cover: &'a SweptBounds,
    /// The same from each pose to the next; none of who drives straight on, where a part is hardly smaller than the whole.
    pub covers: &'a [SweptBounds],
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// How it brakes.
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

    /// Its part in μ.
    pub fn braking(&self) -> Braking<'_> {
        Braking { speed: self.speed, brakes: self.brakes }
    }
}
