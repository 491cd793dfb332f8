//! Phase 1, pre-collision ("radar"): which pairs are near enough that they might meet.
//!
//! The paper (eq. 4) tests the distance to every other vehicle against the ego's detection radius. Here each road
//! user has a circle around its centre that holds everything it may cover until it stands; a pair is kept where two
//! circles meet, so no pair that is an encounter is dropped.
//!
//! Which circles to compare: they are sorted into strips along x, each as high as the widest of them, and within a
//! strip by x. From every circle the sweep looks ahead in its own strip and to both sides in the next (sweep and prune,
//! Cohen et al. 1995, in strips, so that a wide scene does not make it quadratic). `closecall study --only candidates`
//! compares it with all pairs, a grid, a plain sweep, parry2d's and rstar's trees.

use crate::units::Metre;

/// What a road user may cover until it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre, x.
    pub x: Metre,
    /// Centre, y.
    pub y: Metre,
    /// Radius: own stopping distance + half diagonal + ε.
    pub radius: Metre,
}

impl Circle {
    fn meets(&self, other: &Self) -> bool {
        let (dx, dy, reach) = (self.x - other.x, self.y - other.y, self.radius + other.radius);
        dx * dx + dy * dy <= reach * reach
    }
}

/// A circle larger than this many mean ones is compared with everybody: it would make all strips wide.
const LARGE: f64 = 2.5;
/// Who is further from the origin than this is compared with everybody, in m; SUMO's own invalid value is −2³⁰.
const FAR: Metre = 1e9;
/// No strip is lower than this, in m.
const LOWEST_STRIP: Metre = 1.0;

/// Strips stay as they are as long as they are at most this many times as high as they have to be.
const SPARE_HEIGHT: f64 = 2.0;
/// From one step to the next few road users overtake: sorting what is nearly sorted by insertion is given up after this
/// many moves per road user.
const MOVES: usize = 8;

/// A circle in its strip.
#[derive(Clone, Copy)]
struct Entry {
    strip: i32,
    item: u32,
    circle: Circle,
}

impl Entry {
    fn is_before(&self, other: &Self) -> bool {
        (self.strip, self.circle.x) < (other.strip, other.circle.x)
    }
}

/// Finds the pairs of circles that meet; keeps its memory, and the order that it found, from step to step.
#[derive(Default)]
pub struct Search {
    entries: Vec<Entry>,
    strip_height: Metre,
    is_known: Vec<bool>,
    large: Vec<u32>,
    found: Vec<(u32, u32)>,
    starts: Vec<u32>,
}

impl Search {
    /// Puts the index pairs (smaller first) of all circles that meet into `pairs`, in ascending order.
    pub fn pairs(&mut self, circles: &[Circle], pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        self.found.clear();
        if circles.len() < 2 {
            return;
        }
        let (widest, newcomers) = self.fill(circles);
        self.sort(widest, newcomers);
        self.sweep(widest);
        self.compare_large(circles);
        self.in_order(circles.len(), pairs);
    }

    /// Takes the circles of now in the order of the last step, those that it did not know at the end; returns the
    /// largest radius and how many were not known.
    fn fill(&mut self, circles: &[Circle]) -> (Metre, usize) {
        let mean = circles.iter().map(|circle| circle.radius.min(1e3)).sum::<f64>() / circles.len() as f64;
        let is_large = |circle: &Circle| circle.radius > LARGE * mean || circle.x.abs() >= FAR || circle.y.abs() >= FAR;
        let Self { entries, is_known, large, .. } = self;
        is_known.clear();
        is_known.resize(circles.len(), false);
        let mut widest = 0.0;
        entries.retain_mut(|entry| match circles.get(entry.item as usize) {
            Some(circle) if !is_large(circle) => {
                is_known[entry.item as usize] = true;
                entry.circle = *circle;
                widest = f64::max(widest, circle.radius);
                true
            }
            _ => false,
        });
        let known = entries.len();
        large.clear();
        for (item, circle) in (0..).zip(circles).filter(|(item, _)| !is_known[*item as usize]) {
            if is_large(circle) {
                large.push(item);
            } else {
                widest = f64::max(widest, circle.radius);
                entries.push(Entry { strip: 0, item, circle: *circle });
            }
        }
        (widest, entries.len() - known)
    }

    /// Sorts the circles into strips along x, and within each by x. Two that meet are then in the same strip or in
    /// neighbouring ones.
    fn sort(&mut self, widest: Metre, newcomers: usize) {
        let least = (2.0 * widest).max(LOWEST_STRIP);
        let same_strips = (least..=SPARE_HEIGHT * least).contains(&self.strip_height);
        if !same_strips {
            self.strip_height = SPARE_HEIGHT.sqrt() * least;
        }
        let per_metre = 1.0 / self.strip_height;
        let entries = &mut self.entries[..];
        for entry in entries.iter_mut() {
            entry.strip = (entry.circle.y * per_metre).floor() as i32;
        }
        let mut moves = if same_strips && newcomers < entries.len() / 8 { MOVES * entries.len() } else { 0 };
        for place in 1..entries.len() {
            let entry = entries[place];
            let mut to = place;
            while to > 0 && entry.is_before(&entries[to - 1]) {
                if moves == 0 {
                    entries[to] = entry;
                    entries.sort_unstable_by(|a, b| a.strip.cmp(&b.strip).then(a.circle.x.total_cmp(&b.circle.x)));
                    return;
                }
                moves -= 1;
                entries[to] = entries[to - 1];
                to -= 1;
            }
            entries[to] = entry;
        }
    }

