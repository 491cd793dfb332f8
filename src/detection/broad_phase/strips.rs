//! The order of the boxes: in strips along x, each at least as high as the highest box, and within a strip by x. Boxes
//! much larger than the mean, or too far away, come after all strips and are compared with every box before them.

use std::iter::repeat_n;

use super::extent::{Extent, FURTHEST, is_far};
use super::place::{StripEntry, insert};
use super::{Search, Slot};
use crate::geometry::Vector;
use crate::util::threads::{Team, share};
use crate::util::units::Metre;

/// A box larger than this many mean ones has no strip: it would make all strips high.
const LARGE: f64 = 2.5;
/// At most one box in this many has no strip, as each is compared with all others. Where more are large, strips are higher.
const SHARE_OF_LARGE: usize = 1000;
/// Lowest strip, in m.
const LOWEST_STRIP: Metre = 1.0;

/// Strips keep their height until they are more than this many times as high as needed.
const SPARE_HEIGHT: f64 = 2.0;
/// Few road users overtake within a step, so the order is nearly sorted: insertion sort is given up after this many
/// moves per road user.
const MOVES: usize = 32;

impl<S: Slot> Search<S> {
    /// Sorts the current areas.
    pub(super) fn sort(&mut self, team: &Team) {
        let (all, count) = (self.all_parts(), self.places.len());
        (self.largest, self.has_round) = (all.largest, all.round);
        let mut limit = LARGE * (all.sum / count.max(1) as f64).max(LOWEST_STRIP);
        while limit < all.largest.max().min(FURTHEST) && self.are_large(limit, count / SHARE_OF_LARGE + 2) {
            limit *= 2.0;
        }
        if all.far || all.largest.max() > limit {
            self.part_large(limit);
        }
        self.sort_in_strips(team);
        self.in_strips = self.places.len();
        self.places.append(&mut self.large);
    }

    fn all_parts(&self) -> Extent {
        self.parts.iter().fold(Extent::EMPTY, Extent::join)
    }

    /// Whether at least `many` boxes are larger than `limit`.
    fn are_large(&self, limit: Metre, many: usize) -> bool {
        self.boxes.iter().filter(|laid| laid.size().max() > limit).nth(many - 1).is_some()
    }

    /// Sets aside the boxes larger than `limit` and those too far away for a strip. The others keep their order.
    fn part_large(&mut self, limit: Metre) {
        let mut largest = Vector::zeros();
        let Self { places, boxes, large, .. } = self;
        places.retain(|place| {
            let laid = &boxes[place.slot as usize];
            let size = laid.size();
            if size.max() <= limit && !is_far(laid) {
                largest = size.sup(&largest);
                return true;
            }
            large.push(*place);
            false
        });
        self.largest = largest;
    }

    /// Sorts the boxes by strip, and within a strip along x. Two boxes that meet are then in the same strip or in
    /// neighbouring ones.
    fn sort_in_strips(&mut self, team: &Team) {
        let least = self.largest.y.max(LOWEST_STRIP);
        if (least..=SPARE_HEIGHT * least).contains(&self.strip_height) {
            if self.is_nearly_sorted(team) {
                return;
            }
        } else {
            self.strip_height = SPARE_HEIGHT.sqrt() * least;
            let per_metre = 1.0 / self.strip_height;
            self.places.iter_mut().for_each(|place| place.follow(&self.boxes, per_metre));
        }
        // A full sort invalidates the order of the slots: reassign them in the next step.
        self.moved = usize::MAX;
        self.sorted_anew += 1;
        self.places.sort_unstable_by(|a, b| a.strip.cmp(&b.strip).then(a.begin.total_cmp(&b.begin)));
    }

    /// Updates the entries and sorts them by insertion, each thread its part. Returns `false` where that takes too many
    /// moves.
    fn is_nearly_sorted(&mut self, team: &Team) -> bool {
        let (boxes, per_metre, count) = (&self.boxes, 1.0 / self.strip_height, self.places.len());
        let busy = team.busy(count);
        let mut sorted = share(busy, count);
        let mut sort = |length: usize, sort: &(dyn Fn(&mut [StripEntry], &mut usize) -> bool + Sync)| {
            self.parts.clear();
            self.parts.resize(count.div_ceil(length), Extent::EMPTY);
            let parts = self.parts.iter_mut().zip(self.places.chunks_mut(length));
            team.each(repeat_n((), busy), parts, |(), (part, places)| {
                let most = MOVES * places.len();
                let mut moves = most;
                part.sorted = sort(places, &mut moves);
                part.moved = most - moves;
            });
            let all = self.parts.iter().fold(Extent::EMPTY, Extent::join);
            self.moved += all.moved;
            let starts_before = |part: usize| self.places[part].is_before(&self.places[part - 1]);
            all.sorted.then(|| !(length..count).step_by(length).any(starts_before))
        };
        // None where it takes too many moves; otherwise whether the parts are in order, too.
        let mut in_order = sort(sorted, &|places, moves| {
            places.iter_mut().for_each(|place| place.follow(boxes, per_metre));
            (1..places.len()).all(|place| insert(places, place, moves))
        });
        // Pairs of neighbouring parts are joined, then pairs of these.
        while in_order == Some(false) {
            in_order = sort(2 * sorted, &|places, moves| {
                // Both are sorted, so only the first entries of the second may belong into the first.
                let mut place = sorted;
                while place < places.len() && places[place].is_before(&places[place - 1]) {
                    if !insert(places, place, moves) {
                        return false;
                    }
                    place += 1;
                }
                true
            });
            sorted *= 2;
        }
        in_order.is_some()
    }
}
