//! The recording's lanes in the net.

use super::recording::Recording;
use crate::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};

/// Which lane of the net each of a recording's lanes is; looked up once.
#[derive(Debug, Default)]
pub(super) struct Lanes {
    known: Vec<Option<LaneIndex>>,
}

impl Lanes {
    /// The lane of this [`Row::lane`](super::recording::Row::lane), if the net has it.
    #[inline]
    pub fn lane(&mut self, lane: u32, recording: &Recording, net: &Net) -> Option<LaneIndex> {
        // The recording counts its lanes as they come up.
        while self.known.len() <= lane as usize {
            self.known.push(net.lane(recording.lane(self.known.len() as u32)));
        }
        self.known[lane as usize]
    }

    /// Its edge, where that is a road between junctions.
    #[inline]
    pub fn edge(&mut self, lane: u32, recording: &Recording, net: &Net) -> Option<EdgeIndex> {
        let edge = net.lanes[self.lane(lane, recording, net)?.0 as usize].edge;
        (net.edges[edge.0 as usize].function == EdgeFunction::Normal).then_some(edge)
    }
}
