//! A roll-out: the seconds of a conflict run again from a saved state, with drivers that err, until the first contact.
//!
//! `driver.rs` says what a driver does that errs, and the bridge passes it on to SUMO. All other road users react as SUMO
//! has them. What came of it is kept for `closecall whatif`: the paths, the drivers' errors, the contact.

mod course;
mod driver;
mod lapses;
mod outcome;
mod plan;

use std::path::Path;

use super::Run;
use crate::Result;
use closecall::util::units::SAME_MOMENT;
use driver::Steered;
use lapses::Lapsing;

pub use driver::Command;
pub use outcome::{Contact, DrawnError, Outcome, PathStep, ROLL_OUT};
pub use plan::{DriverError, ErringDriver, Lapses, RollOut, Watched};

/// A roll-out under way.
#[derive(Debug)]
pub struct RollOutRun {
    asked: RollOut,
    drivers: Vec<Steered>,
    lapsing: Option<Lapsing>,
    outcome: Outcome,
}

impl RollOutRun {
    /// Begins it.
    pub fn new(asked: RollOut) -> Self {
        let drivers = asked.drivers.iter().cloned().map(Steered::new).collect::<Vec<_>>();
        let outcome = Outcome { drivers: vec![DrawnError::default(); drivers.len()], ..Outcome::default() };
        let lapsing = asked.lapses.clone().map(Lapsing::new);
        Self { asked, drivers, lapsing, outcome }
    }

    /// Takes a step of the run, which is finished; returns what SUMO is to be told about which vehicle. SUMO moves a vehicle by
    /// the speed at the end of a step, or by the mean one where it is `ballistic`.
    pub fn step(&mut self, run: &Run, is_ballistic: bool) -> Vec<(String, Command)> {
        let time = run.frame.time;
        let is_now = |watched: &&Watched| watched.from - SAME_MOMENT < time && time < watched.until + SAME_MOMENT;
        let watched = self.asked.watched.iter().filter(is_now).flat_map(|watched| &watched.pair).collect::<Vec<_>>();
        if !watched.is_empty() {
            self.outcome.see(run, &watched);
        } else if !self.asked.watched.is_empty() {
            // Until then the two do what they did in the run.
            return Vec::new();
        }
        for driver in self.lapsing.iter_mut().flat_map(|lapsing| lapsing.step(run)) {
            self.drivers.push(Steered::new(driver));
            self.outcome.drivers.push(DrawnError::default());
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
    /// [`File`](crate::Error::File) that names the file.
    pub fn write(&self, folder: &Path) -> Result<()> {
        self.outcome.write(&folder.join(ROLL_OUT))
    }
}
