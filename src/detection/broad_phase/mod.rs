//! Phase 1, pre-collision ("radar"): which pairs are near enough that they might meet.
//!
//! The paper (eq. 4) tests the distance to every other vehicle against the ego's detection radius. Here each road
//! user has an area that holds everything it may cover until it stands: where its way is known, straight on or along its
//! lanes, the box around that, else a circle around its centre. A pair is kept where two areas meet, so no pair that is
//! an encounter is dropped.
//!
//! Which areas to compare: their boxes are sorted into strips along x, each as high as the highest of them, and within
//! a strip by x. From every box the sweep looks ahead in its own strip and to both sides in the next (sweep and prune,
//! Cohen et al. 1995, in strips, so that a wide scene does not make it quadratic). `closecall study --only candidates`
//! compares it with all pairs, a grid, a plain sweep, parry2d's and rstar's trees.

mod area;
mod extent;
mod pair_buffer;
mod place;
mod slot;
mod strips;

use std::iter::repeat_n;
use std::ops::Range;

use crate::geometry::{Bounds, Vector};
use crate::util::threads::{Team, share};
use crate::util::units::Metre;
use extent::Extent;
use pair_buffer::Near;
use place::{Place, length};

pub use area::{Area, Circle};
pub use slot::Slot;

/// Until road users have changed places so often, on average, everybody stays in its slot, as long as they are as many: who
/// has moved meanwhile is hardly further from those next to it in memory, and what its slot knows of it holds.
const STAY: usize = 128;

/// So many items are seen one after the other before their areas are asked for: the processor waits for memory once.
const BLOCK: usize = 64;

/// Finds the pairs of areas whose boxes meet; keeps its memory, and the order that it found, from step to step.
#[derive(Default)]
pub struct Search<S> {
    /// Those in strips, sorted; then the large ones.
    places: Vec<Place>,
    /// By slot, a box around its area.
    boxes: Vec<Bounds>,
    /// Whether any area is smaller than its box.
    has_round: bool,
    slots: Vec<S>,
    /// How often any two have changed places since slots were given.
    moved: usize,
    /// Which items have a slot already; only while slots are given.
    given: Vec<bool>,
    in_strips: usize,
    strip_height: Metre,
    /// Length along x of the longest box that has a strip, and the largest height.
    largest: Vector,
    large: Vec<Place>,
    parts: Vec<Extent>,
}

impl Search<u32> {
    /// Puts the index pairs (smaller first) of all areas that meet into `pairs`, in no particular order.
    pub fn pairs(&mut self, areas: &[Area], pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        let item_of = |who: u32| Some(who).filter(|who| (*who as usize) < areas.len());
        self.lay(areas.len(), &Team::default(), true, item_of, |_| (), |(), item| areas[*item as usize]);
        self.sweep(0..areas.len(), |a, b| {
            let (a, b) = (self.slots[a as usize], self.slots[b as usize]);
            if areas[a as usize].meets(&areas[b as usize]) {
                pairs.push((a.min(b), a.max(b)));
            }
        });
    }
}

impl<S: Slot> Search<S> {
    /// What stands in the slots of this step.
    pub fn slots(&self) -> &[S] {
        &self.slots
    }

    /// Whether the area of somebody in this step is smaller than its box: two whose boxes meet may be apart.
    pub fn has_round(&self) -> bool {
        self.has_round
    }

    /// Gives each of so many items, numbered from 0, its place, by the threads of a team. `item_of` says which of
    /// them belongs to whom a slot knows; `are_same`, whether they are likely to be those of the last step, in the same order. `see`
    /// fetches what is said of an item, `area` says where that is now and keeps what else is known of it in its slot. Slots
    /// are in the order in which a step shortly before ended: those that meet are near each other.
    pub fn lay<Seen: Copy + Default>(
        &mut self,
        count: usize,
        team: &Team,
        are_same: bool,
        item_of: impl Fn(u32) -> Option<u32>,
        see: impl Fn(u32) -> Seen + Sync,
        area: impl Fn(&Seen, &mut S) -> Area + Sync,
    ) {
        if self.places.len() != count || self.moved >= STAY * count || !are_same {
            self.hold(count, item_of);
        }
        let busy = team.busy(count);
        let share = share(busy, count);
        self.parts.clear();
        self.parts.resize(count.div_ceil(share), Extent::EMPTY);
        let parts = self.parts.iter_mut().zip(self.boxes.chunks_mut(share)).zip(self.slots.chunks_mut(share));
        team.each(repeat_n((), busy), parts, |(), ((part, boxes), slots)| {
            let mut all = Extent::EMPTY;
            let mut block = [Seen::default(); BLOCK];
            for (boxes, slots) in boxes.chunks_mut(BLOCK).zip(slots.chunks_mut(BLOCK)) {
                block.iter_mut().zip(&*slots).for_each(|(seen, slot)| *seen = see(slot.item()));
                for ((seen, slot), laid) in block.iter().zip(slots).zip(boxes) {
                    let area = area(seen, slot);
                    *laid = area.bounds;
                    all.include(laid);
                    all.round |= area.is_round();
                }
            }
            *part = all;
        });
        self.sort(team);
    }

