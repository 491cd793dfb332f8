//! Along the lanes of its route, its lateral offset kept.
//!
//! A [`LanePath`] is laid when a road user first needs a path or has left the one it had (a lane change, another
//! route); from then on it is followed, and lengthened ahead. Behind the front bumper it runs over the lanes that
//! the vehicle came from, since the rear drives there still. Where the lane does not lead to the next edge of the
//! route, the path ends with the lane.

use smallvec::SmallVec;

use super::beside::{Beside, Offset};
use super::own::Own;
use super::track::Track;
use super::turns::RouteTurns;
use crate::geometry::polylines::{Corner, Lines};
use crate::geometry::{Point, Vector, cross};
use crate::traffic::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};
use crate::traffic::placement::Placement;
use crate::util::units::{Metre, MetrePerSecond};

/// A path is laid this much further than it is needed, so that it is lengthened now and then, not in every step; m.
const SPARE: Metre = 30.0;
/// What lies further behind the rear bumper is forgotten, in m.
const KEPT_BEHIND: Metre = 5.0;
/// A front bumper this far from its lane's position hint is looked for on the whole lane, in m.
const NEAR_HINT: Metre = 5.0;
/// How many edges ahead lanes are compared by how far they lead along the route.
const EDGES_AHEAD: usize = 8;
/// A lateral speed below this is a vehicle that keeps its offset, in m/s.
const KEEPS_OFFSET: MetrePerSecond = 0.01;
/// Who drifts within its lane stays this far off the border, in m: more than sweeping may err.
const OFF_THE_BORDER: Metre = 0.05;

/// The path of one road user along its lanes.
#[derive(Clone, Debug, Default)]
pub struct LanePath {
    /// Where it is on the lanes' centre lines, or on its own line.
    pub track: Track,
    own: Option<Box<Own>>,
    /// From the edge on it was on when the path was laid.
    route: RouteTurns,
}

/// The edge of who drives against its lane: its path does not go on.
const NONE: u16 = u16::MAX;

/// What laying a path starts from.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Front-bumper centre.
    pub front: Point,
    /// Unit vector of the heading.
    pub axis: Vector,
    /// Length of the road user in m.
    pub length: Metre,
    /// Its width in m.
    pub width: Metre,
    /// Speed in m/s.
    pub speed: MetrePerSecond,
    /// Whether it may move to the side without changing lanes (SUMO's sublane model).
    pub sublane: bool,
}

impl LanePath {
    /// Forgets the path.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The lines that its track runs over: those of the net's lanes, unless it has one of its own.
    pub fn lines<'a>(&'a self, of_net: &'a Lines) -> &'a Lines {
        self.own.as_ref().map_or(of_net, |own| &own.lines)
    }

    /// Follows the front bumper; whether it still is on the path.
    pub fn follow(&mut self, of_net: &Lines, front: Point) -> bool {
        self.track.follow(self.own.as_ref().map_or(of_net, |own| &own.lines), front)
    }

    /// Whether it knows the route from this place in it on.
    pub fn knows_route(&self, position: usize) -> bool {
        !self.route.are_free() && self.route.begin_before(position)
    }

    /// Whether it was laid for the rest of this route from this place in it on.
    pub fn is_for(&self, net: &Net, route: &[EdgeIndex], position: usize) -> bool {
        let mut own = self.route.clone();
        own.advance(net, position);
        own == RouteTurns::of(net, route, position)
    }

