//! A line of a road user's own: of who drives beside the lanes' centre lines, against their direction, or over lanes that do
//! not join.

use super::beside::Beside;
use super::track::Track;
use crate::geometry::Point;
use crate::geometry::polylines::{Corner, Lines};
use crate::traffic::net::{LaneIndex, Net};
use crate::util::units::Metre;

/// The line, and which lanes it follows.
#[derive(Clone, Debug, Default)]
pub(super) struct Own {
    /// One line.
    pub lines: Lines,
    /// On which lane it is from which of its corners on.
    lanes: Vec<(u32, LaneIndex)>,
    /// None on the lanes' centre line.
    beside: Option<Beside>,
}

/// Its number in its own table.
const LINE: u32 = 0;

impl Own {
    /// A line that comes over these points of the lanes' centre lines to the one next to the front bumper, on this lane.
    pub fn lay(
        track: &mut Track,
        behind: impl Iterator<Item = Point>,
        foot: Point,
        ahead: Vec<Point>,
        lane: LaneIndex,
        beside: Option<Beside>,
    ) -> Self {
        let mut own = Self { lines: Lines::through([]), lanes: Vec::new(), beside };
        let lines = &mut own.lines;
        match &mut own.beside {
            Some(beside) => {
                behind.for_each(|point| beside.push_behind(lines, point));
                beside.push_front(lines, foot);
            }
            None => behind.chain([foot]).for_each(|point| lines.push(point)),
        }
        own.begin_lane(lane);
        let front = own.lines.length(LINE);
        own.push_ahead(ahead.into_iter());
        track.clear();
        if own.lines.len() > 1 {
            track.begin(&own.lines, LINE, front);
        }
        own
    }

    /// The line that a track has so far, along these lanes.
    pub fn along(net: &Net, track: &mut Track) -> Self {
        let mut own = Self { lines: Lines::through([]), ..Self::default() };
        let mut front = track.front();
        for (place, line) in (0..).zip(&track.lines) {
            own.begin_lane(LaneIndex(*line));
            own.push_ahead(net.lines.line(*line).iter().map(|corner| corner.point));
            front += if place < track.at { net.lines.length(*line) } else { 0.0 };
        }
        track.begin(&own.lines, LINE, front);
        own
    }

    /// Goes on along this lane.
    pub fn go_on(&mut self, net: &Net, track: &mut Track, lane: LaneIndex) {
        let line = net.lines.line(lane.0);
        self.lines.reserve(line.len());
        self.begin_lane(lane);
        self.push_ahead(line.iter().map(|corner| corner.point));
        track.begin(&self.lines, LINE, track.front());
    }

    /// Forgets what lies further behind the front bumper than this.
    pub fn forget_behind(&mut self, track: &mut Track, behind: Metre) {
        let corners = self.lines.line(LINE);
        let is_behind = |corner: &Corner| corner.way <= track.front() - behind;
        let forgotten = corners.partition_point(is_behind).saturating_sub(1);
        let front = track.front() - self.lines.cut(forgotten);
        for (corner, _) in &mut self.lanes {
            *corner = corner.saturating_sub(forgotten as u32);
        }
        let lanes = self.lanes.partition_point(|(corner, _)| *corner == 0).saturating_sub(1);
        self.lanes.drain(..lanes);
        if track.is_laid() {
            track.begin(&self.lines, LINE, front);
        }
    }

    /// Gives back what memory is not needed.
    pub fn shrink(&mut self) {
        self.lines.shrink();
        self.lanes.shrink_to_fit();
    }

    /// The last lane.
    pub fn last(&self) -> Option<LaneIndex> {
        self.lanes.last().map(|(_, lane)| *lane)
    }

    /// The lane at a corner of the line.
    pub fn lane_at(&self, corner: u32) -> Option<LaneIndex> {
        let index = self.lanes.partition_point(|(first, _)| *first <= corner).saturating_sub(1);
        self.lanes.get(index).map(|(_, lane)| *lane)
    }

    /// From the end of the line on it is on this lane.
    fn begin_lane(&mut self, lane: LaneIndex) {
        if let Some(beside) = &self.beside {
            beside.flush(&mut self.lines);
        }
        self.lanes.push((self.lines.len().saturating_sub(1) as u32, lane));
    }

    /// The line along these points of the centre line.
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
