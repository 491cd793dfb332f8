//! A road network.

use nalgebra::Point2;
use rustc_hash::FxHashMap;
use typed_index_collections::TiVec;

use super::degrees::ToDegrees;
use super::elements::{
    Edge, EdgeFunction, EdgeIndex, Junction, JunctionIndex, Lane, LaneIndex, Location, Passage, Signal,
};
use super::finder::{Finder, distance, distance_beside};
use crate::geometry::polylines::{Lines, stretch};
use crate::geometry::{Bounds, Point};
use crate::util::units::{Degree, Metre};

/// A road network.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// All lanes, by [`LaneIndex`].
    pub lanes: TiVec<LaneIndex, Lane>,
    /// All edges, by [`EdgeIndex`].
    pub edges: TiVec<EdgeIndex, Edge>,
    /// All junctions.
    pub junctions: Vec<Junction>,
    /// The lanes' centre lines, by lane; their distances are SUMO's where a lane is longer or shorter than it is drawn.
    pub lines: Lines,
    /// Whether traffic keeps to the left, so that lanes are counted from the left: lane 0 is the leftmost.
    pub left_hand: bool,
    /// How its metres follow from degrees, if the file tells.
    pub location: Option<Location>,
    /// Degrees from metres, as [`Net::degrees`] has them.
    pub to_degrees: Option<ToDegrees>,
    /// The lanes by id.
    pub lane_ids: FxHashMap<String, LaneIndex>,
    /// The edges by id.
    pub edge_ids: FxHashMap<String, EdgeIndex>,
    /// Finds lanes by place.
    pub finder: Finder,
    /// By [`JunctionIndex`], the box around its outline; empty where the net has none.
    pub junction_bounds: TiVec<JunctionIndex, Bounds>,
    /// The ids of the traffic lights that its links name.
    pub lights: Vec<String>,
    /// The ways through its junctions.
    pub passages: Vec<Passage>,
    /// By lane, the passage that it is part of; [`NO_PASSAGE`] for others.
    pub passage_of: TiVec<LaneIndex, u32>,
    /// The lowest and the highest point of all lanes, in m.
    pub heights: [Metre; 2],
}

/// No [`Passage`].
pub const NO_PASSAGE: u32 = u32::MAX;

impl Net {
    /// The way through a junction that a lane is part of: a lane within a junction, or a crossing.
    pub fn passage(&self, lane: LaneIndex) -> Option<&Passage> {
        self.passages.get(*self.passage_of.get(lane)? as usize)
    }

    /// The signals within a distance of a place, each with the lane at whose end it stands; those of vehicles.
    pub(crate) fn signals_near(
        &self,
        place: Point2<Metre>,
        distance: Metre,
    ) -> impl Iterator<Item = (Signal, LaneIndex)> {
        let of_vehicles = self.passages.iter().filter(|passage| self.function(passage.from) == EdgeFunction::Normal);
        of_vehicles.filter_map(move |passage| {
            let end = self.lanes[passage.from].shape.last()?;
            Some((passage.signal?, passage.from)).filter(|_| (end - place).norm() <= distance)
        })
    }

    /// The purpose of a lane's edge.
    pub fn function(&self, lane: LaneIndex) -> EdgeFunction {
        self.edges[self.lanes[lane].edge].function
    }

    /// Whether `one` must yield to `to`, both through one junction, and not the other way round.
    pub fn yields(&self, one: &Passage, to: &Passage) -> bool {
        let junction = &self.junctions[one.junction as usize];
        one.junction == to.junction && junction.yields(one.link, to.link) && !junction.yields(to.link, one.link)
    }

    /// Whether it has crossings for persons.
    pub(crate) fn has_crossings(&self) -> bool {
        self.edges.iter().any(|edge| edge.function == EdgeFunction::Crossing)
    }

    /// The crossing of persons at a place, within this distance of it.
    pub fn crossing_at(&self, place: Point2<Metre>, within: Metre) -> Option<LaneIndex> {
        self.lane_of_persons_at(place, within, EdgeFunction::Crossing)
    }

    /// Whether a place is on a crossing of persons, and not before its ends, where they wait.
    pub(crate) fn is_on_crossing(&self, place: Point2<Metre>) -> bool {
        self.crossings_under(place).next().is_some()
    }