    /// Gives each of so many items a slot: whoever was there in the order in which the last step ended, then the others.
    fn hold(&mut self, count: usize, item_of: impl Fn(u32) -> Option<u32>) {
        let Self { places, boxes, slots, given, .. } = self;
        given.clear();
        given.resize(count, false);
        let mut is_first = |item: u32| !std::mem::replace(&mut given[item as usize], true);
        // A place says which item its slot is for, until all have one.
        places.retain_mut(|place| {
            let item = item_of(slots[place.slot as usize].who()).filter(|item| is_first(*item));
            place.slot = item.unwrap_or_default();
            item.is_some()
        });
        let others = (0..count as u32).filter(|item| is_first(*item));
        places.extend(others.map(|item| Place { begin: 0.0, strip: 0, slot: item }));
        slots.resize(count, S::default());
        boxes.resize(count, Bounds::EMPTY);
        for ((number, place), slot) in (0..).zip(places).zip(slots) {
            slot.give(place.slot);
            place.slot = number;
        }
        self.moved = 0;
    }

    /// From each of these of the sorted places ahead in its own strip, and to both sides in the next; from a large one
    /// at everybody before it. `found` gets the slots of two whose boxes meet.
    pub fn sweep(&self, from: Range<usize>, mut found: impl FnMut(u32, u32)) {
        let (in_strips, large) = self.places.split_at(self.in_strips);
        let laid = |place: &Place| &self.boxes[place.slot as usize];
        let mut near = Near::new(&self.boxes);
        let mut start = from.start;
        while start < from.end.min(in_strips.len()) {
            let strip = in_strips[start].strip;
            let (own, others) = in_strips.split_at(start + length(&in_strips[start..], strip));
            let above = &others[..length(others, strip + 1)];
            let reaches = |a: &Place| a.begin - self.largest.x;
            let mut behind = above.partition_point(|b| b.begin < reaches(&own[start]));
            for place in start..own.len().min(from.end) {
                let a = &own[place];
                let end = laid(a).high.x;
                near.note(a, own[place + 1..].iter().take_while(|b| b.begin <= end), &mut found);
                let begin = reaches(a);
                behind += above[behind..].iter().take_while(|b| b.begin < begin).count();
                near.note(a, above[behind..].iter().take_while(|b| b.begin <= end), &mut found);
            }
            start = own.len();
        }
        near.tell(&mut found);
        for place in from.start.max(in_strips.len())..from.end {
            let a = &large[place - in_strips.len()];
            let meets = |b: &&Place| laid(a).meet(laid(b));
            self.places[..place].iter().filter(meets).for_each(|b| found(a.slot, b.slot));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::detection::broad_phase::*;
    use crate::geometry::Point;
    use proptest::prelude::*;

    fn all_pairs(areas: &[Area]) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        for i in 0..areas.len() {
            for j in i + 1..areas.len() {
                if areas[i].meets(&areas[j]) {
                    pairs.push((i as u32, j as u32));
                }
            }
        }
        pairs
    }

    #[derive(Clone, Default)]
    struct Known {
        item: u32,
        who: u32,
    }

    impl Slot for Known {
        fn item(&self) -> u32 {
            self.item
        }

        fn give(&mut self, item: u32) {
            self.item = item;
        }

        fn who(&self) -> u32 {
            self.who
        }
    }

    /// What the search finds, swept in this many parts, in order.
    fn found(search: &mut Search<Known>, areas: &[Area], who: &[u32], parts: usize) -> Vec<(u32, u32)> {
        let (count, mut pairs) = (areas.len(), Vec::new());
        let area = |(): &(), known: &mut Known| {
            known.who = who[known.item as usize];
            areas[known.item as usize]
        };
        let item_of = |known| who.iter().position(|who| *who == known).map(|item| item as u32);
        search.lay(count, &Team::new(parts), true, item_of, |_| (), area);
        let share = count.div_ceil(parts).max(1);
        for start in (0..count).step_by(share) {
            search.sweep(start..(start + share).min(count), |a, b| {
                let (a, b) = (search.slots[a as usize].item, search.slots[b as usize].item);
                if areas[a as usize].meets(&areas[b as usize]) {
                    pairs.push((a.min(b), a.max(b)));
                }
            });
        }
        pairs.sort_unstable();
        pairs
    }

    fn size() -> impl Strategy<Value = f64> {
        prop_oneof![0.5..5.0, 5.0..80.0, Just(5e3)]
    }

    proptest! {
        #[test]
        fn none_is_lost_from_step_to_step_whoever_comes_and_goes(
            starts in prop::collection::vec((-300.0..300.0, -300.0..300.0, -9.0..9.0, -9.0..9.0, 0.5..20.0), 0..60),
            changes in prop::collection::vec(prop::option::weighted(0.3, (any::<usize>(), any::<bool>())), 40),
        ) {
            let mut search = Search::default();
            let mut cars: Vec<_> = (0..).zip(starts).collect();
            for (step, change) in (1000..).zip(changes) {
                for (_, (x, y, along, up, _)) in &mut cars {
                    (*x, *y) = (*x + *along, *y + *up);
                }
                match change {
                    // Now and then one that is there already.
                    Some((place, true)) => {
                        let who = if place % 5 == 0 { 3 } else { step };
                        cars.insert(place % (cars.len() + 1), (who, (f64::from(step % 300), 0.0, 1.0, -1.0, 9.0)));
                    }
                    Some((place, false)) if !cars.is_empty() => _ = cars.remove(place % cars.len()),
                    _ => {}
                }
                let area = |&(_, (x, y, _, _, radius)): &(u32, (f64, f64, f64, f64, f64))| Circle { x, y, radius }.into();
                let (areas, who): (Vec<_>, Vec<_>) = (cars.iter().map(area).collect(), cars.iter().map(|car| car.0).collect());
                prop_assert_eq!(found(&mut search, &areas, &who, 1), all_pairs(&areas));
            }
        }

        #[test]
        fn no_pair_is_lost_or_found_twice(
            places in prop::collection::vec((-300.0..300.0, -300.0..300.0, size(), size(), any::<bool>()), 0..60),
            origin in prop_oneof![Just(0.0), Just(1e7), Just(-4e5)],
            parts in 1_usize..5,
        ) {
            let area = |(x, y, length, width, straight)| {
                let (x, y) = (x + origin, y - origin);
                match straight {
                    true => Bounds { low: Point::new(x, y), high: Point::new(x + length, y + width) }.into(),
                    false => Circle { x, y, radius: length }.into(),
                }
            };
            let areas: Vec<_> = places.into_iter().map(area).collect();
            let who: Vec<_> = (0..areas.len() as u32).collect();
            prop_assert_eq!(found(&mut Search::default(), &areas, &who, parts), all_pairs(&areas));
        }
    }

    #[test]
    fn however_long_boxes_are_none_is_too_far_ahead_to_meet() {
        let [long, short] = [(0.0, 0.0, 3e7), (2.9e7, -1.0, 1.0)].map(|(x, y, radius)| Circle { x, y, radius }.into());
        let areas = [long, long, long, short];
        assert_eq!(found(&mut Search::default(), &areas, &[0, 1, 2, 3], 1), all_pairs(&areas));
    }

    #[test]
    fn an_absurd_radius_costs_no_memory() {
        let areas = [Circle { x: 0.0, y: 0.0, radius: 1e300 }, Circle { x: 1e9, y: 0.0, radius: 1.0 }].map(Area::from);
        assert_eq!(found(&mut Search::default(), &areas, &[0, 1], 1), [(0, 1)]);
    }
}