    /// From each circle ahead in its own strip, and to both sides in the next.
    fn sweep(&mut self, widest: Metre) {
        let entries = &self.entries[..];
        let mut next = 0;
        for (place, a) in entries.iter().enumerate() {
            let reach = a.circle.radius + widest;
            for b in entries[place + 1..].iter().take_while(|b| b.strip == a.strip && b.circle.x <= a.circle.x + reach)
            {
                if a.circle.meets(&b.circle) {
                    self.found.push((a.item.min(b.item), a.item.max(b.item)));
                }
            }
            let above = a.strip + 1;
            let begin = a.circle.x - 2.0 * widest;
            while entries.get(next).is_some_and(|b| b.strip < above || (b.strip == above && b.circle.x < begin)) {
                next += 1;
            }
            for b in entries[next..].iter().take_while(|b| b.strip == above && b.circle.x <= a.circle.x + reach) {
                if a.circle.meets(&b.circle) {
                    self.found.push((a.item.min(b.item), a.item.max(b.item)));
                }
            }
        }
    }

    fn compare_large(&mut self, circles: &[Circle]) {
        for &large in &self.large {
            for other in 0..circles.len() as u32 {
                let both_large = self.large.binary_search(&other).is_ok();
                if other != large
                    && !(both_large && other < large)
                    && circles[large as usize].meets(&circles[other as usize])
                {
                    self.found.push((large.min(other), large.max(other)));
                }
            }
        }
    }

    /// Counting sort by the first of each pair; the few of one first are then sorted by the second.
    fn in_order(&mut self, count: usize, pairs: &mut Vec<(u32, u32)>) {
        self.starts.clear();
        self.starts.resize(count + 1, 0);
        for (first, _) in &self.found {
            self.starts[*first as usize + 1] += 1;
        }
        for item in 0..count {
            self.starts[item + 1] += self.starts[item];
        }
        pairs.resize(self.found.len(), (0, 0));
        for pair in &self.found {
            let place = &mut self.starts[pair.0 as usize];
            pairs[*place as usize] = *pair;
            *place += 1;
        }
        // Every start has moved up to where the next one's was.
        let mut start = 0;
        for end in &self.starts[..count] {
            pairs[start..*end as usize].sort_unstable();
            start = *end as usize;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn all_pairs(circles: &[Circle]) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        for i in 0..circles.len() {
            for j in i + 1..circles.len() {
                if circles[i].meets(&circles[j]) {
                    pairs.push((i as u32, j as u32));
                }
            }
        }
        pairs
    }

    proptest! {
        #[test]
        fn none_is_lost_from_step_to_step_either(
            starts in prop::collection::vec((-300.0..300.0, -300.0..300.0, -9.0..9.0, -9.0..9.0, 0.5..20.0), 0..60),
            leave in prop::collection::vec(0_usize..8, 8),
        ) {
            let mut search = Search::default();
            let mut pairs = Vec::new();
            let mut cars = starts;
            for leaving in leave {
                for (x, y, along, up, _) in &mut cars {
                    (*x, *y) = (*x + *along, *y + *up);
                }
                cars.truncate(cars.len() - leaving.min(cars.len()));
                let circles: Vec<_> = cars.iter().map(|&(x, y, _, _, radius)| Circle { x, y, radius }).collect();
                search.pairs(&circles, &mut pairs);
                prop_assert_eq!(&pairs, &all_pairs(&circles));
            }
        }

        #[test]
        fn no_pair_is_lost_or_found_twice(
            places in prop::collection::vec((-300.0..300.0, -300.0..300.0, prop_oneof![0.5..5.0, 5.0..80.0, Just(5e3)]), 0..60),
            origin in prop_oneof![Just(0.0), Just(1e7), Just(-4e5)],
        ) {
            let circles: Vec<_> =
                places.into_iter().map(|(x, y, radius)| Circle { x: x + origin, y: y - origin, radius }).collect();
            let mut pairs = Vec::new();
            Search::default().pairs(&circles, &mut pairs);
            prop_assert_eq!(pairs, all_pairs(&circles));
        }
    }

    #[test]
    fn an_absurd_radius_costs_no_memory() {
        let circles = [Circle { x: 0.0, y: 0.0, radius: 1e300 }, Circle { x: 1e9, y: 0.0, radius: 1.0 }];
        let mut pairs = Vec::new();
        Search::default().pairs(&circles, &mut pairs);
        assert_eq!(pairs, [(0, 1)]);
    }
}
