//! Places where two lanes overlap as drawn, although vehicles on both pass each other in SUMO.
//!
//! SUMO's drivers know distances along their lanes, and at a junction the links that cross or merge with theirs: its
//! `foes`. They do not know how far lanes are apart. So two lanes are independent if they are
//!
//! - within one junction and not each other's foes, or
//! - elsewhere, of different edges, and neither cross nor have one common end (with both in common, one is drawn on the
//!   other, as tracks are on roads);
//!
//! and in both cases neither lead to the same lane, nor come from the same one, nor follow each other, nor are one line in
//! both directions. If their centre lines come closer than two vehicles are wide, any two vehicles there overlap as drawn,
//! in every queue.

use rustc_hash::FxHashMap;
use typed_index_collections::TiVec;

use super::elements::{EdgeFunction, Lane, LaneIndex};
use super::finder::{aabb, distance_beside};
use super::network::Net;
use crate::geometry::{Bounds, Point, cross};
use crate::util::units::Metre;

/// The width of SUMO's default vehicle in m. On a narrower lane a vehicle is as wide as the lane.
pub const VEHICLE_WIDTH: Metre = 1.8;
/// Two lanes that overlap by less than this lie beside each other, in m; by more, they lie on each other or cross.
const BESIDE: Metre = VEHICLE_WIDTH / 2.0;
/// Less is due to shapes that are rounded to a centimetre, in m.
pub const ROUNDING: Metre = 0.02;
/// Lanes of which one leads to the other within this distance follow each other, in m.
const FOLLOWING: Metre = 10.0;
/// The length of a shorter lane counts as this, in m, so that a search along lanes ends.
const SHORTEST: Metre = 0.1;
/// The number of lanes after which a search within [`FOLLOWING`] ends.
const MOST_LANES: usize = 1000;

/// Two independent lanes that overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The two, the one with the lower index first.
    pub lanes: (LaneIndex, LaneIndex),
    /// How much room two vehicles lack at the narrowest place, in m.
    pub depth: Metre,
}

/// All pairs of independent lanes of a net that overlap.
#[derive(Clone, Debug, Default)]
pub struct Overlaps {
    /// The deepest first.
    places: Vec<Overlap>,
    depths: FxHashMap<(LaneIndex, LaneIndex), Metre>,
}

impl Net {
    /// Finds the independent lanes that overlap as drawn: 0.2 s for 100,000 lanes.
    pub fn overlaps(&self) -> Overlaps {
        Overlaps::of(self)
    }

    /// Whether the centre lines of two lanes cross.
    pub fn cross_as_drawn(&self, one: LaneIndex, other: LaneIndex) -> bool {
        cross_each_other(&self.lanes[one].shape, &self.lanes[other].shape)
    }

    /// Whether two lanes have room beside each other as they are drawn, each with its width.
    pub fn have_room(&self, one: LaneIndex, other: LaneIndex) -> bool {
        let [a, b] = [one, other].map(|lane| &self.lanes[lane]);
        let room = (a.width + b.width) / 2.0 - ROUNDING;
        let is_apart =
            |points: &Lane, line: &Lane| points.shape.iter().all(|point| distance_beside(&line.shape, *point) >= room);
        is_apart(a, b) && is_apart(b, a) && !self.cross_as_drawn(one, other)
    }
}

impl Overlaps {
    fn of(net: &Net) -> Self {
        let connected = Connected::of(net);
        let mut places = Vec::new();
        for index in net.lanes.keys().filter(|lane| is_driven(net, *lane)) {
            let window = aabb(&connected.bounds[index].grown(VEHICLE_WIDTH));
            let near = net.finder.lanes_in(&window);
            for other in near.filter(|other| *other > index && is_driven(net, *other)) {
                let depth = connected.overlap(index, other);
                if depth > ROUNDING {
                    places.push(Overlap { lanes: (index, other), depth });
                }
            }
        }
        places.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(a.lanes.cmp(&b.lanes)));
        let depths = places.iter().map(|place| (place.lanes, place.depth)).collect();
        Self { places, depths }
    }

    /// The pairs of lanes, the deepest overlap first.
    pub fn places(&self) -> &[Overlap] {
        &self.places
    }

    /// Whether no two lanes overlap.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// By how much two vehicles of these widths overlap as drawn where each is on one of these lanes, if the lanes are drawn
    /// too near each other; 0 if they lie on each other or cross, where an overlap may be a crash.
    pub(crate) fn drawn_overlap_of(&self, lanes: [&[LaneIndex]; 2], widths: [Metre; 2]) -> Metre {
        let [ones, others] = lanes;
        let pairs = ones.iter().flat_map(|one| others.iter().map(|other| self.drawn_overlap(*one, *other)));
        let deepest = pairs.filter(|depth| *depth < BESIDE).fold(0.0, f64::max);
        let wider = widths.iter().sum::<Metre>() / 2.0 - VEHICLE_WIDTH;
        if deepest > 0.0 { (deepest + wider).max(0.0) } else { 0.0 }
    }

    /// By how much two lanes overlap as drawn; 0 if they do not or are not independent.
    pub fn drawn_overlap(&self, one: LaneIndex, other: LaneIndex) -> Metre {
        if self.depths.is_empty() {
            return 0.0;
        }
        self.depths.get(&(one.min(other), one.max(other))).copied().unwrap_or(0.0)
    }
}

fn is_driven(net: &Net, lane: LaneIndex) -> bool {
    let lane = &net.lanes[lane];
    let function = net.edges[lane.edge].function;
    lane.has_vehicles && matches!(function, EdgeFunction::Normal | EdgeFunction::Internal)
}

