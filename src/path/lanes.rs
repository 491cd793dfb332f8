//! Along the lanes of its route, its lateral offset kept.
//!
//! A [`LanePath`] is laid when a road user first needs a path or has left the one it had (a lane change, another
//! route); from then on it is followed, and lengthened ahead. Behind the front bumper it runs over the lanes that
//! the vehicle came from, since the rear drives there still. Where the lane does not lead to the next edge of the
//! route, the path ends with the lane.

use std::sync::Arc;

use super::beside::{Beside, Offset};
use super::track::Track;
use crate::encounter::Placement;
use crate::geometry::{Point, Vector, cross};
use crate::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};
use crate::units::{Metre, MetrePerSecond};

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
    /// The line of the front bumper.
    pub track: Track,
    plan: Option<Box<Plan>>,
}

/// What a path was laid along, and how it goes on: what following it does not need.
#[derive(Clone, Debug, Default)]
struct Plan {
    route: Arc<[EdgeIndex]>,
    /// The place in the route of the last lane's edge, or of the one before; none where the line does not go on.
    route_position: Option<u32>,
    /// On which lane the line is from which of its points on.
    lanes: Vec<(u32, LaneIndex)>,
    /// None on the lanes' centre line.
    beside: Option<Box<Beside>>,
}

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

    /// Follows the front bumper; whether it still is on the path.
    pub fn follow(&mut self, front: Point) -> bool {
        self.track.follow(front)
    }

    /// The route that it was laid for.
    pub fn route(&self) -> Option<&Arc<[EdgeIndex]>> {
        self.plan.as_ref().map(|plan| &plan.route)
    }

    /// Whether it was laid for this route.
    pub fn is_for(&self, route: &Arc<[EdgeIndex]>) -> bool {
        self.route().is_some_and(|own| Arc::ptr_eq(own, route) || own == route)
    }

    /// Lays the path anew; without geometry to lay it on, none.
    pub fn lay(&mut self, net: &Net, start: &Start, placement: &Placement) {
        let lane = &net.lanes[placement.lane.0 as usize];
        let hint = placement.position * lane.ways.last().copied().unwrap_or(0.0) / lane.length.max(f64::MIN_POSITIVE);
        let foot = Foot::of(&lane.shape, &lane.ways, start.front, hint);
        let against = foot.direction.dot(&start.axis) < 0.0 && !leads_along(net, lane, placement);
        let mut line = Vec::new();
        if against {
            behind_against(lane, &foot, start, &mut line);
        } else {
            behind(net, placement.lane, &foot, start, &mut line);
        }
        let (track, plan) = (&mut self.track, self.plan.get_or_insert_default());
        plan.route = placement.route.clone();
        plan.route_position = None;
        plan.lanes.clear();
        plan.beside = Beside::new(offset(net, start, placement, &foot, against));
        track.clear();
        track.reserve(line.len() + 1 + lane.shape.len());
        // The rear part of the line: its offset is that of now.
        for point in line.into_iter().rev() {
            match &mut plan.beside {
                Some(beside) => beside.push_behind(track, point),
                None => track.push(point),
            }
        }
        match &mut plan.beside {
            Some(beside) => beside.push_front(track, foot.point),
            None => track.push(foot.point),
        }
        plan.begin_lane(track, placement.lane);
        track.set_front(track.end());
        if against {
            plan.push_ahead(track, lane.shape[..=foot.segment].iter().rev());
        } else {
            plan.push_ahead(track, &lane.shape[foot.segment + 1..]);
            plan.route_position = Some(placement.route_position as u32);
        }
        plan.forget(track.drop_behind(start.length + KEPT_BEHIND));
        track.shrink();
    }

    /// Makes the path reach at least `way` ahead of the front bumper, if the route does, and forgets what lies
    /// behind the rear bumper.
    pub fn reach(&mut self, net: &Net, length: Metre, way: Metre) {
        let track = &mut self.track;
        let Some(plan) = &mut self.plan else { return };
        if track.end() - track.front() >= way {
            return;
        }
        plan.forget(track.forget_behind(length + KEPT_BEHIND));
        // A ring of lanes of length 0 would go on for ever.
        let mut in_vain = 0;
        while track.end() - track.front() < way + SPARE && in_vain <= net.lanes.len() {
            let Some((lane, route_position)) = plan.next(net) else { break };
            let before = track.end();
            let shape = &net.lanes[lane.0 as usize].shape;
            track.reserve(shape.len());
            plan.begin_lane(track, lane);
            plan.push_ahead(track, shape);
            plan.route_position = Some(route_position);
            in_vain = if track.end() > before { 0 } else { in_vain + 1 };
        }
        track.shrink();
    }

    /// The lane at a way ahead of the front bumper.
    pub fn lane_at(&self, way: Metre) -> Option<LaneIndex> {
        let lanes = &self.plan.as_ref()?.lanes;
        let last = self.track.corner_before(self.track.front() + way);
        let index = lanes.partition_point(|(corner, _)| *corner as usize <= last).saturating_sub(1);
        lanes.get(index).map(|(_, lane)| *lane)
    }
}

