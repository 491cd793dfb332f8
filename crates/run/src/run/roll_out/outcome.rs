//! What came of a roll-out: the paths of the watched, the errors of the drivers, the first contact.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::Run;
use crate::util::{input_file, output_file};
use crate::{Error, Result};
use closecall::traffic::frame::Row;
use closecall::traffic::profile::Category;
use closecall::util::units::{Metre, MetrePerSecond, Radian, Second};

/// The file of an [`Outcome`] in a log's folder.
pub const ROLL_OUT: &str = "roll-out.json";

/// What came of a roll-out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The paths of the watched.
    pub paths: BTreeMap<String, Vec<PathStep>>,
    /// Those of the watched that are persons.
    pub persons: Vec<String>,
    /// The drivers' errors, in the order in which they were asked for.
    pub drivers: Vec<DrawnError>,
    /// The first contact of one of the watched that is traffic's; none where there was none.
    pub contact: Option<Contact>,
}

/// Where a road user was: time in s, x and y of its front in m, heading in rad, speed in m/s.
pub type PathStep = (Second, Metre, Metre, Radian, MetrePerSecond);

/// A driver's error.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DrawnError {
    /// The driver's id.
    pub id: String,
    /// When it would have had to respond, in s; none where no conflict opened.
    pub from: Option<Second>,
    /// Its response time in s.
    pub response: Second,
    /// Its deceleration in m/s².
    pub deceleration: f64,
}

/// A contact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// The end of the step in which it happened, in s.
    pub time: Second,
    /// The two.
    pub pair: [String; 2],
}

impl Outcome {
    /// Notes where the watched are after a step, and whether one of them is in contact.
    pub(super) fn see(&mut self, run: &Run, watched: &[&String]) {
        for Row { user, state } in run.frame.rows() {
            let id = run.roster.id(user);
            if watched.iter().any(|known| *known == id) {
                let path = self.paths.entry(id.to_string()).or_default();
                if path.is_empty() && run.roster.profile_of(user).category == Category::Person {
                    self.persons.push(id.to_string());
                }
                path.push((run.frame.time, state.x, state.y, state.heading, state.speed));
            }
        }
        if self.contact.is_none() {
            let is_watched = |id: &str| watched.iter().any(|known| *known == id);
            let conflicts = run.conflicts();
            let mut struck = conflicts.iter().filter(|conflict| conflict.collision && conflict.artefact.is_none());
            let found = struck.find(|conflict| is_watched(&conflict.ego) || is_watched(&conflict.foe));
            self.contact = found
                .map(|found| Contact { time: run.frame.time, pair: [found.ego.to_string(), found.foe.to_string()] });
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`Error::File`] that names the file.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string(self).map_err(|error| Error::content(path, error.to_string()))?;
        output_file::write(path, text.as_bytes())
    }

    /// Reads it.
    ///
    /// # Errors
    /// [`Error::File`] or [`Error::Content`] that names the file.
    pub fn read(path: &Path) -> Result<Self> {
        let text = input_file::text(path)?;
        serde_json::from_str(&text).map_err(|error| Error::content(path, error.to_string()))
    }
}