    /// Whether a place is on a crossing, further from its ends than `kerb`, or than a quarter of a short one.
    pub(crate) fn is_within_crossing(&self, place: Point2<Metre>, kerb: Metre) -> bool {
        self.crossings_under(place).any(|lane| {
            let Some((first, last)) = lane.shape.first().zip(lane.shape.last()) else { return false };
            let length = (last - first).norm();
            let passed = (place - first).dot(&(last - first)) / length.max(f64::MIN_POSITIVE);
            let kerb = kerb.min(length / 4.0);
            (kerb..=length - kerb).contains(&passed)
        })
    }

    fn crossings_under(&self, place: Point2<Metre>) -> impl Iterator<Item = &Lane> {
        let lanes = self.finder.lanes_at(&self.lanes, place, 0.0);
        let crossings = lanes.filter(|lane| self.function(*lane) == EdgeFunction::Crossing);
        let crossings = crossings.map(|lane| &self.lanes[lane]);
        crossings.filter(move |lane| distance_beside(&lane.shape, place) <= lane.width / 2.0)
    }

    /// Whether persons have a crossing, or the area where they wait for it, at a place or within this distance of it.
    pub(crate) fn is_for_persons(&self, place: Point2<Metre>, within: Metre) -> bool {
        [EdgeFunction::Crossing, EdgeFunction::WalkingArea]
            .into_iter()
            .any(|function| self.lane_of_persons_at(place, within, function).is_some())
    }

    fn lane_of_persons_at(&self, place: Point2<Metre>, within: Metre, of: EdgeFunction) -> Option<LaneIndex> {
        self.finder.lanes_at(&self.lanes, place, within).find(|lane| self.function(*lane) == of)
    }

    /// Whether a place is on, or within a distance of, a pavement or an area where persons wait: where no vehicle drives.
    pub(crate) fn is_off_the_road(&self, place: Point2<Metre>, within: Metre) -> bool {
        let is_pavement =
            |lane: LaneIndex| self.function(lane) == EdgeFunction::Normal && !self.lanes[lane].has_vehicles;
        self.finder.lanes_at(&self.lanes, place, within).any(is_pavement) || self.walking_area_at(place).is_some()
    }

    /// The lane of an edge with the centre line nearest to a place.
    pub(crate) fn lane_of_edge_at(&self, edge: EdgeIndex, place: Point2<Metre>) -> Option<LaneIndex> {
        let away = |lane: LaneIndex| distance(&self.lanes[lane], place);
        let lanes = self.edges[edge].lanes.iter().copied();
        lanes.min_by(|one, other| away(*one).total_cmp(&away(*other)))
    }

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

    /// The lanes that a place is on, or within a distance of, in no particular order.
    pub fn lanes_at(&self, place: Point2<Metre>, within: Metre) -> impl Iterator<Item = LaneIndex> {
        self.finder.lanes_at(&self.lanes, place, within)
    }

    /// The length of a lane's shape.
    pub(crate) fn drawn_length(&self, lane: LaneIndex) -> Metre {
        let line = self.lines.line(lane.0);
        line.windows(2).map(|ends| (ends[1].point - ends[0].point).norm()).sum()
    }

    /// How many metres of SUMO's a metre of a lane's shape is; 1 for a lane whose length is that of its shape.
    pub fn stretch(&self, lane: LaneIndex) -> f64 {
        if self.lines.is_stretched() { stretch(self.lines.length(lane.0), self.drawn_length(lane)) } else { 1.0 }
    }

    /// Longitude and latitude of a place; none where the net does not tell, or its projection is not supported.
    pub fn degrees(&self, place: Point) -> Option<[Degree; 2]> {
        self.to_degrees.as_ref()?.of(place)
    }

    /// The height of its highest point above its lowest; 0 for a net without heights, as most imported ones are.
    pub(crate) fn rise(&self) -> Metre {
        (self.heights[1] - self.heights[0]).max(0.0)
    }

    /// Whether a place is within a distance of a junction; true where the net has no outline of it.
    pub fn is_near(&self, junction: JunctionIndex, place: Point2<Metre>, distance: Metre) -> bool {
        let bounds = &self.junction_bounds[junction];
        bounds.is_empty() || bounds.grown(distance).meet(&Bounds { low: place, high: place })
    }
    /// The id of a lane.
    pub fn lane_id(&self, lane: LaneIndex) -> &str {
        &self.lanes[lane].id
    }
}
