//! Along the lanes of its route, its lateral offset kept.
//!
//! A [`LanePath`] is laid when a road user first needs a path or has left the one it had (a lane change, another
//! route); from then on it is followed, and lengthened ahead. Behind the front bumper it runs over the lanes that
//! the vehicle came from, since the rear drives there still. Where the lane does not lead to the next edge of the
//! route, the path ends with the lane.

use std::sync::Arc;

use super::track::Track;
use crate::encounter::Placement;
use crate::geometry::{Point, Vector, cross, left_of};
use crate::net::{EdgeFunction, EdgeIndex, LaneIndex, Net};
use crate::units::{Metre, MetrePerSecond};

/// A path is laid this much further than it is needed, so that it is lengthened now and then, not in every step; m.
const SPARE: Metre = 60.0;
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
    route: Option<Arc<[EdgeIndex]>>,
    /// Centre line as far as it is laid, its last lane, and that lane's edge in the route.
    tip: Option<Tip>,
    /// Where lanes begin, as ways from the track's beginning.
    lanes: Vec<(Metre, LaneIndex)>,
    offset: Offset,
    /// The last two points of the centre line: the offset line's corner between them waits for the next.
    centre: Vec<Point>,
    /// Way along the centre line up to the last point of `centre`, from the front bumper at laying.
    centre_way: Metre,
}

#[derive(Clone, Copy, Debug)]
struct Tip {
    lane: LaneIndex,
    route_position: usize,
}

/// Lateral offset from the centre line, to the left: `now` at way 0, changing evenly to `target` over `over`.
#[derive(Clone, Copy, Debug, Default)]
struct Offset {
    now: Metre,
    target: Metre,
    over: Metre,
}

