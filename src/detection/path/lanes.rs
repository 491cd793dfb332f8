//! Path along the lanes of the route, with the current lateral offset.
//!
//! A `LanePath` is built when a road user first needs a path or has left the one it had (a lane change, another
//! route). From then on it is followed, and extended ahead. Behind the front bumper it runs over the lanes that the
//! vehicle came from, since the rear is still on them. Where no lane leads to the next edge of the route, the path ends
//! with the lane.

use std::sync::Arc;

use smallvec::SmallVec;

use super::foot::Foot;
use super::lateral_offset::{Movement, Offset, OffsetLine};
use super::next_lane::{edge_of, is_on_route, next_link};
use super::own_line::OwnLine;
use super::route::RouteAhead;
use super::track::Track;
use crate::geometry::polylines::{Lines, Vertex};
use crate::geometry::{Point, Vector};
use crate::traffic::net::{EdgeIndex, LaneIndex, Net};
use crate::traffic::placement::Placement;
use crate::util::units::{Metre, MetrePerSecond, Second};

/// A path is built this much longer than needed, in m, so that it is not extended in every step.
const SPARE: Metre = 30.0;
/// Lanes further behind the rear bumper than this are removed, in m.
pub(crate) const KEPT_BEHIND: Metre = 5.0;
/// A rear that fits straight behind better than a lane by this is on no lane, in m.
const BEND: Metre = 0.1;

/// The path of one road user along its lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct LanePath {
    /// Its place on the lanes' centre lines, or on its own line.
    pub track: Track,
    own: Option<Box<OwnLine>>,
    /// The route from the edge on that it was on when the path was built.
    route: RouteAhead,
    /// Which edge of `route` the last lane is on, or was on when the path left the route; none if the road user drives
    /// against its lane, whose path does not go on.
    edge: Option<usize>,
    /// How far its front bumper was moved back since it last was followed.
    moved_back: Metre,
    /// How far its front bumper moved along it when it was last followed; none since it was built.
    driven: Option<Metre>,
}

/// What a path starts from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathStart {
    /// Front-bumper centre.
    pub front: Point,
    /// Unit vector of the heading.
    pub axis: Vector,
    /// Length in m of the part whose direction the heading is.
    pub chord: Metre,
    /// Length of the road user in m.
    pub length: Metre,
    /// How much further back the path is needed, in m.
    pub distance_back: Metre,
    /// Its width in m.
    pub width: Metre,
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// Whether it may move to the side without changing lanes (SUMO's sublane model).
    pub sublane: bool,
    /// How long a step takes, in s.
    pub step: Second,
}

impl LanePath {
    /// Removes the path.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The lines that its track runs over: those of the net's lanes, unless it has one of its own.
    pub fn lines<'a>(&'a self, of_net: &'a Lines) -> &'a Lines {
        self.own.as_ref().map_or(of_net, |own| &own.lines)
    }

    /// Updates the place of the front bumper, which has driven at most this far; `false` if it has left the path.
    pub fn follow(&mut self, of_net: &Lines, front: Point, driven: Metre) -> bool {
        let lines = self.own.as_ref().map_or(of_net, |own| &own.lines);
        let moved_back = std::mem::take(&mut self.moved_back);
        if moved_back > 0.0 {
            self.track.move_on(lines, moved_back);
        }
        let ahead = self.track.ahead();
        let follows = self.track.follow(lines, front, driven);
        self.driven = follows.then(|| (ahead - self.track.ahead()).max(0.0));
        follows
    }

    /// How far the front bumper moved along it in the last step; none if the path was built since.
    pub fn driven(&self) -> Option<Metre> {
        self.driven
    }

    /// Moves the front bumper on.
    pub(crate) fn move_on(&mut self, of_net: &Lines, distance: Metre) {
        self.track.move_on(self.own.as_ref().map_or(of_net, |own| &own.lines), distance);
    }

    /// Moves the front bumper back.
    pub(crate) fn move_back(&mut self, of_net: &Lines, distance: Metre) {
        self.moved_back = distance;
        self.track.move_back(self.own.as_ref().map_or(of_net, |own| &own.lines), distance);
    }

