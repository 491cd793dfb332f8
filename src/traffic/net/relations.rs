//! Which lanes SUMO relates: drivers on two that it does not relate never take account of each other.

use super::elements::{EdgeFunction, LaneIndex, Link};
use super::network::Net;
use crate::util::units::Metre;

/// Two lanes whose ends are this near to each other, in opposite order, are one line in both directions, in m.
const SAME_END: Metre = 1.0;

impl Net {
    /// Whether drivers on two lanes take account of each other: on the same one, where one follows the other, where both come
    /// from or lead to one lane, where their links are foes in the junction's request matrix, and on a line in both
    /// directions.
    pub fn relates(&self, one: LaneIndex, other: LaneIndex) -> bool {
        if one == other || self.follows(one, other) || self.follows(other, one) || self.are_opposite(one, other) {
            return true;
        }
        match [one, other].map(|lane| self.passage(lane)) {
            [Some(a), Some(b)] => {
                a.from == b.from
                    || a.to == b.to
                    || [a.to == b.from, b.to == a.from].contains(&true)
                    || (a.junction == b.junction && self.junctions[a.junction as usize].are_foes(a.link, b.link))
            }
            [Some(passage), None] => [passage.from, passage.to].contains(&other),
            [None, Some(passage)] => [passage.from, passage.to].contains(&one),
            [None, None] => {
                let [a, b] = [one, other].map(|lane| &self.lanes[lane]);
                let leads_to = |link: &Link| b.links.iter().any(|of| of.to == link.to && of.via.is_none());
                a.from.iter().any(|from| b.from.contains(from))
                    || a.links.iter().any(|link| link.via.is_none() && leads_to(link))
            }
        }
    }

    /// Whether a lane leads directly to another.
    pub(crate) fn follows(&self, from: LaneIndex, to: LaneIndex) -> bool {
        self.lanes[from].links.iter().any(|link| link.via.unwrap_or(link.to) == to || link.to == to)
    }

    /// Whether two lanes are one line in both directions.
    pub fn are_opposite(&self, one: LaneIndex, other: LaneIndex) -> bool {
        let ends = [one, other].map(|lane| {
            let shape = &self.lanes[lane].shape;
            shape.first().zip(shape.last())
        });
        let [Some((begin, end)), Some((other_begin, other_end))] = ends else { return false };
        (begin - other_end).norm() < SAME_END && (end - other_begin).norm() < SAME_END
    }

    /// Whether a lane is within a junction.
    pub fn is_internal(&self, lane: LaneIndex) -> bool {
        self.function(lane) == EdgeFunction::Internal
    }
}