impl Plan {
    /// From the end of the line on it is on this lane.
    fn begin_lane(&mut self, track: &mut Track, lane: LaneIndex) {
        if let Some(beside) = &mut self.beside {
            beside.flush(track);
        }
        self.lanes.reserve_exact(1);
        self.lanes.push((track.len().saturating_sub(1) as u32, lane));
    }

    /// The line along these points of the centre line.
    fn push_ahead<'a>(&mut self, track: &mut Track, points: impl IntoIterator<Item = &'a Point>) {
        match &mut self.beside {
            Some(beside) => {
                points.into_iter().for_each(|point| beside.push_ahead(track, *point));
                beside.flush(track);
            }
            None => points.into_iter().for_each(|point| track.push(*point)),
        }
    }

    /// Takes account of points that the line's beginning has lost.
    fn forget(&mut self, points: usize) {
        for (corner, _) in &mut self.lanes {
            *corner = corner.saturating_sub(points as u32);
        }
        let behind = self.lanes.partition_point(|(corner, _)| *corner == 0).saturating_sub(1);
        self.lanes.drain(..behind);
    }

    /// The lane after the last one, and its place in the route.
    fn next(&self, net: &Net) -> Option<(LaneIndex, u32)> {
        let (route, route_position, (_, last)) = (&*self.route, self.route_position?, *self.lanes.last()?);
        let position = route_position as usize;
        let lane = &net.lanes[last.0 as usize];
        let inside = net.edges[lane.edge.0 as usize].function == EdgeFunction::Internal;
        let wanted = route.get(position + 1).copied();
        let leads = |link: &&crate::net::Link| inside || wanted.is_none_or(|edge| edge_of(net, link.to) == edge);
        if wanted.is_none() && !inside && !route.is_empty() {
            return None;
        }
        let link = lane.links.iter().filter(leads).fold(None, |best: Option<(&crate::net::Link, Metre)>, link| {
            let worth = if lane.links.len() < 2 {
                0.0
            } else if wanted.is_some() {
                continuation(net, route, link.to, position + 1, EDGES_AHEAD)
            } else {
                straightness(net, last, link.via.unwrap_or(link.to))
            };
            if best.is_some_and(|(_, most)| most >= worth) { best } else { Some((link, worth)) }
        })?;
        let (link, _) = link;
        Some(match link.via {
            Some(via) => (via, route_position),
            None => (link.to, route_position + u32::from(wanted == Some(edge_of(net, link.to)))),
        })
    }
}

