//! The search for pairs of circles that meet: the paper's loop over every pair and five others, from 10² to 10⁶ road
//! users.
//!
//! All methods end with the same exact test of two circles and return their pairs in ascending order, because the
//! detector's results must not depend on the method. All must therefore find the same pairs; the error is the share that
//! a method loses.

use std::hint::black_box;

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::math::Vector as ParryVector;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use closecall::detection::broad_phase::{Area, Circle, Search};
use closecall::util::units::Second;

type Pairs = Vec<(u32, u32)>;
type SearchMethod = (&'static str, fn(&[Circle], &mut Search<u32>, &mut Pairs));
type TrafficPattern = (&'static str, fn(&mut Chance, usize) -> Vec<Circle>);

const DEFAULT: &str = "sweep in strips";
const METHODS: [SearchMethod; 6] = [
    ("all pairs (paper)", |circles, _, pairs| all_pairs(circles, pairs)),
    ("uniform grid", |circles, _, pairs| in_order(pairs, |pairs| uniform_grid(circles, pairs))),
    ("sweep and prune", |circles, _, pairs| in_order(pairs, |pairs| sweep_and_prune(circles, pairs))),
    ("parry2d tree", |circles, _, pairs| in_order(pairs, |pairs| parry2d_tree(circles, pairs))),
    ("rstar", |circles, _, pairs| in_order(pairs, |pairs| rstar_tree(circles, pairs))),
    (DEFAULT, |circles, search, pairs| {
        search.pairs(&circles.iter().copied().map(Area::from).collect::<Vec<_>>(), pairs);
    }),
];
const SCENES: [TrafficPattern; 3] = [("uniform", uniform), ("platoons", platoons), ("jam", jam)];

/// A method that takes longer than this is not measured with ten times the road users: in a quick study, and in a full one.
const TOO_SLOW: [Second; 2] = [0.2, 2.0];

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (largest, rounds) = if plan.quick { (5, 3) } else { (6, 5) };
    let mut rows = Vec::new();
    for (scene, draw) in SCENES {
        let mut too_slow = [false; METHODS.len()];
        for count in (2..=largest).map(|power| 10_usize.pow(power)) {
            let circles = draw(&mut Chance::new(1), count);
            let chosen = METHODS.iter().enumerate().filter(|(index, _)| !too_slow[*index]).collect::<Vec<_>>();
            let mut timed = chosen
                .iter()
                .map(|(_, (_, method))| {
                    let mut search = Search::default();
                    let mut pairs = Pairs::new();
                    let circles = &circles;
                    Timed::new(count, move || {
                        method(circles, &mut search, &mut pairs);
                        black_box(&pairs);
                    })
                })
                .collect::<Vec<_>>();
            let times = interleaved(&mut timed, if count < 10_000 { 10 * rounds } else { rounds });
            drop(timed);
            // The reference is the simplest method that is still measured: all pairs up to 10⁴, then the sweep along x.
            let truth = found(chosen[0].1.1, &circles);
            for ((index, (name, method)), ns_per_item) in chosen.into_iter().zip(times) {
                let lost = lost(&found(*method, &circles), &truth);
                too_slow[index] = ns_per_item * 1e-9 * count as f64 > TOO_SLOW[usize::from(!plan.quick)];
                rows.push(Measurement {
                    axis: Axis::Candidates,
                    method: name,
                    parameter: format!("{scene}, {count} road users"),
                    error_name: "share of pairs lost",
                    error: lost,
                    false_negative_rate: lost,
                    false_positive_rate: 0.0,
                    ns_per_item,
                    items: count,
                    on_pareto_front: false,
                    scene: format!("{scene}, {count}"),
                    default: *name == DEFAULT,
                });
            }
        }
    }
    rows
}

fn found(method: fn(&[Circle], &mut Search<u32>, &mut Pairs), circles: &[Circle]) -> Pairs {
    let mut pairs = Pairs::new();
    method(circles, &mut Search::default(), &mut pairs);
    pairs.sort_unstable();
    pairs
}

/// Sorts the pairs that a method finds.
fn in_order(pairs: &mut Pairs, find: impl FnOnce(&mut Pairs)) {
    find(pairs);
    pairs.sort_unstable();
}

/// The share of the true pairs that were not found; 1 if a false pair was found.
fn lost(found: &Pairs, truth: &Pairs) -> f64 {
    let held = truth.iter().filter(|pair| found.binary_search(pair).is_ok()).count();
    if found.len() > held { 1.0 } else { 1.0 - held as f64 / truth.len().max(1) as f64 }
}

/// Road users at random places, one per 400 m², with radii of 5 to 30 m.
fn uniform(chance: &mut Chance, count: usize) -> Vec<Circle> {
    let side = (count as f64 * 400.0).sqrt();
    let mut circle =
        || Circle { x: chance.between(0.0, side), y: chance.between(0.0, side), radius: chance.between(5.0, 30.0) };
    (0..count).map(|_| circle()).collect()
}

/// Platoons of 20 at 50 km/h, with 15 m between vehicles, on a grid of streets 200 m apart.
fn platoons(chance: &mut Chance, count: usize) -> Vec<Circle> {
    let streets = ((count as f64 / 50.0).sqrt().ceil() as usize).max(1);
    let length = streets as f64 * 200.0;
    let mut circles = Vec::with_capacity(count);
    while circles.len() < count {
        let street = chance.below(streets) as f64 * 200.0;
        let start = chance.between(0.0, length);
        let along_x = chance.below(2) == 0;
        for place in 0..20.min(count - circles.len()) {
            let along = start + 15.0 * place as f64;
            let (x, y) = if along_x { (along, street) } else { (street, along) };
            circles.push(Circle { x, y, radius: 27.0 });
        }
    }
    circles
}

/// One slow jam on four lanes of 3.2 m, with 7.5 m per vehicle.
fn jam(chance: &mut Chance, count: usize) -> Vec<Circle> {
    let circle = |place: usize| {
        let (row, lane) = (place / 4, place % 4);
        let radius = chance.between(3.0, 6.0);
        Circle { x: row as f64 * 7.5 + chance.between(-0.5, 0.5), y: lane as f64 * 3.2, radius }
    };
    (0..count).map(circle).collect()
}

fn meet(a: &Circle, b: &Circle) -> bool {
    let (dx, dy, reach) = (a.x - b.x, a.y - b.y, a.radius + b.radius);
    dx * dx + dy * dy <= reach * reach
}

fn all_pairs(circles: &[Circle], pairs: &mut Pairs) {
    pairs.clear();
    for (i, a) in (0_u32..).zip(circles) {
        let later = (i + 1..).zip(&circles[i as usize + 1..]);
        pairs.extend(later.filter(|(_, b)| meet(a, b)).map(|(j, _)| (i, j)));
    }
}

/// Cells as wide as the largest circle; each road user is in the cell of its centre and searches nine cells.
fn uniform_grid(circles: &[Circle], pairs: &mut Pairs) {
    pairs.clear();
    let widest = circles.iter().map(|circle| 2.0 * circle.radius).fold(1.0, f64::max);
    let cell = |circle: &Circle| ((circle.x / widest).floor() as i64, (circle.y / widest).floor() as i64);
    let mut cells = (0..circles.len() as u32).map(|i| (cell(&circles[i as usize]), i)).collect::<Vec<_>>();
    cells.sort_unstable();
    for &((x, y), i) in &cells {
        for near_x in x - 1..=x + 1 {
            let start = cells.partition_point(|(cell, _)| *cell < (near_x, y - 1));
            for &(_, j) in cells[start..].iter().take_while(|(cell, _)| *cell <= (near_x, y + 1)) {
                if i < j && meet(&circles[i as usize], &circles[j as usize]) {
                    pairs.push((i, j));
                }
            }
        }
    }
}

/// Circles sorted by their lower end along x (Cohen et al. 1995, in one direction).
fn sweep_and_prune(circles: &[Circle], pairs: &mut Pairs) {
    pairs.clear();
    let mut order = (0..circles.len() as u32).collect::<Vec<_>>();
    let low = |i: u32| circles[i as usize].x - circles[i as usize].radius;
    order.sort_unstable_by(|&i, &j| low(i).total_cmp(&low(j)));
    for (place, &i) in order.iter().enumerate() {
        let a = &circles[i as usize];
        for &j in order[place + 1..].iter().take_while(|&&j| low(j) <= a.x + a.radius) {
            if meet(a, &circles[j as usize]) {
                pairs.push((i.min(j), i.max(j)));
            }
        }
    }
}

fn parry2d_tree(circles: &[Circle], pairs: &mut Pairs) {
    pairs.clear();
    let around = |circle: &Circle| {
        let centre = ParryVector::new(circle.x, circle.y);
        let reach = ParryVector::new(circle.radius, circle.radius);
        Aabb::new(centre - reach, centre + reach)
    };
    let boxes = circles.iter().map(around).collect::<Vec<_>>();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |i, j| {
        if meet(&circles[i as usize], &circles[j as usize]) {
            pairs.push((i.min(j), i.max(j)));
        }
    });
}

fn rstar_tree(circles: &[Circle], pairs: &mut Pairs) {
    pairs.clear();
    let corners = |circle: &Circle| {
        let Circle { x, y, radius } = *circle;
        ([x - radius, y - radius], [x + radius, y + radius])
    };
    let item = |(index, circle)| {
        let (low, high) = corners(circle);
        GeomWithData::new(Rectangle::from_corners(low, high), index)
    };
    let tree = RTree::bulk_load((0_u32..).zip(circles).map(item).collect());
    for (i, circle) in (0_u32..).zip(circles) {
        let (low, high) = corners(circle);
        let near = tree.locate_in_envelope_intersecting(AABB::from_corners(low, high));
        let later = near.map(|item| item.data).filter(|j| i < *j && meet(circle, &circles[*j as usize]));
        pairs.extend(later.map(|j| (i, j)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_finds_what_all_pairs_find() {
        for (scene, draw) in SCENES {
            let circles = draw(&mut Chance::new(3), 700);
            let truth = found(METHODS[0].1, &circles);
            assert!(!truth.is_empty());
            for (name, method) in METHODS {
                assert_eq!(found(method, &circles), truth, "{name} in {scene}");
            }
        }
    }
}
