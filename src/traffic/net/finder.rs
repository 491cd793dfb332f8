//! Finds the lane at a place, by parry2d's bounding-volume tree.
//!
//! The leaves are whole lanes: in sumo_nets/town, lanes have three times as many segments.

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy};
use typed_index_collections::TiSlice;

use super::elements::{Lane, LaneIndex};
use crate::geometry::{Bounds, Point, parry};
use crate::util::units::Metre;

/// A place further than this from every centre line is on no lane, in m.
pub const REACH: Metre = 10.0;

/// Finds lanes by place.
#[derive(Clone, Debug, Default)]
pub struct Finder {
    tree: Bvh,
}

impl Finder {
    /// A finder of these lanes.
    pub fn new(lanes: &TiSlice<LaneIndex, Lane>) -> Self {
        let boxes = lanes.iter().map(|lane| aabb(&lane.bounds())).collect::<Vec<_>>();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// The lanes whose bounds meet these.
    pub(crate) fn lanes_in<'a>(&'a self, bounds: &'a Aabb) -> impl Iterator<Item = LaneIndex> + 'a {
        self.tree.intersect_aabb(bounds).map(LaneIndex)
    }

    /// The lanes that a place is on, or within a distance of, in no particular order; lanes wider than [`REACH`] only as far
    /// as that.
    pub fn lanes_at(
        &self,
        lanes: &TiSlice<LaneIndex, Lane>,
        place: Point,
        within: Metre,
    ) -> impl Iterator<Item = LaneIndex> {
        let window = aabb(&Bounds { low: place, high: place }.grown(REACH));
        let near = self.tree.intersect_aabb(&window).map(LaneIndex).collect::<Vec<_>>().into_iter();
        near.filter(move |lane| {
            let lane = &lanes[*lane];
            distance(lane, place) <= (lane.width / 2.0 + within).min(REACH)
        })
    }

    /// The lane with the nearest centre line; if equal, the first of the net.
    pub fn lane_at(&self, lanes: &TiSlice<LaneIndex, Lane>, place: Point) -> Option<LaneIndex> {
        let window = aabb(&Bounds { low: place, high: place }.grown(REACH));
        let near = self.lanes_in(&window).map(|lane| (distance(&lanes[lane], place), lane));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.filter(|(distance, _)| *distance <= REACH).map(|(_, lane)| lane)
    }
}

/// Bounds as the finder takes them.
pub(crate) fn aabb(bounds: &Bounds) -> Aabb {
    Aabb::new(parry::vector(bounds.low), parry::vector(bounds.high))
}

/// The distance of a place from a lane's centre line.
pub fn distance(lane: &Lane, place: Point) -> Metre {
    let pieces = lane.shape.windows(2).map(|ends| {
        let along = ends[1] - ends[0];
        let part = (place - ends[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        (place - (ends[0] + along * part.clamp(0.0, 1.0))).norm()
    });
    pieces.fold(f64::INFINITY, f64::min)
}

/// The distance of a place from a line, if it is neither before its beginning nor beyond its end.
pub(crate) fn distance_beside(line: &[Point], place: Point) -> Metre {
    let last = line.len() - 2;
    let pieces = line.windows(2).enumerate().filter_map(|(number, ends)| {
        let along = ends[1] - ends[0];
        let part = (place - ends[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        let is_outside = (number == 0 && part < 0.0) || (number == last && part > 1.0);
        (!is_outside).then(|| (place - (ends[0] + along * part.clamp(0.0, 1.0))).norm())
    });
    pieces.fold(f64::INFINITY, f64::min)
}
