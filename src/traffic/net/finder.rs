//! Finds the lane at a place, by parry2d's bounding-volume tree.
//!
//! The leaves are whole lanes: in sumo_nets/town, lanes have three times as many segments.

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy};

use super::elements::{Lane, LaneIndex};
use crate::geometry::{Bounds, Point, parry};
use crate::util::units::Metre;

/// A place further than this from every centre line is on no lane, in m.
const REACH: Metre = 10.0;

/// Finds lanes by place.
#[derive(Clone, Debug, Default)]
pub(super) struct Finder {
    tree: Bvh,
}

impl Finder {
    pub(super) fn new(lanes: &[Lane]) -> Self {
        let boxes = lanes.iter().map(|lane| aabb(&lane.bounds())).collect::<Vec<_>>();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// The lanes whose bounds meet these.
    pub(super) fn lanes_in<'a>(&'a self, bounds: &'a Aabb) -> impl Iterator<Item = LaneIndex> + 'a {
        self.tree.intersect_aabb(bounds).map(LaneIndex)
    }

    /// The lanes that a place is on, or within a distance of, in no particular order; lanes wider than [`REACH`] only as far
    /// as that.
    pub(super) fn lanes_at(&self, lanes: &[Lane], place: Point, within: Metre) -> impl Iterator<Item = LaneIndex> {
        let window = aabb(&Bounds { low: place, high: place }.grown(REACH));
        let near = self.tree.intersect_aabb(&window).map(LaneIndex).collect::<Vec<_>>().into_iter();
        near.filter(move |lane| {
            let lane = &lanes[lane.0 as usize];
            distance(lane, place) <= (lane.width / 2.0 + within).min(REACH)
        })
    }

    /// The lane with the nearest centre line; if equal, the first of the net.
    pub(super) fn lane_at(&self, lanes: &[Lane], place: Point) -> Option<LaneIndex> {
        let window = aabb(&Bounds { low: place, high: place }.grown(REACH));
        let near = self.lanes_in(&window).map(|lane| (distance(&lanes[lane.0 as usize], place), lane));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.filter(|(distance, _)| *distance <= REACH).map(|(_, lane)| lane)
    }
}

/// Bounds as the finder takes them.
pub(super) fn aabb(bounds: &Bounds) -> Aabb {
    Aabb::new(parry::vector(bounds.low), parry::vector(bounds.high))
}

/// The distance of a place from a lane's centre line.
pub(super) fn distance(lane: &Lane, place: Point) -> Metre {
    let pieces = lane.shape.windows(2).map(|ends| {
        let along = ends[1] - ends[0];
        let part = (place - ends[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        (place - (ends[0] + along * part.clamp(0.0, 1.0))).norm()
    });
    pieces.fold(f64::INFINITY, f64::min)
}

/// The distance of a place from a line, if it is neither before its beginning nor beyond its end.
pub(super) fn distance_beside(line: &[Point], place: Point) -> Metre {
    let last = line.len() - 2;
    let pieces = line.windows(2).enumerate().filter_map(|(number, ends)| {
        let along = ends[1] - ends[0];
        let part = (place - ends[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        let is_outside = (number == 0 && part < 0.0) || (number == last && part > 1.0);
        (!is_outside).then(|| (place - (ends[0] + along * part.clamp(0.0, 1.0))).norm())
    });
    pieces.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::geometry::Vector;
    use crate::traffic::net::Net;
    use crate::traffic::net::finder::*;

    #[test]
    fn the_lane_found_is_the_nearest_of_all_lanes() {
        let net = Net::read(Path::new("sumo_nets/town/town.net.xml")).unwrap();
        let finder = Finder::new(&net.lanes);
        let asides = [(0.0, 0.0), (7.0, -7.5), (-9.0, 4.0), (3.0, 30.0)].map(|(x, y)| Vector::new(x, y));
        let mut found = 0;
        for (place, aside) in net.lanes.iter().map(|lane| lane.shape[1]).zip(asides.into_iter().cycle()) {
            let place = place + aside;
            let of_all = (0..).map(LaneIndex).zip(&net.lanes).map(|(index, lane)| (distance(lane, place), index));
            let nearest = of_all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(distance, _)| *distance <= REACH);
            assert_eq!(finder.lane_at(&net.lanes, place), nearest.map(|(_, lane)| lane));
            found += usize::from(nearest.is_some());
        }
        assert!((100..net.lanes.len()).contains(&found), "{found}");
    }
}
