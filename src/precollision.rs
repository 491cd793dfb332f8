//! Phase 1, pre-collision ("radar"): which pairs are near enough that they might meet.
//!
//! The paper (eq. 4) tests the distance to every other vehicle against the ego's detection radius. Here each road
//! user has an area that holds everything it may cover until it stands: a circle around its centre, wherever its way
//! turns, or, where it can only go straight on, the box around that. A pair is kept where two areas meet, so no pair
//! that is an encounter is dropped.
//!
//! Which areas to compare: their boxes are sorted into strips along x, each as high as the highest of them, and within
//! a strip by x. From every box the sweep looks ahead in its own strip and to both sides in the next (sweep and prune,
//! Cohen et al. 1995, in strips, so that a wide scene does not make it quadratic). `closecall study --only candidates`
//! compares it with all pairs, a grid, a plain sweep, parry2d's and rstar's trees.

use std::ops::Range;

use crate::geometry::{Bounds, Point, Vector};
use crate::units::Metre;

/// What a road user may cover until it stands, whichever way it turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre, x.
    pub x: Metre,
    /// Centre, y.
    pub y: Metre,
    /// Radius: own stopping distance + half diagonal + ε.
    pub radius: Metre,
}

/// Where a road user stays until it stands: within the box, and within the circle around the middle of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// The box.
    pub bounds: Bounds,
    /// The circle's radius; infinite where the box alone decides.
    pub radius: Metre,
}

impl Area {
    /// Whether two areas meet.
    pub fn meets(&self, other: &Self) -> bool {
        let (middle, other_middle) = (self.middle(), other.middle());
        let reach = self.radius + other.radius;
        self.bounds.meet(&other.bounds) && (middle - other_middle).norm_squared() <= reach * reach
    }

    fn middle(&self) -> Point {
        self.bounds.low + self.size() / 2.0
    }

    fn size(&self) -> Vector {
        self.bounds.high - self.bounds.low
    }
}

impl From<Circle> for Area {
    fn from(circle: Circle) -> Self {
        let (middle, reach) = (Point::new(circle.x, circle.y), Vector::new(circle.radius, circle.radius));
        Self { bounds: Bounds { low: middle - reach, high: middle + reach }, radius: circle.radius }
    }
}

impl From<Bounds> for Area {
    fn from(bounds: Bounds) -> Self {
        Self { bounds, radius: f64::INFINITY }
    }
}

/// A box larger than this many mean ones is compared with everybody: it would make all strips high.
const LARGE: f64 = 2.5;
/// No more than one in so many is compared with everybody, that would be all pairs again.
const SHARE_OF_LARGE: usize = 1000;
/// Who is further from the origin than this is compared with everybody, in m; SUMO's own invalid value is −2³⁰.
const FAR: Metre = 1e9;
/// No strip is lower than this, in m.
const LOWEST_STRIP: Metre = 1.0;

/// Strips stay as they are as long as they are at most this many times as high as they have to be.
const SPARE_HEIGHT: f64 = 2.0;
/// From one step to the next few road users overtake: sorting what is nearly sorted by insertion is given up after this
/// many moves per road user.
const MOVES: usize = 8;

/// An area in its strip.
#[derive(Clone, Copy)]
struct Entry {
    strip: i32,
    item: u32,
    area: Area,
}

impl Entry {
    fn is_before(&self, other: &Self) -> bool {
        (self.strip, self.area.bounds.low.x) < (other.strip, other.area.bounds.low.x)
    }
}

/// Finds the pairs of areas that meet; keeps its memory, and the order that it found, from step to step.
#[derive(Default)]
pub struct Search {
    entries: Vec<Entry>,
    strip_height: Metre,
    /// Length along x of the longest box that has a strip.
    longest: Metre,
    is_known: Vec<bool>,
    large: Vec<u32>,
}

impl Search {
    /// Puts the index pairs (smaller first) of all areas that meet into `pairs`, in no particular order.
    pub fn pairs(&mut self, areas: &[Area], pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        self.prepare(areas);
        self.sweep(0..self.places(), |a, b| pairs.push((a, b)));
        self.compare_large(areas, |a, b| pairs.push((a, b)));
    }

    /// Takes the areas of a step and sorts them.
    pub fn prepare(&mut self, areas: &[Area]) {
        let highest = self.fill(areas);
        self.sort(highest);
    }

    /// The number of places from which to sweep.
    pub fn places(&self) -> usize {
        self.entries.len()
    }

    /// Takes the areas of now in the order of the last step, those that it did not know at the end; returns the
    /// largest height.
    fn fill(&mut self, areas: &[Area]) -> Metre {
        let limit = limit(areas);
        let is_large = |area: &Area| {
            let (size, Bounds { low, high }) = (area.size(), area.bounds);
            !(size.x.max(size.y) <= limit && low.x.min(low.y) > -FAR && high.x.max(high.y) < FAR)
        };
        let Self { entries, is_known, large, .. } = self;
        is_known.clear();
        is_known.resize(areas.len(), false);
        let mut largest = Vector::zeros();
        entries.retain_mut(|entry| match areas.get(entry.item as usize) {
            Some(area) if !is_large(area) => {
                is_known[entry.item as usize] = true;
                entry.area = *area;
                largest = largest.sup(&area.size());
                true
            }
            _ => false,
        });
        large.clear();
        for (item, area) in (0..).zip(areas).filter(|(item, _)| !is_known[*item as usize]) {
            if is_large(area) {
                large.push(item);
            } else {
                largest = largest.sup(&area.size());
                entries.push(Entry { strip: 0, item, area: *area });
            }
        }
        self.longest = largest.x;
        largest.y
    }