impl Offset {
    fn at(&self, way: Metre) -> Metre {
        if way <= 0.0 || self.over <= 0.0 {
            self.now
        } else {
            self.now + (self.target - self.now) * (way / self.over).min(1.0)
        }
    }
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
        self.track.clear();
        self.tip = None;
        self.route = None;
    }

    /// Follows the front bumper; whether it still is on the path.
    pub fn follow(&mut self, front: Point) -> bool {
        self.track.follow(front)
    }

    /// Whether it was laid for this route.
    pub fn is_for(&self, route: &Arc<[EdgeIndex]>) -> bool {
        self.route.as_ref().is_some_and(|known| Arc::ptr_eq(known, route) || known == route)
    }

    /// Lays the path anew; without geometry to lay it on, none.
    pub fn lay(&mut self, net: &Net, start: &Start, placement: &Placement) {
        self.clear();
        self.lanes.clear();
        self.centre.clear();
        let lane = &net.lanes[placement.lane.0 as usize];
        let hint = placement.position * lane.ways.last().copied().unwrap_or(0.0) / lane.length.max(f64::MIN_POSITIVE);
        let foot = Foot::of(&lane.shape, &lane.ways, start.front, hint);
        let against = foot.direction.dot(&start.axis) < 0.0;
        self.offset = offset(net, start, placement, &foot, against);
        self.route = Some(placement.route.clone());
        let mut line = Vec::new();
        if against {
            behind_against(lane, &foot, start, &mut line);
        } else {
            behind(net, placement.lane, &foot, start, &mut line);
        }
        line.reverse();
        // The rear part of the line: its offset is that of now.
        self.centre_way = f64::NEG_INFINITY;
        for point in line {
            self.push_centre(point, f64::NEG_INFINITY);
        }
        self.centre_way = 0.0;
        self.push_centre(foot.point, 0.0);
        let front = self.flush();
        self.track.set_front(front);
        self.lanes.push((front, placement.lane));
        if against {
            for point in lane.shape[..=foot.segment].iter().rev() {
                self.push_ahead(*point);
            }
        } else {
            for point in &lane.shape[foot.segment + 1..] {
                self.push_ahead(*point);
            }
            self.tip = Some(Tip { lane: placement.lane, route_position: placement.route_position });
        }
        self.flush();
    }

    /// Makes the path reach at least `way` ahead of the front bumper, if the route does, and forgets what lies
    /// behind the rear bumper.
    pub fn reach(&mut self, net: &Net, length: Metre, way: Metre) {
        if self.track.end() - self.track.front() >= way {
            return;
        }
        let shift = self.track.forget_behind(length + KEPT_BEHIND);
        if shift > 0.0 {
            for (start, _) in &mut self.lanes {
                *start -= shift;
            }
            let behind = self.lanes.partition_point(|(start, _)| *start <= 0.0).saturating_sub(1);
            self.lanes.drain(..behind);
        }
        // A ring of lanes of length 0 would go on for ever.
        let mut in_vain = 0;
        while self.track.end() - self.track.front() < way + SPARE && in_vain <= net.lanes.len() {
            let Some(next) = self.tip.and_then(|tip| self.next(net, tip)) else { break };
            let before = self.track.end();
            self.lanes.push((self.track.end(), next.lane));
            for point in &net.lanes[next.lane.0 as usize].shape {
                self.push_ahead(*point);
            }
            self.flush();
            self.tip = Some(next);
            in_vain = if self.track.end() > before { 0 } else { in_vain + 1 };
        }
    }

    /// The lane at a way ahead of the front bumper.
    pub fn lane_at(&self, way: Metre) -> Option<LaneIndex> {
        let way = self.track.front() + way;
        let index = self.lanes.partition_point(|(start, _)| *start <= way).saturating_sub(1);
        self.lanes.get(index).map(|(_, lane)| *lane)
    }

    fn next(&self, net: &Net, tip: Tip) -> Option<Tip> {
        let route = self.route.as_deref().unwrap_or_default();
        let lane = &net.lanes[tip.lane.0 as usize];
        let inside = net.edges[lane.edge.0 as usize].function == EdgeFunction::Internal;
        let wanted = route.get(tip.route_position + 1).copied();
        let leads = |link: &&crate::net::Link| inside || wanted.is_none_or(|edge| edge_of(net, link.to) == edge);
        if wanted.is_none() && !inside && !route.is_empty() {
            return None;
        }
        let link = lane.links.iter().filter(leads).fold(None, |best: Option<(&crate::net::Link, Metre)>, link| {
            let worth = if lane.links.len() < 2 {
                0.0
            } else if wanted.is_some() {
                continuation(net, route, link.to, tip.route_position + 1, EDGES_AHEAD)
            } else {
                straightness(net, tip.lane, link.via.unwrap_or(link.to))
            };
            if best.is_some_and(|(_, most)| most >= worth) { best } else { Some((link, worth)) }
        })?;
        let (link, _) = link;
        Some(match link.via {
            Some(via) => Tip { lane: via, ..tip },
            None => {
                let arrives = wanted == Some(edge_of(net, link.to));
                Tip { lane: link.to, route_position: tip.route_position + usize::from(arrives) }
            }
        })
    }

    fn push_ahead(&mut self, point: Point) {
        let way = self.centre_way + self.centre.last().map_or(0.0, |last| (point - last).norm());
        // An offset that changes needs a corner where the change ends.
        if self.centre_way < self.offset.over
            && self.offset.over < way
            && let Some(&last) = self.centre.last()
        {
            let part = (self.offset.over - self.centre_way) / (way - self.centre_way);
            self.push_centre(last + (point - last) * part, self.offset.over);
        }
        self.push_centre(point, way);
    }

    /// Adds a point of the centre line; the offset line's corner before it is settled by it.
    fn push_centre(&mut self, point: Point, way: Metre) {
        if self.centre.last().is_some_and(|last| (point - last).norm() < 1e-3) {
            return;
        }
        if self.offset.now == 0.0 && self.offset.target == 0.0 {
            self.track.push(point);
            self.centre.clear();
            self.centre.push(point);
            self.centre_way = way;
            return;
        }
        if let [.., before, last] = self.centre[..] {
            let corner = last + miter(&(last - before), &(point - last)) * self.offset.at(self.centre_way);
            self.track.push(corner);
        } else if let [first] = self.centre[..] {
            let normal = left_of(&(point - first).try_normalize(0.0).unwrap_or_else(Vector::x));
            self.track.push(first + normal * self.offset.at(self.centre_way));
        }
        if self.centre.len() == 2 {
            self.centre.remove(0);
        }
        self.centre.push(point);
        self.centre_way = way;
    }

    /// Ends the offset line at the last centre point for now; returns the way there.
    fn flush(&mut self) -> Metre {
        if let [before, last] = self.centre[..] {
            let normal = left_of(&(last - before).try_normalize(0.0).unwrap_or_else(Vector::x));
            self.track.push(last + normal * self.offset.at(self.centre_way));
        }
        self.track.end()
    }
}

/// The shift, for an offset of 1 to the left, of the corner between two edges of a line.
fn miter(before: &Vector, after: &Vector) -> Vector {
    /// Sharper corners than this are cut: their miter would lie far away.
    const LONGEST: f64 = 2.0;
    let (a, b) = (left_of(&before.normalize()), left_of(&after.normalize()));
    let sum = a + b;
    let length = 2.0 / sum.norm_squared().max(1e-12);
    (sum * length).cap_magnitude(LONGEST)
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
