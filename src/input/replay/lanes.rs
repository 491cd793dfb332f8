//! Finds the recording's lanes in the net.

use super::recording::Recording;
use crate::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};

/// The net's lane for each of the recording's lanes; each is looked up once.
#[derive(Debug, Default)]
pub(super) struct Lanes {
    known: Vec<Option<LaneIndex>>,
}

impl Lanes {
    /// The lane for a [`RecordedRow::lane`](super::rows::RecordedRow::lane), if the net has it.
    #[inline]
    pub fn lane(&mut self, lane: u32, recording: &Recording, net: &Net) -> Option<LaneIndex> {
        // The recording numbers its lanes in the order in which they appear.
        while self.known.len() <= lane as usize {
            self.known.push(net.lane(recording.lane(self.known.len() as u32)));
        }
        self.known[lane as usize]
    }

    /// Its edge, if that is a road between junctions.
    #[inline]
    pub fn edge(&mut self, lane: u32, recording: &Recording, net: &Net) -> Option<EdgeIndex> {
        let edge = net.lanes[self.lane(lane, recording, net)?.0 as usize].edge;
        (net.edges[edge.0 as usize].function == EdgeFunction::Normal).then_some(edge)
    }
}