    /// Sorts the boxes into strips by their middle, and within each along x. Two that meet are then in the same strip
    /// or in neighbouring ones.
    fn sort(&mut self, highest: Metre) {
        let least = highest.max(LOWEST_STRIP);
        let same_strips = (least..=SPARE_HEIGHT * least).contains(&self.strip_height);
        if !same_strips {
            self.strip_height = SPARE_HEIGHT.sqrt() * least;
        }
        let per_metre = 1.0 / self.strip_height;
        let entries = &mut self.entries[..];
        for entry in entries.iter_mut() {
            let Bounds { low, high } = entry.area.bounds;
            entry.strip = ((low.y + high.y) * 0.5 * per_metre).floor() as i32;
        }
        let mut moves = if same_strips { MOVES * entries.len() } else { 0 };
        for place in 1..entries.len() {
            let entry = entries[place];
            let mut to = place;
            while to > 0 && entry.is_before(&entries[to - 1]) {
                if moves == 0 {
                    entries[to] = entry;
                    let x = |entry: &Entry| entry.area.bounds.low.x;
                    entries.sort_unstable_by(|a, b| a.strip.cmp(&b.strip).then(x(a).total_cmp(&x(b))));
                    return;
                }
                moves -= 1;
                entries[to] = entries[to - 1];
                to -= 1;
            }
            entries[to] = entry;
        }
    }

    /// From each of these places ahead in its own strip, and to both sides in the next; `found` gets the smaller index
    /// first.
    pub fn sweep(&self, places: Range<usize>, mut found: impl FnMut(u32, u32)) {
        let mut compare = |a: &Entry, b: &Entry| {
            if a.area.meets(&b.area) {
                found(a.item.min(b.item), a.item.max(b.item));
            }
        };
        let entries = &self.entries[..];
        let mut next = places.start;
        for place in places {
            let a = &entries[place];
            let (above, end) = (a.strip + 1, a.area.bounds.high.x);
            let ahead = entries[place + 1..].iter();
            ahead.take_while(|b| b.strip == a.strip && b.area.bounds.low.x <= end).for_each(|b| compare(a, b));
            let begin = a.area.bounds.low.x - self.longest;
            next += entries[next..]
                .iter()
                .take_while(|b| b.strip < above || (b.strip == above && b.area.bounds.low.x < begin))
                .count();
            let aside = entries[next..].iter();
            aside.take_while(|b| b.strip == above && b.area.bounds.low.x <= end).for_each(|b| compare(a, b));
        }
    }

    /// Each of the large ones with everybody.
    pub fn compare_large(&self, areas: &[Area], mut found: impl FnMut(u32, u32)) {
        for &large in &self.large {
            for other in 0..areas.len() as u32 {
                let both_large = self.large.binary_search(&other).is_ok();
                if other != large
                    && !(both_large && other < large)
                    && areas[large as usize].meets(&areas[other as usize])
                {
                    found(large.min(other), large.max(other));
                }
            }
        }
    }
}

/// The largest size of a box that gets a strip: a few times the mean, more where too many are larger than that.
fn limit(areas: &[Area]) -> Metre {
    let sizes = || areas.iter().map(|area| area.size().max());
    let mean = sizes().map(|size| size.clamp(0.0, 1e3)).sum::<f64>() / areas.len().max(1) as f64;
    let mut limit = LARGE * mean.max(LOWEST_STRIP);
    let allowed = areas.len() / SHARE_OF_LARGE + 1;
    while limit < FAR && sizes().filter(|size| *size > limit).count() > allowed {
        limit *= 2.0;
    }
    limit
}

#[cfg(test)]
mod tests {
    use super::*;
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

    /// What the search finds, swept in this many parts, in order.
    fn found(search: &mut Search, areas: &[Area], parts: usize) -> Vec<(u32, u32)> {
        search.prepare(areas);
        let mut pairs = Vec::new();
        let share = search.places().div_ceil(parts).max(1);
        for start in (0..search.places()).step_by(share) {
            search.sweep(start..(start + share).min(search.places()), |a, b| pairs.push((a, b)));
        }
        search.compare_large(areas, |a, b| pairs.push((a, b)));
        pairs.sort_unstable();
        pairs
    }

    fn size() -> impl Strategy<Value = f64> {
        prop_oneof![0.5..5.0, 5.0..80.0, Just(5e3)]
    }

    proptest! {
        #[test]
        fn none_is_lost_from_step_to_step_either(
            starts in prop::collection::vec((-300.0..300.0, -300.0..300.0, -9.0..9.0, -9.0..9.0, 0.5..20.0), 0..60),
            leave in prop::collection::vec(0_usize..8, 8),
        ) {
            let mut search = Search::default();
            let mut cars = starts;
            for leaving in leave {
                for (x, y, along, up, _) in &mut cars {
                    (*x, *y) = (*x + *along, *y + *up);
                }
                cars.truncate(cars.len() - leaving.min(cars.len()));
                let areas: Vec<_> = cars.iter().map(|&(x, y, _, _, radius)| Circle { x, y, radius }.into()).collect();
                prop_assert_eq!(found(&mut search, &areas, 1), all_pairs(&areas));
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
            prop_assert_eq!(found(&mut Search::default(), &areas, parts), all_pairs(&areas));
        }
    }

    #[test]
    fn an_absurd_radius_costs_no_memory() {
        let areas = [Circle { x: 0.0, y: 0.0, radius: 1e300 }, Circle { x: 1e9, y: 0.0, radius: 1.0 }].map(Area::from);
        assert_eq!(found(&mut Search::default(), &areas, 1), [(0, 1)]);
    }
}