/// Which lanes belong together.
struct Connected<'a> {
    net: &'a Net,
    /// By lane: for a junction lane, the lanes that its link leads from and to; for others, the lane itself twice.
    ends: TiVec<LaneIndex, [LaneIndex; 2]>,
    /// By lane: its junction and its link there.
    links: TiVec<LaneIndex, Option<(u32, u32)>>,
    bounds: TiVec<LaneIndex, Bounds>,
}

impl<'a> Connected<'a> {
    fn of(net: &'a Net) -> Self {
        let mut ends = net.lanes.keys().map(|lane| [lane; 2]).collect::<TiVec<_, _>>();
        let mut links = TiVec::from(vec![None; net.lanes.len()]);
        let is_internal = |lane: LaneIndex| net.edges[net.lanes[lane].edge].function == EdgeFunction::Internal;
        for from in net.lanes.keys().filter(|lane| !is_internal(*lane)) {
            for link in &net.lanes[from].links {
                let mut next = link.via;
                // A link has two junction lanes at most.
                for _ in 0..2 {
                    let Some(via) = next.filter(|via| is_internal(*via)) else { break };
                    ends[via] = [from, link.to];
                    next = net.lanes[via].links.first().and_then(|link| link.via);
                }
            }
        }
        for (number, junction) in (0..).zip(&net.junctions) {
            for (link, lane) in (0..).zip(&junction.link_lanes) {
                let Some(lane) = *lane else { continue };
                let before = net.lanes[lane].from.iter().copied().filter(|before| is_internal(*before));
                for part in before.chain([lane]) {
                    links[part] = Some((number, link));
                }
            }
        }
        Self { net, ends, links, bounds: net.lanes.iter().map(Lane::bounds).collect() }
    }

    /// By how much two lanes overlap; 0 or less if they do not or are not independent.
    fn overlap(&self, one: LaneIndex, other: LaneIndex) -> Metre {
        let [a, b] = [one, other].map(|lane| &self.net.lanes[lane]);
        let [ends, others] = [one, other].map(|lane| self.ends[lane]);
        if a.edge == b.edge || ends.iter().any(|end| others.contains(end)) {
            return 0.0;
        }
        let in_one_junction = match (self.links[one], self.links[other]) {
            (Some((junction, link)), Some((same, foe))) if junction == same => {
                if self.net.junctions[junction as usize].are_foes(link, foe) {
                    return 0.0;
                }
                true
            }
            _ => false,
        };
        let room = (a.width.min(VEHICLE_WIDTH) + b.width.min(VEHICLE_WIDTH)) / 2.0;
        let depth = room - self.distance(one, other, room);
        if in_one_junction && cross_each_other(&a.shape, &b.shape) {
            return if follow_each_other(&a.shape, &b.shape) { 0.0 } else { room };
        }
        let meet = || !in_one_junction && (meet_at_one_end(&a.shape, &b.shape) || cross_each_other(&a.shape, &b.shape));
        let follow = || {
            follow_each_other(&a.shape, &b.shape)
                || self.leads_to(one, other, FOLLOWING)
                || self.leads_to(other, one, FOLLOWING)
        };
        if depth > 0.0 && (meet() || follow()) { 0.0 } else { depth }
    }

    /// How close two lanes that do not cross come beside each other, if closer than `room`; where one ends before the other
    /// begins they are not beside each other.
    fn distance(&self, one: LaneIndex, other: LaneIndex, room: Metre) -> Metre {
        let from = |points: LaneIndex, line: LaneIndex| {
            let near = self.bounds[line].grown(room);
            let points = self.net.lanes[points].shape.iter().filter(|point| near.holds(**point));
            points.map(|point| distance_beside(&self.net.lanes[line].shape, *point)).fold(f64::INFINITY, f64::min)
        };
        from(one, other).min(from(other, one))
    }

    /// Whether the way from the end of a lane reaches another within a distance.
    fn leads_to(&self, from: LaneIndex, to: LaneIndex, within: Metre) -> bool {
        // The lanes that are reached, each with the shortest way there so far; those behind `next` are still to be followed.
        let mut reached = vec![(from, 0.0)];
        let mut next = 0;
        while let Some(&(lane, travelled)) = reached.get(next).filter(|_| reached.len() < MOST_LANES) {
            next += 1;
            for link in &self.net.lanes[lane].links {
                let ahead = link.via.unwrap_or(link.to);
                if ahead == to {
                    return true;
                }
                let travelled = travelled + self.net.lanes[ahead].length.max(SHORTEST);
                if travelled < within
                    && !reached.iter().any(|(known, shorter)| *known == ahead && *shorter <= travelled)
                {
                    reached.push((ahead, travelled));
                }
            }
        }
        false
    }
}

fn are_same(one: Option<&Point>, other: Option<&Point>) -> bool {
    one.zip(other).is_some_and(|(one, other)| (other - one).norm() < ROUNDING)
}

/// Whether one line begins where the other ends.
fn follow_each_other(one: &[Point], other: &[Point]) -> bool {
    are_same(one.last(), other.first()) || are_same(one.first(), other.last())
}

/// Whether two lines either begin or end in the same place, but not both.
fn meet_at_one_end(one: &[Point], other: &[Point]) -> bool {
    are_same(one.first(), other.first()) != are_same(one.last(), other.last())
}

/// Whether two lines cross.
fn cross_each_other(one: &[Point], other: &[Point]) -> bool {
    one.windows(2).any(|a| {
        other.windows(2).any(|b| {
            let side = |line: &[Point], point: Point| cross(&(line[1] - line[0]), &(point - line[0])) < 0.0;
            side(a, b[0]) != side(a, b[1]) && side(b, a[0]) != side(b, a[1])
        })
    })
}
