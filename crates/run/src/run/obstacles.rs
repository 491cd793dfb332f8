//! Static obstacles: polygons that enter the scene.

use super::Run;
use crate::{Error, Result};
use closecall::geometry::Point;
use closecall::geometry::polygon::convex_parts;
use closecall::traffic::profile::Profile;
use closecall::traffic::roster::UserIndex;
use closecall::util::limits::{CORNERS, POSITION};

impl Run {
    /// A static obstacle enters the scene and stays: a polygon of this type and outline.
    ///
    /// # Errors
    /// [`Error::Value`] if the outline has too few or too many points, or one out of range.
    pub fn enter_obstacle(&mut self, id: &str, polygon_type: &str, outline: &[Point]) -> Result<()> {
        let user = self.enter_shape(id, polygon_type, outline)?;
        self.obstacles.push((user, outline[0]));
        Ok(())
    }

    /// The same, for an obstacle that the source adds to each frame itself.
    ///
    /// # Errors
    /// Those of [`Run::enter_obstacle`].
    pub fn enter_shape(&mut self, id: &str, polygon_type: &str, outline: &[Point]) -> Result<UserIndex> {
        let values = outline.iter().flat_map(|point| [("x", point.x, &POSITION), ("y", point.y, &POSITION)]);
        for (name, value, limit) in [("its number of points", outline.len() as f64, &CORNERS)].into_iter().chain(values)
        {
            limit.check(name, value).map_err(|why| Error::Value(format!("polygon \"{id}\": {why}")))?;
        }
        let shape = convex_parts(outline).into();
        let profile = self.roster.profile(Profile::obstacle(polygon_type))?;
        Ok(self.roster.enter_shaped(id, profile, shape))
    }
}