    /// Lays the path anew; without geometry to lay it on, none.
    pub fn lay(&mut self, net: &Net, start: &Start, placement: &Placement) {
        let lane = &net.lanes[placement.lane.0 as usize];
        let (line, length) = (net.lines.line(placement.lane.0), net.lines.length(placement.lane.0));
        let hint = placement.position * length / lane.length.max(f64::MIN_POSITIVE);
        let foot = Foot::of(line, start.front, hint);
        match &placement.route {
            Some(route) => self.route = RouteTurns::of(net, route, placement.route_position),
            None => self.route.advance(net, placement.route_position),
        }
        let against = foot.direction.dot(&start.axis) < 0.0 && !leads_along(net, lane, &self.route);
        let beside = Beside::new(offset(net, start, placement, &foot, against));
        let before = if against { SmallVec::new() } else { lanes_behind(net, placement.lane, &foot, start) };
        let joins =
            before.iter().try_fold(placement.lane.0, |next, lane| net.lines.join(lane.0, next).then_some(lane.0));
        self.own = None;
        if !against && beside.is_none() && line.len() > 1 && joins.is_some() {
            self.track.begin(&net.lines, placement.lane.0, foot.way);
            before.iter().for_each(|lane| self.track.come_from(lane.0));
        } else {
            let points = |corners: &[Corner]| corners.iter().map(|corner| corner.point).collect::<Vec<_>>();
            let (mut behind, mut ahead) = (points(&line[..=foot.segment]), points(&line[foot.segment + 1..]));
            if against {
                ahead.reverse();
                behind.reverse();
                std::mem::swap(&mut behind, &mut ahead);
            }
            let before = before.iter().rev().flat_map(|lane| points(net.lines.line(lane.0)));
            let own = Own::lay(&mut self.track, before.chain(behind), foot.point, ahead, placement.lane, beside);
            self.own = Some(Box::new(own));
        }
        self.track.edge = if against { NONE } else { 0 };
        self.forget_behind(net, start.length + KEPT_BEHIND);
        self.shrink();
    }

    /// Makes the path reach at least `way` ahead of the front bumper, if the route does, and forgets what lies
    /// behind the rear bumper.
    pub fn reach(&mut self, net: &Net, length: Metre, way: Metre) {
        if self.track.ahead() >= way || !self.track.is_laid() {
            return;
        }
        self.forget_behind(net, length + KEPT_BEHIND);
        // A ring of lanes of length 0 would go on for ever.
        let mut in_vain = 0;
        while self.track.ahead() < way + SPARE && in_vain <= net.lanes.len() {
            let Some((lane, edge)) = self.next(net) else { break };
            let before = self.track.ahead();
            self.go_on(net, lane);
            self.track.edge = edge;
            in_vain = if self.track.ahead() > before { 0 } else { in_vain + 1 };
        }
        self.shrink();
    }

    /// The lane at a way ahead of the front bumper.
    pub fn lane_at(&self, of_net: &Lines, way: Metre) -> Option<LaneIndex> {
        let track = Some(&self.track).filter(|track| track.is_laid())?;
        let (corner, line) = track.corner_ahead(self.lines(of_net), way);
        self.own.as_ref().map_or(Some(LaneIndex(line)), |own| own.lane_at(corner))
    }

    /// Goes on along this lane.
    fn go_on(&mut self, net: &Net, lane: LaneIndex) {
        let track = &mut self.track;
        if self.own.is_none() && track.lines.last().is_some_and(|last| net.lines.join(*last, lane.0)) {
            return track.go_on(&net.lines, lane.0);
        }
        self.own.get_or_insert_with(|| Box::new(Own::along(net, track))).go_on(net, track, lane);
    }

    /// Forgets what lies further behind the front bumper than this.
    fn forget_behind(&mut self, net: &Net, behind: Metre) {
        match &mut self.own {
            Some(own) => own.forget_behind(&mut self.track, behind),
            None => self.track.forget_behind(&net.lines, behind),
        }
    }

    /// Gives back what memory is not needed.
    fn shrink(&mut self) {
        if let Some(own) = &mut self.own {
            own.shrink();
        }
    }