    /// Whether it knows the route from this position on.
    pub fn knows_route(&self, position: usize) -> bool {
        !self.route.is_free() && self.route.begins_before(position)
    }

    /// Whether it was built for this route from this position on.
    pub(crate) fn is_for(&self, net: &Net, route: &Arc<[EdgeIndex]>, position: usize) -> bool {
        self.route.is_same(net, route, position)
    }

    /// Builds the path; it stays empty where the lane has no geometry.
    pub fn build(&mut self, net: &Net, start: &PathStart, placement: &Placement) {
        let lane = &net.lanes[placement.lane];
        let line = net.lines.line(placement.lane.0);
        let length = net.lines.length(placement.lane.0);
        let hint = placement.position * length / lane.length.max(f64::MIN_POSITIVE);
        let foot = Foot::of(line, start.front, hint);
        match &placement.route {
            Some(route) => self.route = RouteAhead::new(net, route, placement.route_position),
            None => self.route.advance(placement.route_position),
        }
        // On a lane of its route a road user drives along the lane whatever its heading: after a sharp turn the rear
        // still stands across, and the heading with it.
        let against = foot.direction.dot(&start.axis) < 0.0 && !is_on_route(net, lane, self.route.edges());
        let before = self.lateral_speed();
        let beside = OffsetLine::new(offset(net, start, placement, before, &foot, against));
        let before =
            if against { SmallVec::new() } else { lanes_behind(net, placement.lane, &foot, start, &self.route) };
        let joins =
            before.iter().try_fold(placement.lane.0, |next, lane| net.lines.join(lane.0, next).then_some(lane.0));
        self.own = None;
        self.driven = None;
        if !against && beside.is_none() && line.len() > 1 && joins.is_some() {
            self.track.begin(&net.lines, placement.lane.0, foot.distance);
            before.iter().for_each(|lane| self.track.prepend(lane.0));
        } else {
            let points = |vertices: &[Vertex]| vertices.iter().map(|vertex| vertex.point).collect::<Vec<_>>();
            let mut behind = points(&line[..=foot.segment]);
            let mut ahead = points(&line[foot.segment + 1..]);
            if against {
                ahead.reverse();
                behind.reverse();
                std::mem::swap(&mut behind, &mut ahead);
            }
            let (lane, stretch) = (placement.lane, net.stretch(placement.lane));
            let before = before.iter().rev().flat_map(|lane| {
                let stretch = net.stretch(*lane);
                points(net.lines.line(lane.0)).into_iter().map(move |point| (point, stretch))
            });
            let behind = before.chain(behind.into_iter().map(|point| (point, stretch)));
            let own = OwnLine::build(&mut self.track, behind, foot.point, ahead, (lane, stretch), beside);
            self.own = Some(Box::new(own));
        }
        self.edge = (!against).then_some(0);
        self.remove_behind(net, start.length + start.distance_back + KEPT_BEHIND);
        self.shrink();
    }

    /// Begins a path that follows no lanes with the points behind the front bumper and where that is.
    pub(super) fn begin_driven(&mut self, behind: impl Iterator<Item = Point>, front: Point) {
        (self.moved_back, self.driven) = (0.0, None);
        self.own.get_or_insert_default().begin(&mut self.track, behind, front);
    }

    /// Extends such a path to a point.
    pub(super) fn drive_to(&mut self, point: Point) {
        if let Some(own) = &mut self.own {
            own.extend(&mut self.track, point);
        }
    }

    /// Extends such a path straight on to a distance ahead of the front bumper: as its end leads, or as the heading is if it
    /// ends there.
    pub(super) fn drive_on(&mut self, axis: Vector, distance: Metre) {
        let ahead = self.track.ahead();
        let end = self.own.as_ref().and_then(|own| own.end());
        if let Some((point, direction)) = end {
            let direction = if ahead > 0.0 { direction } else { axis };
            self.drive_to(point + direction * (distance - ahead));
        }
    }