/// Whether a lane is one of the route, where the road user is now. Who is on such a lane drives along it, whatever its
/// heading says: after a sharp turn the rear stands across for as long as the road user.
fn leads_along(net: &Net, lane: &crate::net::Lane, placement: &Placement) -> bool {
    let on_route = |further: usize| placement.route.get(placement.route_position + further).copied();
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
    fn of(shape: &[Point], ways: &[Metre], front: Point, hint: Metre) -> Self {
        let best = Self::nearest(shape, ways, front, |start, end| start <= hint + NEAR_HINT && end >= hint - NEAR_HINT);
        best.or_else(|| Self::nearest(shape, ways, front, |_, _| true)).unwrap_or(Self {
            point: front,
            segment: 0,
            way: 0.0,
            direction: Vector::x(),
            aside: 0.0,
        })
    }

    fn nearest(shape: &[Point], ways: &[Metre], front: Point, wanted: impl Fn(Metre, Metre) -> bool) -> Option<Self> {
        let mut best: Option<(f64, Self)> = None;
        for segment in 0..shape.len().saturating_sub(1) {
            let length = ways[segment + 1] - ways[segment];
            if length <= 0.0 || !wanted(ways[segment], ways[segment + 1]) {
                continue;
            }
            let direction = (shape[segment + 1] - shape[segment]) / length;
            let along = (front - shape[segment]).dot(&direction).clamp(0.0, length);
            let point = shape[segment] + direction * along;
            let distance = (front - point).norm_squared();
            if best.as_ref().is_none_or(|(least, _)| distance < *least) {
                let aside = cross(&direction, &(front - point));
                best = Some((distance, Self { point, segment, way: ways[segment] + along, direction, aside }));
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

/// The centre line behind the front bumper, from there backwards, as far as the rear bumper and a little more.
fn behind(net: &Net, lane: LaneIndex, foot: &Foot, start: &Start, line: &mut Vec<Point>) {
    let needed = start.length + KEPT_BEHIND;
    let rear = start.front - start.axis * start.length;
    let shape = &net.lanes[lane.0 as usize].shape;
    line.extend(shape[..=foot.segment].iter().rev());
    let mut laid = foot.way;
    let mut current = lane;
    while laid < needed {
        let before = net.lanes[current.0 as usize].from.iter().copied().min_by(|&a, &b| {
            let distance = |lane: LaneIndex| {
                let lane = &net.lanes[lane.0 as usize];
                let way = lane.ways.last().copied().unwrap_or(0.0) - (start.length - laid);
                (rear - Foot::of(&lane.shape, &lane.ways, rear, way).point).norm()
            };
            distance(a).total_cmp(&distance(b))
        });
        let Some(before) = before else { break };
        line.extend(net.lanes[before.0 as usize].shape.iter().rev());
        // A lane of length 0 must not make this endless.
        laid += net.lanes[before.0 as usize].ways.last().copied().unwrap_or(0.0).max(0.1);
        current = before;
    }
}

/// The same for one who drives against the lane's direction.
fn behind_against(lane: &crate::net::Lane, foot: &Foot, start: &Start, line: &mut Vec<Point>) {
    let needed = foot.way + start.length + KEPT_BEHIND;
    let end = lane.ways.partition_point(|&way| way <= needed).min(lane.shape.len() - 1);
    line.extend(&lane.shape[foot.segment + 1..=end]);
}

fn edge_of(net: &Net, lane: LaneIndex) -> EdgeIndex {
    net.lanes[lane.0 as usize].edge
}

/// How far one gets along the route from a lane without changing lanes (what SUMO chooses lanes by).
fn continuation(net: &Net, route: &[EdgeIndex], lane: LaneIndex, route_position: usize, edges: usize) -> Metre {
    let here = &net.lanes[lane.0 as usize];
    let beyond = match route.get(route_position + 1) {
        Some(next) if edges > 0 => here
            .links
            .iter()
            .filter(|link| edge_of(net, link.to) == *next)
            .map(|link| continuation(net, route, link.to, route_position + 1, edges - 1))
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
