//! Tells SUMO what a roll-out's drivers do.

use std::path::Path;

use closecall_run::Run;
use closecall_run::run::roll_out::{Command, RollOut, RollOutRun};
use pyo3::prelude::*;

use super::simulation::is_ballistic;

/// A roll-out, and SUMO's functions for its drivers.
pub struct Steering<'py> {
    roll_out: RollOutRun,
    vehicle: Bound<'py, PyAny>,
    is_ballistic: bool,
}

impl<'py> Steering<'py> {
    pub fn new(sumo: &Bound<'py, PyAny>, asked: RollOut) -> PyResult<Self> {
        let (vehicle, is_ballistic) = (sumo.getattr("vehicle")?, is_ballistic(sumo)?);
        Ok(Self { roll_out: RollOutRun::new(asked), vehicle, is_ballistic })
    }

    /// Steers the drivers after a step that is finished; returns whether the roll-out is over.
    pub fn step(&mut self, run: &Run) -> PyResult<bool> {
        for (id, command) in self.roll_out.step(run, self.is_ballistic) {
            match command {
                Command::SpeedMode(mode) => self.vehicle.call_method1("setSpeedMode", (id, mode))?,
                Command::LaneChangeMode(mode) => self.vehicle.call_method1("setLaneChangeMode", (id, mode))?,
                Command::Speed(speed) => self.vehicle.call_method1("setSpeed", (id, speed))?,
            };
        }
        Ok(self.roll_out.is_over())
    }

    /// Writes what came of it into the log's folder.
    pub fn write(&self, folder: &Path) -> closecall_run::Result<()> {
        self.roll_out.write(folder)
    }
}