    /// Extends the path to at least a distance ahead of the front bumper, if the route goes that far, and removes what
    /// lies behind the rear bumper.
    pub fn extend(&mut self, net: &Net, length: Metre, distance: Metre) {
        if self.track.ahead() >= distance || self.track.is_empty() {
            return;
        }
        self.remove_behind(net, length + KEPT_BEHIND);
        // A ring of lanes of length 0 would never end.
        let mut in_vain = 0;
        while self.track.ahead() < distance + SPARE && in_vain <= net.lanes.len() {
            let Some((lane, edge)) = self.next(net) else { break };
            let before = self.track.ahead();
            self.append(net, lane);
            self.edge = Some(edge);
            in_vain = if self.track.ahead() > before { 0 } else { in_vain + 1 };
        }
        self.shrink();
    }

    /// The lane at a distance ahead of the front bumper.
    pub fn lane_at(&self, of_net: &Lines, distance: Metre) -> Option<LaneIndex> {
        let track = Some(&self.track).filter(|track| !track.is_empty())?;
        let (vertex, line) = track.vertex_ahead(self.lines(of_net), distance);
        self.own.as_ref().map_or(Some(LaneIndex(line)), |own| own.lane_at(vertex))
    }

    /// The lane that the front bumper is on.
    pub fn lane(&self) -> Option<LaneIndex> {
        match &self.own {
            Some(own) => own.lane_at(self.track.vertex).filter(|_| !self.track.is_empty()),
            None => self.track.lines.get(self.track.at).map(|line| LaneIndex(*line)),
        }
    }

    /// The lanes between two distances ahead of the front bumper; those behind it have negative distances.
    pub(crate) fn lanes_between(&self, of_net: &Lines, from: Metre, to: Metre) -> SmallVec<[LaneIndex; 4]> {
        let mut found = SmallVec::new();
        self.each_lane(of_net, |lane, [begin, end]| {
            if begin <= to && end >= from {
                found.push(lane);
            }
        });
        found
    }

    /// Calls `each` with its lanes in driving order, and the distances ahead of the front bumper at which each begins and
    /// ends.
    pub(crate) fn each_lane(&self, of_net: &Lines, mut each: impl FnMut(LaneIndex, [Metre; 2])) {
        let mut begin = -self.track.front();
        match &self.own {
            Some(own) => own.lanes().for_each(|(lane, [first, last])| each(lane, [begin + first, begin + last])),
            None => {
                begin -= self.track.passed(of_net);
                for line in self.track.lines.iter() {
                    let end = begin + of_net.length(*line);
                    each(LaneIndex(*line), [begin, end]);
                    begin = end;
                }
            }
        }
    }

    /// Whether it leads against the direction of its lane.
    pub fn is_against(&self) -> bool {
        self.edge.is_none() && !self.track.is_empty() && self.own.as_ref().is_none_or(|own| own.last().is_some())
    }

    /// The lateral speed with which it was begun, positive to the left.
    pub fn lateral_speed(&self) -> MetrePerSecond {
        self.own.as_ref().map_or(0.0, |own| own.lateral_speed())
    }

    /// How far beside the lanes' centre line it runs, in m; positive to the left.
    pub fn aside(&self) -> Metre {
        self.own.as_ref().map_or(0.0, |own| own.aside())
    }

    fn append(&mut self, net: &Net, lane: LaneIndex) {
        let track = &mut self.track;
        if self.own.is_none() && track.lines.last().is_some_and(|last| net.lines.join(*last, lane.0)) {
            return track.append(&net.lines, lane.0);
        }
        self.own.get_or_insert_with(|| Box::new(OwnLine::copy_of(net, track))).append(net, track, lane);
    }

    /// Removes what lies further behind the front bumper than this.
    fn remove_behind(&mut self, net: &Net, behind: Metre) {
        match &mut self.own {
            Some(own) => own.remove_behind(&mut self.track, behind),
            None => self.track.remove_behind(&net.lines, behind),
        }
    }

