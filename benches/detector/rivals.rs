//! Alternatives to the detector. They only find the pairs that might meet, without distances along a path, kinds or μ.

use closecall::braking::stopping_distance;
use closecall::geometry::rectangle::direction;
use closecall::{Profile, State};
use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::math::{Pose, Rotation, Vector};
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use parry2d_f64::query;
use parry2d_f64::shape::Cuboid;

/// The shapes that the boxes of parry2d's tree enclose.
#[derive(Clone, Copy, PartialEq)]
pub enum Boxes {
    /// The circle that a road user cannot leave before it stands, wherever its road turns, as in the broad phase.
    Circles,
    /// The rectangle that it covers until it stands on a straight road, as all roads are here.
    StraightWays,
}

/// The origin of parry2d's tree in a step. Its documentation recommends both for moving objects.
#[derive(Clone, Copy, PartialEq)]
pub enum Making {
    /// Built from all boxes, by the strategy recommended for moving objects.
    Anew,
    /// Updated from the last step: partial updates, refit, incremental optimisation.
    Kept,
}

/// parry2d: a tree of boxes, and for each pair of boxes that meet its intersection test of the rectangles that the two
/// cover until they stand.
pub struct Tree {
    boxes: Boxes,
    making: Making,
    around: Vec<Aabb>,
    tree: Bvh,
    workspace: BvhWorkspace,
    covered: Vec<(Pose, Cuboid)>,
}

impl Tree {
    pub fn new(boxes: Boxes, making: Making) -> Self {
        Self {
            boxes,
            making,
            around: Vec::new(),
            tree: Bvh::default(),
            workspace: BvhWorkspace::default(),
            covered: Vec::new(),
        }
    }

    /// The number of pairs whose rectangles meet.
    pub fn contacts(&mut self, cars: &[State], car: &Profile, epsilon: f64) -> usize {
        self.covered.clear();
        self.around.clear();
        for state in cars {
            let covered = Covered::of(state, car, epsilon);
            let Covered { axis, ahead, half, centre, .. } = covered;
            let around = match self.boxes {
                Boxes::Circles => {
                    let radius = ahead + car.length.hypot(car.width) / 2.0;
                    (centre - Vector::new(axis.x, axis.y) * (ahead / 2.0), Vector::new(radius, radius))
                }
                Boxes::StraightWays => {
                    let across = axis.y.abs();
                    let along = axis.x.abs();
                    (centre, Vector::new(along * half.x + across * half.y, across * half.x + along * half.y))
                }
            };
            self.covered.push(covered.shape());
            self.around.push(Aabb::new(around.0 - around.1, around.0 + around.1));
        }
        match self.making {
            Making::Anew => self.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &self.around),
            Making::Kept => {
                for (index, around) in (0..).zip(&self.around) {
                    self.tree.insert_or_update_partially(*around, index, 0.0);
                }
                self.tree.refit(&mut self.workspace);
                self.tree.optimize_incremental(&mut self.workspace);
            }
        }
        let covered = &self.covered;
        let mut found = 0;
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |i, j| {
            found += usize::from(meet(&covered[i as usize], &covered[j as usize]));
        });
        found
    }
}

/// The rectangle that a car covers until it stands, on a straight road.
struct Covered {
    axis: closecall::geometry::Vector,
    ahead: f64,
    half: Vector,
    centre: Vector,
}

impl Covered {
    fn of(state: &State, car: &Profile, epsilon: f64) -> Self {
        let ahead = stopping_distance(state.speed, &car.brakes) + epsilon;
        let axis = direction(state.heading);
        let half = Vector::new((car.length + ahead) / 2.0, car.width / 2.0);
        let centre = Vector::new(state.x, state.y) + Vector::new(axis.x, axis.y) * (ahead - half.x);
        Self { axis, ahead, half, centre }
    }

    fn shape(&self) -> (Pose, Cuboid) {
        let rotation = Rotation { re: self.axis.x, im: self.axis.y };
        (Pose { rotation, translation: self.centre }, Cuboid::new(self.half))
    }
}

fn meet((a, a_shape): &(Pose, Cuboid), (b, b_shape): &(Pose, Cuboid)) -> bool {
    query::intersection_test(a, a_shape, b, b_shape).is_ok_and(|test| test.intersecting)
}

/// The tree's test without the tree, for every pair.
#[derive(Default)]
pub struct AllTested {
    covered: Vec<(Pose, Cuboid)>,
}

impl AllTested {
    /// The number of road users, evenly spread, that are tested with all others.
    pub const SAMPLE: usize = 100;

    /// The number of pairs of the sample whose rectangles meet.
    pub fn contacts(&mut self, cars: &[State], car: &Profile, epsilon: f64) -> usize {
        self.covered.clear();
        self.covered.extend(cars.iter().map(|state| Covered::of(state, car, epsilon).shape()));
        let sample = self.covered.iter().step_by(cars.len() / Self::SAMPLE).take(Self::SAMPLE);
        sample.map(|a| self.covered.iter().filter(|b| meet(a, b)).count()).sum()
    }

    /// The number of all pairs divided by the number of pairs in the sample.
    pub fn share(count: usize) -> f64 {
        (count - 1) as f64 / 2.0 / Self::SAMPLE as f64
    }
}

/// Every pair, by the paper's test of two circles, the cheapest that loses no pair.
#[derive(Default)]
pub struct AllPairs {
    x: Vec<f64>,
    y: Vec<f64>,
    radius: Vec<f64>,
}

impl AllPairs {
    /// The number of pairs whose circles meet.
    pub fn contacts(&mut self, cars: &[State], car: &Profile, epsilon: f64) -> usize {
        let Self { x, y, radius } = self;
        [&mut *x, y, radius].into_iter().for_each(Vec::clear);
        for state in cars {
            let axis = direction(state.heading);
            x.push(state.x - axis.x * car.length / 2.0);
            y.push(state.y - axis.y * car.length / 2.0);
            radius.push(stopping_distance(state.speed, &car.brakes) + car.length.hypot(car.width) / 2.0 + epsilon);
        }
        let mut found = 0;
        for i in 0..cars.len() {
            let later = x[i + 1..].iter().zip(&y[i + 1..]).zip(&radius[i + 1..]);
            let meets = |((other_x, other_y), other): ((&f64, &f64), &f64)| {
                let (dx, dy, reach) = (other_x - x[i], other_y - y[i], other + radius[i]);
                usize::from(dx * dx + dy * dy <= reach * reach)
            };
            found += later.map(meets).sum::<usize>();
        }
        found
    }
}
