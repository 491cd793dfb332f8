//! The parts of a road network: edges, lanes, links between lanes, junctions.

use nalgebra::Point2;

use crate::util::units::Metre;

/// SUMO's default width of a lane in m.
pub(super) const LANE_WIDTH: Metre = 3.2;

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
