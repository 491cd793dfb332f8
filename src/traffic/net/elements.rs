//! The parts of a road network: edges, lanes, links between lanes, junctions.

use ecow::EcoString;
use nalgebra::Point2;
use smallvec::SmallVec;

use crate::geometry::{Bounds, Vector};
use crate::util::index::index_tables;
use crate::util::units::{Metre, MetrePerSecond};

/// SUMO's default width of a lane in m.
pub const USUAL_WIDTH: Metre = 3.2;

/// The index of a lane in a net.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LaneIndex(pub u32);

/// The index of an edge in a net.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeIndex(pub u32);

/// The index of a junction among those that edges begin or end at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JunctionIndex(pub u32);

index_tables!(LaneIndex, EdgeIndex, JunctionIndex);

/// The purpose of an edge (SUMO's attribute `function`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeFunction {
    /// A road between junctions.
    Normal,
    /// Lanes within a junction.
    Internal,
    /// A pedestrian crossing.
    Crossing,
    /// Connects pedestrian crossings and sidewalks.
    WalkingArea,
    /// A macroscopic connector.
    Connector,
}

/// One edge.
#[derive(Clone, Debug)]
pub struct Edge {
    /// SUMO's id.
    pub id: String,
    /// The name of its street; empty where the net has none.
    pub street: EcoString,
    /// Its purpose.
    pub function: EdgeFunction,
    /// Its lanes, from right to left.
    pub lanes: Vec<LaneIndex>,
    /// The junction that it belongs to (internal edges, crossings, walking areas) or leads to.
    pub junction: String,
    /// The junctions at which it begins and ends; the same one for an edge within a junction.
    pub ends: [JunctionIndex; 2],
}

/// A link from a lane to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The lane of the next normal edge.
    pub to: LaneIndex,
    /// The first junction lane between the two; none if they join directly.
    pub via: Option<LaneIndex>,
}

/// One lane.
#[derive(Clone, Debug)]
pub struct Lane {
    /// SUMO's id.
    pub id: String,
    /// Its edge.
    pub edge: EdgeIndex,
    /// Its index on the edge, 0 at the right.
    pub index: u32,
    /// SUMO's length in m, which lane positions refer to; it may differ from the length of the shape.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// Speed limit in m/s; infinite where the file has none.
    pub speed: MetrePerSecond,
    /// Whether vehicles use it: no sidewalk, and not closed to all.
    pub has_vehicles: bool,
    /// The centre line, at least two points.
    pub shape: Vec<Point2<Metre>>,
    /// Its links. A junction lane in two parts leads to its second part (`via`), then to the edge.
    pub links: Vec<Link>,
    /// The lanes that lead here directly (for a lane behind a junction: the junction lanes).
    pub from: Vec<LaneIndex>,
}

impl Lane {
    /// The bounds of its centre line.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        self.shape.iter().for_each(|point| bounds.include(*point));
        bounds
    }
}

/// Where a link leads, seen from the lane that it begins at (SUMO's attribute `dir`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Straight on, or slightly to a side.
    Straight,
    /// To the left.
    Left,
    /// To the right.
    Right,
    /// Back.
    Around,
}

/// The place of a link in the states of a traffic light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// The traffic light, in the net's list.
    pub light: u32,
    /// SUMO's `linkIndex`.
    pub index: u32,
}

/// A way through a junction: a link with its lanes there, or a crossing of persons.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// The junction, in the net's list.
    pub junction: u32,
    /// The link's number in the junction's right of way.
    pub link: u32,
    /// The lane before the junction; the crossing itself.
    pub from: LaneIndex,
    /// The lane behind the junction; the crossing itself.
    pub to: LaneIndex,
    /// Where it leads.
    pub direction: Direction,
    /// Its traffic light, if it has one.
    pub signal: Option<Signal>,
    /// Its lanes within the junction, in driving order: two where one waits in the junction, between them.
    pub lanes: SmallVec<[LaneIndex; 2]>,
}

/// One junction.
#[derive(Clone, Debug)]
pub struct Junction {
    /// SUMO's id.
    pub id: String,
    /// Its outline.
    pub shape: Vec<Point2<Metre>>,
    /// By link through it: the last of the link's junction lanes.
    pub link_lanes: Vec<Option<LaneIndex>>,
    /// By link through it: SUMO's attribute `foes`, a digit for each link, the first link last.
    pub foes: Vec<Box<str>>,
    /// By link through it: SUMO's attribute `response`, the links that it yields to, in the same form.
    pub responses: Vec<Box<str>>,
}

impl Junction {
    /// Whether two links cross or merge, so that one of them yields.
    pub fn are_foes(&self, one: u32, other: u32) -> bool {
        has_digit(&self.foes, one, other) || has_digit(&self.foes, other, one)
    }

    /// Whether a link crosses or merges with any other.
    pub(crate) fn has_foes(&self, link: u32) -> bool {
        self.foes.get(link as usize).is_some_and(|row| row.contains('1'))
    }

    /// Whether a link has to yield to any other.
    pub fn has_to_yield(&self, link: u32) -> bool {
        self.responses.get(link as usize).is_some_and(|row| row.contains('1'))
    }

    /// Whether a link has to yield to another.
    pub fn yields(&self, link: u32, to: u32) -> bool {
        has_digit(&self.responses, link, to)
    }
}

/// Whether the row of a link has a 1 for another link.
fn has_digit(rows: &[Box<str>], of: u32, link: u32) -> bool {
    let digits = rows.get(of as usize).map_or(&[][..], |row| row.as_bytes());
    digits.iter().rev().nth(link as usize) == Some(&b'1')
}

/// How the net's metres follow from degrees of longitude and latitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    /// Added to what the projection gives, in m.
    pub offset: Vector,
    /// SUMO's `projParameter`: a PROJ string, "-" for its simple projection, "!" for none.
    pub projection: String,
}