    /// Frees unused memory.
    fn shrink(&mut self) {
        if let Some(own) = &mut self.own {
            own.shrink();
        }
    }

    /// The lane after the last one, and the edge of the route that it is on.
    fn next(&self, net: &Net) -> Option<(LaneIndex, usize)> {
        let last = match &self.own {
            Some(own) => own.last()?,
            None => LaneIndex(*self.track.lines.last()?),
        };
        let edge = self.edge?;
        let ahead = self.route.edges().get(edge + 1..).unwrap_or_default();
        let link = next_link(net, last, ahead, self.route.is_free())?;
        Some(match link.via {
            Some(via) => (via, edge),
            None => (link.to, edge + usize::from(ahead.first() == Some(&edge_of(net, link.to)))),
        })
    }
}

/// The current offset, and where a lateral movement leads; `before` is the lateral speed that it had before.
fn offset(
    net: &Net,
    start: &PathStart,
    placement: &Placement,
    before: MetrePerSecond,
    foot: &Foot,
    against: bool,
) -> Offset {
    let sign = if against { -1.0 } else { 1.0 };
    let towards_higher_lanes = if net.left_hand { -1.0 } else { 1.0 };
    Offset::of(&Movement {
        now: sign * if foot.aside.abs() < 1e-3 { 0.0 } else { foot.aside },
        speed: sign * towards_higher_lanes * placement.lateral_speed,
        before,
        ahead: start.speed / net.stretch(placement.lane),
        width: start.width,
        lane_width: net.lanes[placement.lane].width,
        leads_to_a_lane: leads_to_a_lane(net, placement.lane, placement.lateral_speed),
        sublane: start.sublane,
        step: start.step,
    })
}

/// Whether the edge has another lane on that side.
fn leads_to_a_lane(net: &Net, lane: LaneIndex, towards_higher_lanes: MetrePerSecond) -> bool {
    let lane = &net.lanes[lane];
    let last = net.edges[lane.edge].lanes.len() as u32;
    if towards_higher_lanes > 0.0 { lane.index + 1 < last } else { lane.index > 0 }
}

/// The lanes behind that of the front bumper, nearest first, as far as [`KEPT_BEHIND`] behind the rear bumper. Of several that
/// lead here, it came over the nearest to the rear of the part whose heading is known, or over none if it stands straight: SUMO
/// has inserted it before the lane's begin. Further behind, its route decides.
fn lanes_behind(
    net: &Net,
    lane: LaneIndex,
    foot: &Foot,
    start: &PathStart,
    route: &RouteAhead,
) -> SmallVec<[LaneIndex; 4]> {
    let needed = start.length + start.distance_back + KEPT_BEHIND;
    let rear = start.front - start.axis * start.chord;
    let mut lanes = SmallVec::new();
    let mut covered = foot.distance;
    let mut current = lane;
    while covered < needed {
        let distance = |lane: LaneIndex| {
            if covered >= start.chord {
                return if route.has_passed(net, lane) { 0.0 } else { 1.0 };
            }
            let distance = net.lines.length(lane.0) - (start.chord - covered);
            (rear - Foot::of(net.lines.line(lane.0), rear, distance).point).norm()
        };
        let from = net.lanes[current].from.iter().copied();
        let before = from.min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let Some(before) = before else { break };
        let back = (covered < start.chord).then(|| straight_back(net, current, start.chord - covered)).flatten();
        if back.is_some_and(|back| (rear - back).norm() + BEND < distance(before)) {
            break;
        }
        lanes.push(before);
        // A ring of lanes of length 0 would never end.
        covered += net.lines.length(before.0).max(0.1);
        current = before;
    }
    lanes
}

/// The place at a distance straight behind the begin of a lane; none if the lane has no length.
fn straight_back(net: &Net, lane: LaneIndex, distance: Metre) -> Option<Point> {
    let (begin, end) = net.lines.range(lane.0);
    (end - begin > 1).then(|| net.lines.segment(begin)).map(|first| first.at(first.begins_at - distance))
}
