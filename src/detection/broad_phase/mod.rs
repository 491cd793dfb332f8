//! The broad phase (the paper's "pre-collision" phase, its radar): which pairs are near enough to meet.
//!
//! The paper (eq. 4) tests the distance to every other vehicle against the ego's detection radius. Here each road
//! user has an area that holds everything it may cover until it stands. Where its path is known, straight on or along
//! its lanes, the area is the box around that; otherwise it is a circle around the centre. A pair is kept where two
//! areas meet, so the broad phase drops no encounter.
//!
//! The boxes are sorted into strips along x, each at least as high as the highest box, and within a strip by x. From
//! every box the sweep looks ahead in its own strip and to both sides in the next one (sweep and prune, Cohen et al.
//! 1995; strips keep it from growing quadratic in a wide scene). `closecall study --only candidates`
//! compares it with all pairs, a grid, a plain sweep, parry2d's and rstar's trees.

mod area;
mod extent;
mod place;
mod slot;
mod strips;

use std::iter::repeat_n;
use std::ops::Range;

use crate::geometry::{Bounds, Vector};
use crate::util::index::make_room;
use crate::util::threads::{Team, share};
use crate::util::units::Metre;
use extent::Extent;
use place::{StripEntry, length};

pub use area::{Area, Circle};
pub use slot::Slot;

/// Slots are reassigned after this many swaps per road user, or when their number changes. Until then neighbours on
/// the road are still close in memory, and what a slot holds stays valid.
const STAY: usize = 128;

/// Items read one after the other before their areas are computed, so that their cache misses overlap.
const BLOCK: usize = 64;

/// Finds the pairs of areas whose boxes meet. Keeps its allocations and the sorted order between steps.
#[derive(Default)]
pub struct Search<S> {
    /// The boxes in strips, sorted, then the large ones.
    places: Vec<StripEntry>,
    /// By slot, the box of its area.
    boxes: Vec<Bounds>,
    /// Whether any area is smaller than its box.
    has_round: bool,
    slots: Vec<S>,
    /// Swaps since slots were assigned.
    moved: usize,
    /// How often the boxes were sorted anew, because too many had changed places.
    sorted_anew: u64,
    /// Which items have a slot already, while slots are assigned.
    given: Vec<bool>,
    in_strips: usize,
    strip_height: Metre,
    /// Largest length along x and largest height of a box that has a strip.
    largest: Vector,
    large: Vec<StripEntry>,
    parts: Vec<Extent>,
}

impl Search<u32> {
    /// Puts the index pairs (smaller first) of all areas that meet into `pairs`, in no particular order.
    pub fn pairs(&mut self, areas: &[Area], pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        let item_of = |who: u32| Some(who).filter(|who| (*who as usize) < areas.len());
        self.update(areas.len(), &Team::default(), true, item_of, |_| (), |(), item| areas[*item as usize]);
        self.sweep(0..areas.len(), |a, b| {
            let (a, b) = (self.slots[a as usize], self.slots[b as usize]);
            if areas[a as usize].meets(&areas[b as usize]) {
                pairs.push((a.min(b), a.max(b)));
            }
        });
    }
}

impl<S: Slot> Search<S> {
    /// The slots of this step.
    pub(crate) fn slots(&self) -> &[S] {
        &self.slots
    }

    /// Whether any area of this step is smaller than its box, so that two areas may be apart though their boxes meet.
    pub(crate) fn has_round(&self) -> bool {
        self.has_round
    }

    /// How often all boxes were sorted anew.
    pub fn sorted_anew(&self) -> u64 {
        self.sorted_anew
    }

