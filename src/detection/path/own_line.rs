//! A line of a road user's own: beside the lanes' centre lines, against their direction, or over lanes that do not
//! join.

use super::lateral_offset::OffsetLine;
use super::track::Track;
use crate::geometry::polylines::{Lines, Vertex};
use crate::geometry::{Point, Vector};
use crate::traffic::net::{LaneIndex, Net};
use crate::util::units::{Metre, MetrePerSecond};

/// One line, and the lanes that it follows.
#[derive(Clone, Debug, Default)]
pub(super) struct OwnLine {
    /// One line.
    pub lines: Lines,
    /// Each lane, with the first vertex that is on it.
    lanes: Vec<(u32, LaneIndex)>,
    /// None if the line follows the lanes' centre line.
    beside: Option<OffsetLine>,
}

/// The number of the line in its own table.
const LINE: u32 = 0;

impl OwnLine {
    /// A line over points of the lanes' centre lines: those behind, each with the stretch of its lane, the one beside the
    /// front bumper (`foot`), those ahead.
    pub fn build(
        track: &mut Track,
        behind: impl Iterator<Item = (Point, f64)>,
        foot: Point,
        ahead: Vec<Point>,
        (lane, stretch): (LaneIndex, f64),
        beside: Option<OffsetLine>,
    ) -> Self {
        let mut own = Self { lines: Lines::through([]), lanes: Vec::new(), beside };
        for (point, stretch) in behind {
            own.set_stretch(stretch);
            match &mut own.beside {
                Some(beside) => beside.push_behind(&mut own.lines, point),
                None => own.lines.push(point),
            }
        }
        own.set_stretch(stretch);
        match &mut own.beside {
            Some(beside) => beside.push_front(&mut own.lines, foot),
            None => own.lines.push(foot),
        }
        own.begin_lane(lane, stretch);
        let front = own.lines.length(LINE);
        own.push_ahead(ahead.into_iter());
        track.clear();
        if own.lines.len() > 1 {
            track.begin(&own.lines, LINE, front);
        }
        own
    }

    /// A line through the points behind a front bumper, and through it.
    pub fn begin(&mut self, track: &mut Track, behind: impl Iterator<Item = Point>, front: Point) {
        self.lines.restart();
        behind.for_each(|point| self.lines.push(point));
        self.lines.push(front);
        track.begin(&self.lines, LINE, self.lines.length(LINE));
    }

    /// Extends a line that follows no lanes to a point.
    pub fn extend(&mut self, track: &mut Track, point: Point) {
        self.lines.push(point);
        track.begin(&self.lines, LINE, track.front());
    }

    /// The point and the direction of its end.
    pub fn end(&self) -> Option<(Point, Vector)> {
        let [.., before, end] = self.lines.line(LINE) else { return None };
        Some((end.point, (end.point - before.point).normalize()))
    }

    /// A copy of the lines of a track.
    pub(crate) fn copy_of(net: &Net, track: &mut Track) -> Self {
        let mut own = Self { lines: Lines::through([]), ..Self::default() };
        let mut front = track.front();
        for (place, line) in (0..).zip(&track.lines) {
            own.begin_lane(LaneIndex(*line), net.stretch(LaneIndex(*line)));
            own.push_ahead(net.lines.line(*line).iter().map(|vertex| vertex.point));
            front += if place < track.at { net.lines.length(*line) } else { 0.0 };
        }
        track.begin(&own.lines, LINE, front);
        own
    }

    /// Appends a lane.
    pub fn append(&mut self, net: &Net, track: &mut Track, lane: LaneIndex) {
        let line = net.lines.line(lane.0);
        self.lines.reserve(line.len());
        self.begin_lane(lane, net.stretch(lane));
        self.push_ahead(line.iter().map(|vertex| vertex.point));
        track.begin(&self.lines, LINE, track.front());
    }

    /// Removes what lies further behind the front bumper than this.
    pub fn remove_behind(&mut self, track: &mut Track, behind: Metre) {
        let vertices = self.lines.line(LINE);
        let is_behind = |vertex: &Vertex| vertex.distance <= track.front() - behind;
        let removed = vertices.partition_point(is_behind).saturating_sub(1);
        let front = track.front() - self.lines.cut(removed);
        for (vertex, _) in &mut self.lanes {
            *vertex = vertex.saturating_sub(removed as u32);
        }
        let lanes = self.lanes.partition_point(|(vertex, _)| *vertex == 0).saturating_sub(1);
        self.lanes.drain(..lanes);
        if !track.is_empty() {
            track.begin(&self.lines, LINE, front);
        }
    }

    /// Frees unused memory.
    pub fn shrink(&mut self) {
        self.lines.shrink();
        self.lanes.shrink_to_fit();
    }

    /// The last lane.
    pub fn last(&self) -> Option<LaneIndex> {
        self.lanes.last().map(|(_, lane)| *lane)
    }

    /// The lanes, each with the distances at which it begins and ends.
    pub fn lanes(&self) -> impl Iterator<Item = (LaneIndex, [Metre; 2])> {
        let vertices = self.lines.line(LINE);
        let at = |vertex: u32| vertices.get(vertex as usize).map_or(0.0, |vertex| vertex.distance);
        let ends = self.lanes.iter().skip(1).map(|(first, _)| *first).chain([vertices.len().saturating_sub(1) as u32]);
        self.lanes.iter().zip(ends).map(move |((first, lane), end)| (*lane, [at(*first), at(end)]))
    }

    /// How far beside the centre line the front bumper was when the line was begun, positive to the left.
    pub fn aside(&self) -> Metre {
        self.beside.as_ref().map_or(0.0, OffsetLine::aside)
    }

    /// The lateral speed when the line was begun, positive to the left.
    pub fn lateral_speed(&self) -> MetrePerSecond {
        self.beside.as_ref().map_or(0.0, OffsetLine::speed)
    }

    /// The lane at a vertex.
    pub fn lane_at(&self, vertex: u32) -> Option<LaneIndex> {
        let index = self.lanes.partition_point(|(first, _)| *first <= vertex).saturating_sub(1);
        self.lanes.get(index).map(|(_, lane)| *lane)
    }

    /// Records that the line continues on this lane, a metre of whose shape is `stretch` metres of SUMO's.
    fn begin_lane(&mut self, lane: LaneIndex, stretch: f64) {
        if let Some(beside) = &mut self.beside {
            beside.flush(&mut self.lines);
        }
        self.lines.set_stretch(stretch);
        self.lanes.push((self.lines.len().saturating_sub(1) as u32, lane));
    }

    /// Sets how many metres of SUMO's a metre of the centre line is, for the points that follow.
    fn set_stretch(&mut self, stretch: f64) {
        if self.lines.stretch() == stretch {
            return;
        }
        if let Some(beside) = &mut self.beside {
            beside.flush(&mut self.lines);
        }
        self.lines.set_stretch(stretch);
    }

    /// Appends points of the centre line.
    fn push_ahead(&mut self, points: impl Iterator<Item = Point>) {
        match &mut self.beside {
            Some(beside) => {
                points.for_each(|point| beside.push_ahead(&mut self.lines, point));
                beside.flush(&mut self.lines);
            }
            None => points.for_each(|point| self.lines.push(point)),
        }
    }
}
