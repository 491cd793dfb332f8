//! A roll-out: the seconds of a conflict run again from a saved state, with drivers that err, until the first contact.
//!
//! It says what a driver does that errs ([`driver::Steered`]); the bridge tells SUMO so. All other road users react as SUMO has
//! them. What came of it is kept for `closecall whatif`: the paths, the drivers' errors, the contact.

mod course;
mod driver;

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Run;
use crate::util::output_file;
use crate::{Error, Result};
use closecall::traffic::frame::Row;
use closecall::traffic::profile::Category;
use closecall::util::units::{Metre, MetrePerSecond, Probability, Radian, SAME_MOMENT, Second};
use driver::Steered;

pub use driver::Command;

/// The file of an [`Outcome`] in a log's folder.
pub const ROLL_OUT: &str = "roll-out.json";

/// What is to be done in a roll-out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollOut {
    /// The pairs whose paths are kept.
    pub watched: Vec<Watched>,
    /// The drivers that err, or answer the error of another; none in a baseline.
    pub drivers: Vec<ErringDriver>,
    /// Whether it ends at the first contact of one of the watched.
    pub ends_at_contact: bool,
}

/// A pair whose paths are kept from one time to another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Their ids.
    pub pair: [String; 2],
    /// The first time, in s.
    pub from: Second,
    /// The last time, in s.
    pub until: Second,
}

/// A driver that errs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErringDriver {
    /// Its id.
    pub id: String,
    /// The other of its conflict.
    pub foe: String,
    /// What it does wrong.
    pub error: DriverError,
    /// When it would have to respond, in s; none where that is when its conflict opens.
    pub from: Option<Second>,
    /// The share of drivers that respond sooner.
    pub response: Probability,
    /// The share of drivers whose vehicles brake more weakly.
    pub deceleration: Probability,
}

/// What a driver does wrong. After its response time it brakes, until the conflict is over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum DriverError {
    /// It responds late: from the moment the conflict opens, it goes on as it was for its response time.
    #[default]
    Late,
    /// It also misjudges the gap: until then it gives way to no one at junctions.
    Gap,
    /// It also does not see the signal: until then it stops for none.
    Signal,
}

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

impl RollOut {
    /// Reads the words of `--roll-out`.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn parse(text: &str) -> std::result::Result<Self, String> {
        serde_json::from_str(text).map_err(|error| error.to_string())
    }
}

/// A roll-out under way.
#[derive(Debug)]
pub struct RollOutRun {
    asked: RollOut,
    drivers: Vec<Steered>,
    outcome: Outcome,
}

impl RollOutRun {
    /// Begins it.
    pub fn new(asked: RollOut) -> Self {
        let drivers = asked.drivers.iter().cloned().map(Steered::new).collect::<Vec<_>>();
        let outcome = Outcome { drivers: vec![DrawnError::default(); drivers.len()], ..Outcome::default() };
        Self { asked, drivers, outcome }
    }

    /// Takes a step of the run, which is finished; returns what SUMO is to be told about which vehicle. SUMO moves a vehicle by
    /// the speed at the end of a step, or by the mean one where it is `ballistic`.
    pub fn step(&mut self, run: &Run, is_ballistic: bool) -> Vec<(String, Command)> {
        let time = run.frame.time;
        let is_now = |watched: &&Watched| watched.from - SAME_MOMENT < time && time < watched.until + SAME_MOMENT;
        let watched = self.asked.watched.iter().filter(is_now).flat_map(|watched| &watched.pair).collect::<Vec<_>>();
        if !watched.is_empty() {
            self.outcome.see(run, &watched);
        }
        let step = run.step_length().unwrap_or(1.0);
        let mut commands = Vec::new();
        for (driver, drawn) in self.drivers.iter_mut().zip(&mut self.outcome.drivers) {
            let told = driver.step(run, step, is_ballistic, drawn);
            commands.extend(told.into_iter().map(|command| (driver.id().to_owned(), command)));
        }
        commands
    }

    /// Whether it is over, since two are in contact.
    pub fn is_over(&self) -> bool {
        self.asked.ends_at_contact && self.outcome.contact.is_some()
    }

    /// Writes what came of it into a log's folder.
    ///
    /// # Errors
    /// [`Error::File`] that names the file.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let path = folder.join(ROLL_OUT);
        let text = serde_json::to_string(&self.outcome).map_err(|error| Error::content(&path, error.to_string()))?;
        output_file::write(&path, text.as_bytes())
    }
}

impl Outcome {
    /// Notes where the watched are after a step, and whether one of them is in contact.
    fn see(&mut self, run: &Run, watched: &[&String]) {
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

    /// Reads it.
    ///
    /// # Errors
    /// [`Error::File`] or [`Error::Content`] that names the file.
    pub fn read(path: &Path) -> Result<Self> {
        let text = crate::util::input_file::text(path)?;
        serde_json::from_str(&text).map_err(|error| Error::content(path, error.to_string()))
    }
}
