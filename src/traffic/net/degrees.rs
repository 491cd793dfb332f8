//! Degrees from the metres of a net, by the projection of its file.

use std::fmt;
use std::sync::Arc;

use crate::geometry::Point;
use crate::util::units::Degree;

/// The longitude and latitude of a place, where a projection has them.
#[derive(Clone)]
pub struct ToDegrees(Arc<dyn Fn(Point) -> Option<[Degree; 2]> + Send + Sync>);

impl ToDegrees {
    /// By this projection.
    pub fn by(projection: impl Fn(Point) -> Option<[Degree; 2]> + Send + Sync + 'static) -> Self {
        Self(Arc::new(projection))
    }

    /// Longitude and latitude of a place.
    pub fn of(&self, place: Point) -> Option<[Degree; 2]> {
        (self.0)(place)
    }
}

impl fmt::Debug for ToDegrees {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("ToDegrees")
    }
}
