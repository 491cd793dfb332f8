//! Which lane is at a place: lanes in groups of neighbours, with a box around each group.
//!
//! Asked only for conflicts whose ego is on no path along lanes (it stands, or paths are straight), so the groups are
//! made when they are first asked for. A tree over the pieces of all lanes takes 30 times the memory.

use super::{Lane, LaneIndex};
use crate::geometry::{Bounds, Point};
use crate::units::Metre;

/// A place further than this from any lane's centre line is on none, in m.
const REACH: Metre = 10.0;
/// How many lanes are in a group: few enough to be looked at one by one, so many that there are few groups.
const GROUP: usize = 4;

/// Finds lanes by place.
#[derive(Clone, Debug)]
pub(super) struct Finder {
    lanes: Vec<LaneIndex>,
    /// Around each [`GROUP`] of them.
    bounds: Vec<Bounds>,
}

impl Finder {
    pub(super) fn new(lanes: &[Lane]) -> Self {
        let middles = lanes.iter().map(|lane| nalgebra::center(&bounds(lane).low, &bounds(lane).high));
        let mut order = (0..).map(LaneIndex).zip(middles).collect::<Vec<_>>();
        // In columns from left to right, and within a column upwards (Leutenegger et al. 1997).
        order.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
        let columns = (lanes.len() as f64 / GROUP as f64).sqrt().ceil().max(1.0) as usize;
        for column in order.chunks_mut(lanes.len().div_ceil(columns).max(1)) {
            column.sort_by(|a, b| a.1.y.total_cmp(&b.1.y));
        }
        let lanes_in_order = order.into_iter().map(|(lane, _)| lane).collect::<Vec<_>>();
        let around = |group: &[LaneIndex]| {
            group.iter().fold(Bounds::EMPTY, |mut around, lane| {
                around.join(&bounds(&lanes[lane.0 as usize]));
                around
            })
        };
        Self { bounds: lanes_in_order.chunks(GROUP).map(around).collect(), lanes: lanes_in_order }
    }

    /// The lane whose centre line is nearest; of two at the same distance the first of the net.
    pub(super) fn lane_at(&self, lanes: &[Lane], place: Point) -> Option<LaneIndex> {
        let window = Bounds { low: place, high: place }.grown(REACH);
        let groups = self.lanes.chunks(GROUP).zip(&self.bounds).filter(|(_, bounds)| bounds.meet(&window));
        let distances =
            groups.flat_map(|(group, _)| group).map(|&lane| (distance(&lanes[lane.0 as usize], place), lane));
        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.filter(|(distance, _)| *distance <= REACH).map(|(_, lane)| lane)
    }
}

fn bounds(lane: &Lane) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    lane.shape.iter().for_each(|point| bounds.include(*point));
    bounds
}

/// The distance of a place from a lane's centre line.
fn distance(lane: &Lane, place: Point) -> Metre {
    let pieces = lane.shape.windows(2).map(|ends| {
        let along = ends[1] - ends[0];
        let part = (place - ends[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        (place - (ends[0] + along * part.clamp(0.0, 1.0))).norm()
    });
    pieces.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::geometry::Vector;
    use crate::net::Net;

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
