//! Places with names of their own, from a file: areas, and groups of edges and junctions.
//!
//! ```toml
//! [[place]]
//! name = "Old town"
//! polygon = [[0, 0], [120, 0], [120, 80]] # m in the net
//!
//! [[place]]
//! name = "Ring road"
//! edges = ["a1", "a2"]
//! junctions = ["J7"]
//! ```

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use closecall::geometry::Point;
use closecall::geometry::outline::{is_inside, sides};
use closecall::util::limits::POSITION;
use closecall_run::output::schema::LoggedConflict;
use closecall_run::util::input_file;
use closecall_run::{Error, Result};

/// The places of a file, in its order.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPlaces {
    path: PathBuf,
    /// The places.
    pub all: Arc<[NamedPlace]>,
}

/// A place with a name: all that is within its polygon, on its edges or at its junctions.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct NamedPlace {
    /// Its name.
    pub name: String,
    /// The corners of an area, in m.
    #[serde(default)]
    pub polygon: Vec<[f64; 2]>,
    /// SUMO's ids of edges.
    #[serde(default)]
    pub edges: Vec<String>,
    /// SUMO's ids of junctions.
    #[serde(default)]
    pub junctions: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlaceFile {
    place: Vec<NamedPlace>,
}

impl NamedPlace {
    /// Whether the conflict point is there.
    pub fn holds(&self, conflict: &LoggedConflict) -> bool {
        let is_on = |ids: &[String], id: &str| !id.is_empty() && ids.iter().any(|known| known == id);
        is_on(&self.edges, conflict.edge())
            || is_on(&self.junctions, conflict.junction())
            || self.is_around(Point::new(conflict.x, conflict.y))
    }

    fn is_around(&self, place: Point) -> bool {
        let corners = self.polygon.iter().map(|[x, y]| Point::new(*x, *y)).collect::<Vec<_>>();
        is_inside(sides(&corners), place)
    }

    fn check(&self) -> std::result::Result<(), String> {
        let Self { name, polygon, edges, junctions } = self;
        if name.trim().is_empty() || name.contains(',') {
            return Err(format!("name = \"{name}\": it must be a name without commas"));
        }
        if polygon.is_empty() && edges.is_empty() && junctions.is_empty() {
            return Err(format!("\"{name}\" has neither a polygon nor edges nor junctions"));
        }
        if (1..3).contains(&polygon.len()) {
            return Err(format!("\"{name}\": a polygon has three corners or more, not {}", polygon.len()));
        }
        polygon.iter().flatten().try_for_each(|value| POSITION.check("polygon", *value).map(drop))
    }
}

impl NamedPlaces {
    /// Reads a file.
    ///
    /// # Errors
    /// An error that names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path, &input_file::text(path)?)
    }

    fn parse(path: &Path, text: &str) -> Result<Self> {
        let wrong = |why: String| Error::content(path, why);
        let PlaceFile { place: all } =
            toml::from_str(text).map_err(|error| wrong(error.to_string().trim().replace('\n', " ")))?;
        all.iter().try_for_each(NamedPlace::check).map_err(wrong)?;
        let twice = (0..all.len()).find(|place| all[..*place].iter().any(|before| before.name == all[*place].name));
        if let Some(twice) = twice {
            return Err(wrong(format!("\"{}\" is there twice", all[twice].name)));
        }
        Ok(Self { path: path.to_owned(), all: all.into() })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The first place at which a conflict is.
    pub fn of(&self, conflict: &LoggedConflict) -> Option<&NamedPlace> {
        self.all.iter().find(|place| place.holds(conflict))
    }

    /// The place of this name.
    pub fn named(&self, name: &str) -> Option<&NamedPlace> {
        self.all.iter().find(|place| place.name == name)
    }
}

/// From the path of the file, as a command line names it.
impl FromStr for NamedPlaces {
    type Err = Error;

    fn from_str(path: &str) -> Result<Self> {
        Self::read(Path::new(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall_run::output::sample_conflict::sample;

    fn places(text: &str) -> Result<NamedPlaces> {
        NamedPlaces::parse(Path::new("places.toml"), text)
    }

    #[test]
    fn a_place_is_an_area_or_a_group() {
        let found = places(
            "[[place]]\nname = \"Old town\"\npolygon = [[0, 0], [10, 0], [10, 10], [5, 5], [0, 10]]\n\
             [[place]]\nname = \"Ring road\"\nedges = [\"a\"]\njunctions = [\"J\"]\n",
        )
        .unwrap();
        let name = |lane: &str, x: &str, y: &str| {
            found.of(&sample(&[("lane", lane), ("x", x), ("y", y)]).unwrap()).map(|place| place.name.clone())
        };
        assert_eq!(name("b_0", "2", "5").as_deref(), Some("Old town"));
        assert_eq!(name("b_0", "5", "8"), None, "in the notch");
        assert_eq!(name("a_1", "50", "50").as_deref(), Some("Ring road"));
        assert_eq!(name(":J_3_0", "50", "50").as_deref(), Some("Ring road"));
        assert_eq!(name("a_1", "2", "5").as_deref(), Some("Old town"), "the first counts");
    }

    #[test]
    fn what_is_no_place_is_refused() {
        for (text, why) in [
            ("[[place]]\nname = \"a\"\n", "neither a polygon"),
            ("[[place]]\nname = \"a,b\"\nedges = [\"e\"]\n", "without commas"),
            ("[[place]]\nname = \"a\"\npolygon = [[0, 0], [1, 1]]\n", "three corners"),
            ("[[place]]\nname = \"a\"\nedge = [\"e\"]\n", "unknown field `edge`"),
            ("[[place]]\nname = \"a\"\nedges = [\"e\"]\n[[place]]\nname = \"a\"\nedges = [\"f\"]\n", "there twice"),
            ("", "missing field `place`"),
        ] {
            let said = places(text).unwrap_err().to_string();
            assert!(said.starts_with("places.toml: ") && said.contains(why), "{said}");
            assert!(!said.contains('\n'));
        }
    }
}
