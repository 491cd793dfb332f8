//! Lanes and links, read from a SUMO net (`*.net.xml`, also gzipped).
//!
//! Only what paths, obstacles of the scene and places in the log need: lane shapes, what leads where, junctions.

use std::path::Path;

use nalgebra::Point2;
use rustc_hash::FxHashMap;

use crate::Result;
use crate::units::Metre;

/// Which lane of a [`Net`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LaneIndex(pub u32);

/// Which edge of a [`Net`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeIndex(pub u32);

/// What an edge is for (SUMO's attribute `function`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeFunction {
    /// A road between junctions.
    Normal,
    /// Lanes within a junction.
    Internal,
    /// A pedestrian crossing.
    Crossing,
    /// Where pedestrians get from one to another.
    WalkingArea,
    /// A macroscopic connector.
    Connector,
}

/// One edge.
#[derive(Clone, Debug)]
pub struct Edge {
    /// SUMO's id.
    pub id: String,
    /// What it is for.
    pub function: EdgeFunction,
    /// Its lanes, from right to left.
    pub lanes: Vec<LaneIndex>,
    /// The junction that it belongs to (internal edges, crossings, walking areas) or leads to.
    pub junction: String,
}

/// Where a lane leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The lane of the next normal edge that is reached in the end.
    pub to: LaneIndex,
    /// The first junction lane on the way there; none where lanes join directly.
    pub via: Option<LaneIndex>,
}

/// One lane.
#[derive(Clone, Debug)]
pub struct Lane {
    /// SUMO's id.
    pub id: String,
    /// Its edge.
    pub edge: EdgeIndex,
    /// Its place on the edge, 0 at the right.
    pub index: u32,
    /// Length in SUMO's terms, in m; a lane position is measured in these.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// The centre line, two points at least.
    pub shape: Vec<Point2<Metre>>,
    /// Way from the shape's start to each of its points, in m of the drawn line.
    pub ways: Vec<Metre>,
    /// Where it leads. A junction lane in two parts leads to its second part (`via`), then to the edge.
    pub links: Vec<Link>,
    /// The lanes from which one gets here directly (for a lane behind a junction: the junction lanes).
    pub from: Vec<LaneIndex>,
}

/// One junction.
#[derive(Clone, Debug)]
pub struct Junction {
    /// SUMO's id.
    pub id: String,
    /// Its outline.
    pub shape: Vec<Point2<Metre>>,
}

/// A road network.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// All lanes, by [`LaneIndex`].
    pub lanes: Vec<Lane>,
    /// All edges, by [`EdgeIndex`].
    pub edges: Vec<Edge>,
    /// All junctions.
    pub junctions: Vec<Junction>,
    /// Whether any two lane points differ in height by more than road users that are a pair may.
    pub has_levels: bool,
    lane_ids: FxHashMap<String, LaneIndex>,
    edge_ids: FxHashMap<String, EdgeIndex>,
}

impl Net {
    /// The lane of this id.
    pub fn lane(&self, id: &str) -> Option<LaneIndex> {
        self.lane_ids.get(id).copied()
    }

    /// The edge of this id.
    pub fn edge(&self, id: &str) -> Option<EdgeIndex> {
        self.edge_ids.get(id).copied()
    }

    /// Reads a net file.
    ///
    /// # Errors
    /// An error that names the file, line and what is wrong: unreadable, no SUMO net, a lane without geometry, a
    /// connection to nowhere.
    pub fn read(_path: &Path) -> Result<Self> {
        todo!()
    }
}
