//! What a run writes: its log and its other files. After a write that failed it writes nothing more, because rows would
//! be missing in between, even where the disk has room again.

use crate::output::formats::Outputs;
use crate::output::log::Log;
use crate::{Error, Result};
use closecall::events::{Clip, Conflict};
use closecall::traffic::frame::Frame;
use closecall::traffic::net::Net;
use closecall::traffic::roster::Roster;

/// The log and the other files of a run.
#[derive(Debug, Default)]
pub struct Writing {
    pub log: Option<Log>,
    pub outputs: Outputs,
    /// Why nothing more is written.
    pub error: Option<String>,
}

impl Writing {
    /// Writes the road users of a step.
    ///
    /// # Errors
    /// The first time that something cannot be written: [`Error::File`] that names it.
    pub fn trajectories(&mut self, frame: &Frame, roster: &Roster, net: Option<&Net>) -> Result<()> {
        self.attempt(|it| it.outputs.write_step(frame, roster, net))
    }

    /// Writes the conflicts that have closed in a step, and the clips that are whole.
    ///
    /// # Errors
    /// As in [`Writing::trajectories`].
    pub fn conflicts(&mut self, closed: &[Conflict], clips: &[Clip], roster: &Roster, net: Option<&Net>) -> Result<()> {
        self.attempt(|it| {
            it.append(closed, clips, roster, net)?;
            it.log.as_mut().map_or(Ok(()), Log::sync_now_and_then)
        })
    }

    /// Writes the last conflicts, and completes everything but `run.json`.
    ///
    /// # Errors
    /// As in [`Writing::trajectories`].
    pub fn finish(&mut self, closed: &[Conflict], clips: &[Clip], roster: &Roster, net: Option<&Net>) -> Result<()> {
        self.attempt(|it| {
            it.append(closed, clips, roster, net)?;
            it.log.as_mut().map_or(Ok(()), Log::finish)?;
            it.outputs.finish()
        })
    }

    fn append(&mut self, closed: &[Conflict], clips: &[Clip], roster: &Roster, net: Option<&Net>) -> Result<()> {
        if let (Some(log), false) = (&mut self.log, closed.is_empty()) {
            log.append_conflicts(closed, net, roster)?;
        }
        if let Some(log) = &mut self.log {
            log.append_clips(clips)?;
        }
        self.outputs.write_conflicts(closed)
    }

    fn attempt(&mut self, write: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        if self.error.is_some() {
            return Ok(());
        }
        let written = write(self);
        self.error = written.as_ref().err().map(|error| self.ends_with(error));
        written
    }

    fn ends_with(&self, error: &Error) -> String {
        let rows = self.log.as_ref().map(|log| format!("; the last whole row of the log is {}", log.rows()));
        error.to_string() + &rows.unwrap_or_default()
    }
}