    /// Updates the slot and the box of `count` items, numbered from 0, and sorts the boxes.
    ///
    /// `item_of` returns the item of a road user that has a slot. `are_same` tells that the items are probably those of
    /// the last step, in the same order. `see` reads an item; `area` returns its area and updates its slot. Slots keep
    /// the sorted order of a recent step, so that boxes that meet are close in memory.
    pub fn update<View: Copy + Default>(
        &mut self,
        count: usize,
        team: &Team,
        are_same: bool,
        item_of: impl Fn(u32) -> Option<u32>,
        see: impl Fn(u32) -> View + Sync,
        area: impl Fn(&View, &mut S) -> Area + Sync,
    ) {
        if self.places.len() != count || self.moved >= STAY * count || !are_same {
            self.assign_slots(count, item_of);
        }
        let busy = team.busy(count);
        let share = share(busy, count);
        self.parts.clear();
        self.parts.resize(count.div_ceil(share), Extent::EMPTY);
        let parts = self.parts.iter_mut().zip(self.boxes.chunks_mut(share)).zip(self.slots.chunks_mut(share));
        team.each(repeat_n((), busy), parts, |(), ((part, boxes), slots)| {
            let mut all = Extent::EMPTY;
            let mut block = [View::default(); BLOCK];
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

    /// Assigns the slots: first to the items of the last step in its sorted order, then to the others.
    fn assign_slots(&mut self, count: usize, item_of: impl Fn(u32) -> Option<u32>) {
        let Self { places, boxes, slots, given, .. } = self;
        given.clear();
        given.resize(count, false);
        let mut is_first = |item: u32| !std::mem::replace(&mut given[item as usize], true);
        // Until all items have a slot, `slot` holds the item.
        places.retain_mut(|place| {
            let item = item_of(slots[place.slot as usize].who()).filter(|item| is_first(*item));
            place.slot = item.unwrap_or_default();
            item.is_some()
        });
        make_room(places, count);
        make_room(slots, count);
        make_room(boxes, count);
        let others = (0..count as u32).filter(|item| is_first(*item));
        places.extend(others.map(|item| StripEntry { begin: 0.0, strip: 0, slot: item }));
        slots.resize(count, S::default());
        boxes.resize(count, Bounds::EMPTY);
        for ((number, place), slot) in (0..).zip(places).zip(slots) {
            slot.set_item(place.slot);
            place.slot = number;
        }
        self.moved = 0;
    }

    /// Sweeps from these boxes of the sorted order: ahead in their own strip and to both sides in the next. A large box
    /// is compared with all before it. `found` gets the slots of two boxes that meet.
    pub fn sweep(&self, from: Range<usize>, mut found: impl FnMut(u32, u32)) {
        let (in_strips, large) = self.places.split_at(self.in_strips);
        let laid = |place: &StripEntry| &self.boxes[place.slot as usize];
        let mut start = from.start;
        while start < from.end.min(in_strips.len()) {
            let strip = in_strips[start].strip;
            let (own, others) = in_strips.split_at(start + length(&in_strips[start..], strip));
            let above = &others[..length(others, strip + 1)];
            let reaches = |a: &StripEntry| a.begin - self.largest.x;
            let mut behind = above.partition_point(|b| b.begin < reaches(&own[start]));
            for place in start..own.len().min(from.end) {
                let a = &own[place];
                let bounds = laid(a);
                let meets = |b: &&StripEntry| bounds.meet(laid(b));
                let reached = |b: &&StripEntry| b.begin <= bounds.high.x;
                let ahead = own[place + 1..].iter().take_while(reached);
                ahead.filter(meets).for_each(|b| found(a.slot, b.slot));
                let begin = reaches(a);
                behind += above[behind..].iter().take_while(|b| b.begin < begin).count();
                let beside = above[behind..].iter().take_while(reached);
                beside.filter(meets).for_each(|b| found(a.slot, b.slot));
            }
            start = own.len();
        }
        for place in from.start.max(in_strips.len())..from.end {
            let a = &large[place - in_strips.len()];
            let meets = |b: &&StripEntry| laid(a).meet(laid(b));
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
    struct TestSlot {
        item: u32,
        who: u32,
    }

    impl Slot for TestSlot {
        fn item(&self) -> u32 {
            self.item
        }

        fn set_item(&mut self, item: u32) {
            self.item = item;
        }

        fn who(&self) -> u32 {
            self.who
        }
    }

    /// The sorted pairs that the search finds, swept in this many parts.
    fn found(search: &mut Search<TestSlot>, areas: &[Area], who: &[u32], parts: usize) -> Vec<(u32, u32)> {
        let (count, mut pairs) = (areas.len(), Vec::new());
        let area = |(): &(), known: &mut TestSlot| {
            known.who = who[known.item as usize];
            areas[known.item as usize]
        };
        let item_of = |known| who.iter().position(|who| *who == known).map(|item| item as u32);
        search.update(count, &Team::new(parts), true, item_of, |_| (), area);
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
        fn no_pair_is_lost_while_road_users_come_and_go(
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
                    // Sometimes a road user that is there already.
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
    fn steady_traffic_is_never_sorted_anew_whatever_the_threads() {
        const COUNT: usize = 50_000;
        let mut chance = fastrand::Rng::with_seed(5);
        let side = 20.0 * (COUNT as f64).sqrt();
        let cars = (0..COUNT).map(|_| [side, side, 14.0, 14.0].map(|most| most * chance.f64())).collect::<Vec<_>>();
        let who = (0..COUNT as u32).collect::<Vec<_>>();
        for threads in [1, 2, 16] {
            let (mut search, team) = (Search::<u32>::default(), Team::new(threads));
            for step in 0..10 {
                let time = 0.1 * f64::from(step);
                let area = |(): &(), item: &mut u32| {
                    let [x, y, along, up] = cars[*item as usize];
                    Circle { x: x + along * time, y: y + up * time, radius: 20.0 }.into()
                };
                search.update(COUNT, &team, true, |item| Some(who[item as usize]), |_| (), area);
            }
            assert_eq!(search.sorted_anew(), 1, "by {threads} threads");
        }
    }

    #[test]
    fn long_boxes_meet_others_far_ahead() {
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
