//! Which lane is at a place: parry2d's bounding-volume tree over the pieces of all lanes.
//!
//! Asked only for conflicts whose ego is on no path along lanes (it stands, or paths are straight), so the tree is
//! built when it is first asked for.

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy};

use super::{Lane, LaneIndex};
use crate::geometry::{Bounds, Point, parry};
use crate::units::Metre;

/// A place further than this from any lane's centre line is on none, in m.
const REACH: Metre = 10.0;

/// Finds lanes by place.
#[derive(Clone, Debug)]
pub(super) struct Finder {
    tree: Bvh,
    pieces: Vec<(LaneIndex, u32)>,
}

impl Finder {
    pub(super) fn new(lanes: &[Lane]) -> Self {
        let pieces = (0..)
            .zip(lanes)
            .flat_map(|(index, lane)| (0..lane.shape.len() as u32 - 1).map(move |piece| (LaneIndex(index), piece)))
            .collect::<Vec<_>>();
        let boxes = pieces.iter().map(|&(lane, piece)| {
            let (start, end) = ends(lanes, lane, piece);
            Aabb::new(parry::vector(start.inf(&end)), parry::vector(start.sup(&end)))
        });
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes.collect::<Vec<_>>()), pieces }
    }

    /// The lane whose centre line is nearest.
    pub(super) fn lane_at(&self, lanes: &[Lane], place: Point) -> Option<LaneIndex> {
        let window = Bounds { low: place, high: place }.grown(REACH);
        let window = Aabb::new(parry::vector(window.low), parry::vector(window.high));
        let mut nearest: Option<(Metre, LaneIndex)> = None;
        for leaf in self.tree.intersect_aabb(&window) {
            let (lane, piece) = self.pieces[leaf as usize];
            let (start, end) = ends(lanes, lane, piece);
            let along = end - start;
            let part = (place - start).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
            let distance = (place - (start + along * part.clamp(0.0, 1.0))).norm();
            // Of two at the same distance the first of the net, in whatever order the tree gives them.
            if distance <= REACH && nearest.is_none_or(|known| (distance, lane) < known) {
                nearest = Some((distance, lane));
            }
        }
        nearest.map(|(_, lane)| lane)
    }
}

fn ends(lanes: &[Lane], lane: LaneIndex, piece: u32) -> (Point, Point) {
    let shape = &lanes[lane.0 as usize].shape;
    (shape[piece as usize], shape[piece as usize + 1])
}
