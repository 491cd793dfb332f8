//! A road network.

use nalgebra::Point2;
use rustc_hash::FxHashMap;

use super::elements::{Edge, EdgeIndex, Junction, Lane, LaneIndex};
use super::finder::Finder;
use crate::geometry::polylines::Lines;
use crate::util::units::Metre;

/// A road network.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// All lanes, by [`LaneIndex`].
    pub lanes: Vec<Lane>,
    /// All edges, by [`EdgeIndex`].
    pub edges: Vec<Edge>,
    /// All junctions.
    pub junctions: Vec<Junction>,
    /// The lanes' centre lines, by lane.
    pub lines: Lines,
    pub(super) lane_ids: FxHashMap<String, LaneIndex>,
    pub(super) edge_ids: FxHashMap<String, EdgeIndex>,
    pub(super) finder: Finder,
}

impl Net {
    /// The lane with this id.
    pub fn lane(&self, id: &str) -> Option<LaneIndex> {
        self.lane_ids.get(id).copied()
    }

    /// The edge with this id.
    pub fn edge(&self, id: &str) -> Option<EdgeIndex> {
        self.edge_ids.get(id).copied()
    }

    /// The lane with the centre line nearest to a place; none if that is more than 10 m away.
    pub fn lane_at(&self, place: Point2<Metre>) -> Option<LaneIndex> {
        self.finder.lane_at(&self.lanes, place)
    }

    /// The id of a lane.
    pub fn lane_id(&self, lane: LaneIndex) -> &str {
        &self.lanes[lane.0 as usize].id
    }
}