    /// The lane after the last one, and on which edge of the route that is.
    fn next(&self, net: &Net) -> Option<(LaneIndex, u16)> {
        let last = match &self.own {
            Some(own) => own.last()?,
            None => LaneIndex(*self.track.lines.last()?),
        };
        let position = Some(self.track.edge).filter(|edge| *edge != NONE)?;
        let mut ahead = self.route.edges(net).skip(position as usize + 1);
        let lane = &net.lanes[last.0 as usize];
        let inside = net.edges[lane.edge.0 as usize].function == EdgeFunction::Internal;
        let wanted = ahead.next();
        let leads =
            |link: &&crate::traffic::net::Link| inside || wanted.is_none_or(|edge| edge_of(net, link.to) == edge);
        if wanted.is_none() && !inside && !self.route.are_free() {
            return None;
        }
        // Where there is no choice nobody asks how far each leads.
        let further = ahead.take(if lane.links.len() < 2 { 0 } else { EDGES_AHEAD });
        let ahead = wanted.into_iter().chain(further).collect::<SmallVec<[_; EDGES_AHEAD + 1]>>();
        let link =
            lane.links.iter().filter(leads).fold(None, |best: Option<(&crate::traffic::net::Link, Metre)>, link| {
                let worth = if lane.links.len() < 2 {
                    0.0
                } else if wanted.is_some() {
                    continuation(net, &ahead, link.to)
                } else {
                    straightness(net, last, link.via.unwrap_or(link.to))
                };
                if best.is_some_and(|(_, most)| most >= worth) { best } else { Some((link, worth)) }
            })?;
        let (link, _) = link;
        Some(match link.via {
            Some(via) => (via, position),
            None => (link.to, position + u16::from(wanted == Some(edge_of(net, link.to)))),
        })
    }
}

/// Whether a lane is one of the route, where the road user is now. Who is on such a lane drives along it, whatever its
/// heading says: after a sharp turn the rear stands across for as long as the road user.
fn leads_along(net: &Net, lane: &crate::traffic::net::Lane, route: &RouteTurns) -> bool {
    let on_route = |further: usize| route.edges(net).nth(further);
    if net.edges[lane.edge.0 as usize].function == EdgeFunction::Normal {
        return on_route(0) == Some(lane.edge);
    }
    lane.links.first().is_some_and(|link| on_route(1) == Some(edge_of(net, link.to)))
}

/// The place on a lane's centre line next to a front bumper.
struct Foot {
    point: Point,
    segment: usize,
    way: Metre,
    direction: Vector,
    aside: Metre,
}

impl Foot {
    fn of(line: &[Corner], front: Point, hint: Metre) -> Self {
        let best = Self::nearest(line, front, |start, end| start <= hint + NEAR_HINT && end >= hint - NEAR_HINT);
        best.or_else(|| Self::nearest(line, front, |_, _| true)).unwrap_or(Self {
            point: front,
            segment: 0,
            way: 0.0,
            direction: Vector::x(),
            aside: 0.0,
        })
    }

    fn nearest(line: &[Corner], front: Point, wanted: impl Fn(Metre, Metre) -> bool) -> Option<Self> {
        let mut best: Option<(f64, Self)> = None;
        for (segment, ends) in line.windows(2).enumerate() {
            let [start, end] = [&ends[0], &ends[1]];
            let length = end.way - start.way;
            if !wanted(start.way, end.way) {
                continue;
            }
            let direction = (end.point - start.point) / length;
            let along = (front - start.point).dot(&direction).clamp(0.0, length);
            let point = start.point + direction * along;
            let distance = (front - point).norm_squared();
            if best.as_ref().is_none_or(|(least, _)| distance < *least) {
                let aside = cross(&direction, &(front - point));
                best = Some((distance, Self { point, segment, way: start.way + along, direction, aside }));
            }
        }
        best.map(|(_, foot)| foot)
    }
}

