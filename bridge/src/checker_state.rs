//! What a step of a checker changes: the run, the source of its road users, its painter and its listeners.

use closecall_run::util::decimal::Written;
use closecall_run::{Ending, Error, RecordedRun};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::alarm::Listeners;
use crate::error::exception;
use crate::frames::Frames;
use crate::paint::Painter;
use crate::rows::Rows;
use crate::sumo::{Identity, Source};

/// What a step changes.
pub struct State {
    pub recorded: RecordedRun,
    pub feed: Feed,
    pub painter: Option<Painter>,
    pub listeners: Listeners,
    pub is_closed: bool,
    /// Whether the simulation calls each step, and has called the last one.
    pub listens: bool,
    pub has_listened: bool,
}

/// Where the road users come from.
pub enum Feed {
    Simulation(Box<Source>, Box<Identity>),
    Frames(Box<Frames>),
}

/// How a step ended, and what the user is warned of.
pub struct Stepped {
    pub goes_on: bool,
    pub warning: Option<String>,
}

impl State {
    /// Checks one step.
    pub fn check(&mut self, py: Python, time: f64, rows: Option<&Rows>) -> PyResult<Stepped> {
        let goes_on = Ok(Stepped { goes_on: true, warning: None });
        self.recorded.leave_if_forked();
        let run = &mut self.recorded.run;
        let mut warning = None;
        let checked = match (&mut self.feed, rows) {
            (Feed::Simulation(..), _) if self.is_closed => return Ok(Stepped { goes_on: false, warning: None }),
            (Feed::Simulation(source, identity), _) => {
                let asked = (self.listens && self.has_listened).then_some(time);
                let now = source.time(py)?;
                if let Some(why) = identity.is_another(py, run.time(), now, asked)? {
                    // The vehicles that it painted are not in the new simulation.
                    self.painter = None;
                    self.end(py, None)?;
                    return Ok(Stepped { goes_on: false, warning: Some(another(&why)) });
                }
                if run.time() == Some(now) {
                    // simulationStep does nothing up to a time that is reached already.
                    return if asked.is_some_and(|until| until > 0.0) { goes_on } else { Err(again(now)) };
                }
                self.has_listened = self.listens;
                if identity.has_moves_between() {
                    source.look_up_all();
                }
                source.pull(py, run, now)?;
                warning = source.take_remark();
                source.update_paths(py, run)?;
                py.detach(|| run.finish_step(|_| ()))
            }
            (Feed::Frames(_), _) if self.is_closed => {
                return Err(PyRuntimeError::new_err("the checker is closed"));
            }
            (Feed::Frames(frames), Some(rows)) => {
                frames.pull(run, time, rows)?;
                py.detach(|| run.step(|_, _| Ok(())))
            }
            (Feed::Frames(_), None) => return goes_on,
        };
        match checked {
            Ok(()) => {}
            Err(error @ Error::File { .. }) => {
                warning = Some(format!("{error}; the checker goes on, but its log ends here"));
            }
            // The step has changed the run already.
            Err(error) => return self.abandon(error),
        }
        if let Some(painter) = &mut self.painter {
            painter.paint(py, &self.recorded.run, None)?;
        }
        Ok(Stepped { goes_on: true, warning })
    }

    /// Ends the run with an error that leaves it half-way in a step.
    pub fn abandon(&mut self, error: Error) -> PyResult<Stepped> {
        self.is_closed = true;
        self.recorded.abandon(error.to_string());
        Err(exception(error))
    }

    /// Ends the run, with the error that ended it early if there was one.
    pub fn end(&mut self, py: Python, error: Option<String>) -> PyResult<()> {
        if std::mem::replace(&mut self.is_closed, true) {
            return Ok(());
        }
        self.recorded.leave_if_forked();
        let is_known = self.recorded.run.log_error().is_some();
        let closed = self.recorded.close(Ending { error, ..Ending::default() });
        if let Some(painter) = &mut self.painter {
            painter.clear(py)?;
        }
        match closed {
            // That the log is not written was said already, and is in `log_error`.
            Err(Error::File { .. }) if is_known => Ok(()),
            closed => closed.map(drop).map_err(exception),
        }
    }
}

fn again(time: f64) -> PyErr {
    let message = "is the checker a step listener and called as well?";
    PyValueError::new_err(format!("the simulation is at {} s again; {message}", Written(time)))
}

/// That a checker has stopped, as another simulation has taken the place of its own.
fn another(why: &str) -> String {
    format!(
        "this checker has stopped: {why}, as another one was started or loaded, or another state; make a new Checker for it"
    )
}
