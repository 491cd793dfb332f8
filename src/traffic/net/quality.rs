//! Where a net is not drawn as it is driven, in a line for the start of a run.

use super::corners::cut_corners;
use super::elements::{EdgeFunction, LaneIndex};
use super::network::Net;
use super::overlaps::{Overlap, Overlaps, ROUNDING};
use crate::util::remark::{Remark, RemarkCode};
use crate::util::units::Metre;

/// The largest difference of a lane's length from its shape's that goes without saying, as a part of the longer.
const LENGTHS_DIFFER: f64 = 0.05;
/// A smaller difference goes without saying, in m; SUMO's junction lanes are this long even if drawn as a point.
const SHORTEST: Metre = 0.1;
/// The number of places that a remark names.
const NAMED: usize = 3;

impl Net {
    /// Where it is not drawn as it is driven: a line for each way in which it is not. Road users that overlap by up to the
    /// tolerance do not collide.
    pub fn remarks(&self, overlaps: &Overlaps, tolerance: Metre) -> Vec<Remark> {
        let found = [
            (RemarkCode::LaneLengths, lengths(self)),
            (RemarkCode::LanesOverlap, overlapping(self, overlaps)),
            (RemarkCode::CornersCut, corners(self, tolerance)),
        ];
        found.into_iter().filter_map(|(code, text)| Some(Remark::new(code, text?))).collect()
    }
}

/// How many lanes are longer or shorter than their shape by more than 5 % (and 10 cm), and the worst of them; none where
/// none is.
///
/// SUMO's drivers see distances along the lanes, rectangles stand where lanes are drawn. Such lengths come from curves with
/// several lanes, which all have their edge's length, from map matching and from edited nets.
pub fn lengths(net: &Net) -> Option<String> {
    let is_driven = |lane: &LaneIndex| {
        let edge = net.lanes[*lane].edge;
        matches!(net.edges[edge].function, EdgeFunction::Normal | EdgeFunction::Internal)
    };
    let lanes = net.lanes.keys().filter(is_driven);
    let (mut all, mut differ) = (0_u32, 0_u32);
    let mut worst = (0.0, LaneIndex(0));
    for lane in lanes {
        all += 1;
        let (length, drawn) = (net.lanes[lane].length, net.drawn_length(lane));
        let difference = (length - drawn).abs();
        if difference > SHORTEST && difference > LENGTHS_DIFFER * length.max(drawn) {
            differ += 1;
            if difference > worst.0 {
                worst = (difference, lane);
            }
        }
    }
    let are = if differ == 1 { "is" } else { "are" };
    let lane = &net.lanes[worst.1];
    let (id, length, drawn) = (&lane.id, lane.length, net.drawn_length(worst.1));
    (differ > 0).then(|| {
        format!(
            "{differ} of {all} lanes {are} longer or shorter than drawn by more than 5 %; the worst is {id}: {length:.1} m, drawn \
             {drawn:.1} m"
        )
    })
}

/// How many pairs of lanes overlap as drawn, and the worst of them; none where none does.
pub fn overlapping(net: &Net, overlaps: &Overlaps) -> Option<String> {
    let named = named(net, overlaps.places())?;
    Some(match overlaps.places().len() {
        1 => format!("2 lanes overlap as drawn: {named}"),
        count => format!("{count} pairs of lanes overlap as drawn, the worst first: {named}"),
    })
}

/// At how many places vehicles cut a corner of a pavement as drawn by more than this, and the worst of them; none where they
/// do not.
fn corners(net: &Net, tolerance: Metre) -> Option<String> {
    let places = cut_corners(net, tolerance.max(ROUNDING));
    let named = named(net, &places)?;
    Some(match places.len() {
        1 => format!("on a junction lane vehicles cut the corner of a pavement as drawn: {named}"),
        count => {
            format!("on {count} junction lanes vehicles cut corners of pavements as drawn, the worst first: {named}")
        }
    })
}

/// The worst places; empty without places.
fn named(net: &Net, places: &[Overlap]) -> Option<String> {
    let name = |place: &Overlap| {
        let (one, other) = place.lanes;
        format!("{} and {} by {:.2} m", net.lane_id(one), net.lane_id(other), place.depth)
    };
    let named = places.iter().take(NAMED).map(name).collect::<Vec<_>>().join(", ");
    let more = if places.len() > NAMED { ", …" } else { "" };
    (!places.is_empty()).then(|| named + more)
}