/// The offset of now, and where a movement to the side leads: to the centre of this lane or the next one, or (sublane
/// model) to the border of this one.
fn offset(net: &Net, start: &Start, placement: &Placement, foot: &Foot, against: bool) -> Offset {
    let sign = if against { -1.0 } else { 1.0 };
    let now = sign * if foot.aside.abs() < 1e-3 { 0.0 } else { foot.aside };
    let speed = sign * placement.lateral_speed;
    if speed.abs() < KEEPS_OFFSET || start.speed < KEEPS_OFFSET {
        return Offset { now, target: now, over: 0.0 };
    }
    let width = net.lanes[placement.lane.0 as usize].width;
    // As far aside as it can be within its lane: two that drift towards each other, each in its own, do not touch.
    let inside = ((width - start.width) / 2.0 - OFF_THE_BORDER).max(0.0);
    let target = if now * speed < 0.0 {
        0.0
    } else if start.sublane && (now.abs() < inside || !leads_to_a_lane(net, placement.lane, placement.lateral_speed)) {
        // At the border already, beyond which there is no lane to change to, it is not going any further.
        inside.max(now.abs()).copysign(speed)
    } else {
        width.copysign(speed)
    };
    Offset { now, target, over: (target - now).abs() / speed.abs() * start.speed }
}

/// Whether the edge has another lane to that side.
fn leads_to_a_lane(net: &Net, lane: LaneIndex, to_the_left: MetrePerSecond) -> bool {
    let lane = &net.lanes[lane.0 as usize];
    let last = net.edges[lane.edge.0 as usize].lanes.len() as u32;
    if to_the_left > 0.0 { lane.index + 1 < last } else { lane.index > 0 }
}

/// The lanes behind the one that the front bumper is on, the nearest first, as far as the rear bumper and a little more.
fn lanes_behind(net: &Net, lane: LaneIndex, foot: &Foot, start: &Start) -> SmallVec<[LaneIndex; 4]> {
    let needed = start.length + KEPT_BEHIND;
    let rear = start.front - start.axis * start.length;
    let mut lanes = SmallVec::new();
    let mut laid = foot.way;
    let mut current = lane;
    while laid < needed {
        let before = net.lanes[current.0 as usize].from.iter().copied().min_by(|&a, &b| {
            let distance = |lane: LaneIndex| {
                let way = net.lines.length(lane.0) - (start.length - laid);
                (rear - Foot::of(net.lines.line(lane.0), rear, way).point).norm()
            };
            distance(a).total_cmp(&distance(b))
        });
        let Some(before) = before else { break };
        lanes.push(before);
        // A lane of length 0 must not make this endless.
        laid += net.lines.length(before.0).max(0.1);
        current = before;
    }
    lanes
}

fn edge_of(net: &Net, lane: LaneIndex) -> EdgeIndex {
    net.lanes[lane.0 as usize].edge
}

/// How far one gets along the edges of a route from a lane of the first of them without changing lanes (what SUMO chooses
/// lanes by).
fn continuation(net: &Net, route: &[EdgeIndex], lane: LaneIndex) -> Metre {
    let here = &net.lanes[lane.0 as usize];
    let beyond = match route {
        [_, rest @ ..] if !rest.is_empty() => here
            .links
            .iter()
            .filter(|link| edge_of(net, link.to) == rest[0])
            .map(|link| continuation(net, rest, link.to))
            .fold(0.0, f64::max),
        _ => 0.0,
    };
    here.length + beyond
}

/// 1 where the next lane goes straight on, −1 where it turns back.
fn straightness(net: &Net, lane: LaneIndex, next: LaneIndex) -> f64 {
    let (here, there) = (&net.lanes[lane.0 as usize].shape, &net.lanes[next.0 as usize].shape);
    let (Some([a, b]), Some([c, .., d])) = (here.last_chunk::<2>(), Some(there.as_slice())) else { return 0.0 };
    let (out, on) = (b - a, d - c);
    out.dot(&on) / (out.norm() * on.norm()).max(f64::MIN_POSITIVE)
}
