//! Frame in, encounters out: both phases, one after the other.
//!
//! A pure function of the frames and placements it was given so far: no clock, no randomness, no input or output.

use std::sync::Arc;

use crate::encounter::{Encounter, Placement};
use crate::frame::{Frame, Roster};
use crate::net::Net;
use crate::options::Options;

/// Finds the encounters of one step after the other.
pub struct Detector {
    unplaced: Vec<u32>,
    encounters: Vec<Encounter>,
}

impl Detector {
    /// A detector for a scene; without a net every path is straight (or an arc, if so chosen).
    pub fn new(_options: &Options, _net: Option<Arc<Net>>) -> Self {
        todo!()
    }

    /// Phase 1: which pairs may meet. Returns the frame's rows whose lane the detector has to know for phase 2;
    /// the caller says it with [`Detector::place`], and leaves out whom it cannot place.
    pub fn approach(&mut self, _frame: &Frame, _roster: &Roster) -> &[u32] {
        &self.unplaced
    }

    /// Where the road user of a row is on the net.
    pub fn place(&mut self, _row: u32, _placement: Placement) {}

    /// Phase 2: the pairs that would meet, in the order of their ids.
    pub fn detect(&mut self, _frame: &Frame, _roster: &Roster) -> &[Encounter] {
        &self.encounters
    }
}
