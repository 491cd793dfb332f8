//! Corners of pavements that vehicles cut as drawn.
//!
//! SUMO's drivers yield to persons on crossings; they do not see those on a walking area, where pavements and crossings
//! meet. Where a junction lane is drawn nearer to a walking area than half a vehicle is wide, each vehicle there drives
//! over the corner, even if a person stands on it.

use rustc_hash::FxHashMap;

use super::elements::{EdgeFunction, Lane, LaneIndex};
use super::finder::aabb;
use super::network::Net;
use super::overlaps::{Overlap, VEHICLE_WIDTH};
use crate::geometry::outline::{is_inside, sides};
use crate::geometry::{Bounds, Point};
use crate::util::units::Metre;

/// How far beside a walking area a person on it may be, in m: SUMO's ways over it leave its outline. Of 148 persons on one in
/// critical conflicts of Bologna's acosta 21 are within it, 109 more within 2 m, and the others within this.
const BESIDE: Metre = 4.0;

impl Net {
    /// The walking area at a place, or the nearest just beside it.
    pub fn walking_area_at(&self, place: Point) -> Option<LaneIndex> {
        let away = |lane: LaneIndex| {
            let area = &self.lanes[lane].shape;
            let beside = || sides(area).map(|side| distance(side, place)).fold(f64::INFINITY, f64::min);
            if is_inside(sides(area), place) { 0.0 } else { beside() }
        };
        let window = aabb(&Bounds { low: place, high: place }.grown(BESIDE));
        let areas = self.finder.lanes_in(&window).filter(|lane| self.function(*lane) == EdgeFunction::WalkingArea);
        let near = areas.map(|lane| (away(lane), lane)).filter(|(away, _)| *away <= BESIDE);
        near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, lane)| lane)
    }
}

/// The walking areas and the junction lanes that cut them by more than a depth, the deepest first.
pub fn cut_corners(net: &Net, deeper_than: Metre) -> Vec<Overlap> {
    let mut driven = FxHashMap::<&str, Vec<LaneIndex>>::default();
    let mut areas = Vec::new();
    for (index, lane) in net.lanes.iter_enumerated() {
        let edge = &net.edges[lane.edge];
        match edge.function {
            EdgeFunction::Internal if lane.has_vehicles => driven.entry(&edge.junction).or_default().push(index),
            EdgeFunction::WalkingArea => areas.push((index, edge.junction.as_str())),
            _ => {}
        }
    }
    let mut places = Vec::new();
    for (area, junction) in areas {
        for other in driven.get(junction).into_iter().flatten() {
            let depth = reach(&net.lanes[area].shape, &net.lanes[*other]);
            // Deeper, the area lies across the road: persons cross there.
            if depth > deeper_than && depth <= VEHICLE_WIDTH {
                places.push(Overlap { lanes: (area, *other), depth });
            }
        }
    }
    places.sort_by(|a, b| b.depth.total_cmp(&a.depth).then(a.lanes.cmp(&b.lanes)));
    places
}

/// How far a vehicle on a lane reaches into an area; 0 or less if it does not.
fn reach(area: &[Point], lane: &Lane) -> Metre {
    let half = lane.width.min(VEHICLE_WIDTH) / 2.0;
    let from_outline = |point| sides(area).map(|side| distance(side, point)).fold(f64::INFINITY, f64::min);
    let within = lane.shape.iter().filter(|point| is_inside(sides(area), **point)).map(|point| from_outline(*point));
    if let Some(deepest) = within.reduce(f64::max) {
        return half + deepest;
    }
    let of_lane = lane.shape.iter().map(|point| from_outline(*point));
    let pieces = || lane.shape.windows(2).map(|piece| [piece[0], piece[1]]);
    let of_area = area.iter().flat_map(|corner| pieces().map(|piece| distance(piece, *corner)));
    half - of_lane.chain(of_area).fold(f64::INFINITY, f64::min)
}

/// The distance of a place from a piece of a line.
fn distance([from, to]: [Point; 2], place: Point) -> Metre {
    let along = to - from;
    let part = (place - from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    (place - (from + along * part.clamp(0.0, 1.0))).norm()
}
