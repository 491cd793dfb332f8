//! How exactly a turn is swept: to one tolerance everywhere, or finely only where a coarse sweep finds that two meet.

use std::f64::consts::PI;
use std::hint::black_box;
use std::slice::from_ref;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use super::reference::turning::{Circling, first_touch};
use closecall::braking::Brakes;
use closecall::detection::narrow_phase::{Participant, SweptBounds, side};
use closecall::detection::path::Pose;
use closecall::geometry::Point;
use closecall::geometry::bisection::Bisection;
use closecall::geometry::movement::{FINE, POSES};
use closecall::geometry::rectangle::{Rectangle, direction};
use closecall::traffic::profile::Carriage;
use closecall::util::units::{Metre, Radian};

const DEFAULT: &str = "coarse, then fine";
/// Tolerances that apply everywhere.
const EVERYWHERE: [Metre; 4] = [0.1, 0.01, 1e-3, 1e-4];
/// The reference's precision along the ego's way.
const PRECISION: Metre = 1e-4;
const BRAKES: Brakes = Brakes { response: 1.0, build_up: 0.1, deceleration: 8.0 };
const SIZE: [Metre; 2] = [5.0, 2.0];
const BOTH: &str = "both turn";
const FOE: &str = "the foe turns";
const SCENES: [&str; 3] = [BOTH, FOE, "side by side"];

/// A road user on its way, as poses and the areas between them.
struct Mover {
    circling: Circling,
    poses: Vec<Pose>,
    covers: Vec<SweptBounds>,
    cover: SweptBounds,
}

impl Mover {
    /// Poses so close that no corner leaves the line between two by more than a tolerance.
    fn new(circling: &Circling, tolerance: Metre) -> Self {
        let radius = 1.0 / circling.curvature.abs() + circling.size[0];
        let parts = (circling.until * circling.curvature.abs() / (8.0 * tolerance / radius).sqrt()).ceil().max(1.0);
        let pose = |part: u32| {
            let distance = circling.until * f64::from(part) / parts;
            let ([x, y], heading) = circling.pose(distance);
            Pose { distance, front: Point::new(x, y), axis: direction(heading) }
        };
        let straight = |part: u32| Pose { axis: direction(circling.heading), ..pose(part) };
        let pose: &dyn Fn(u32) -> Pose = if circling.curvature == 0.0 { &straight } else { &pose };
        let poses = (0..=parts as u32).map(pose).collect::<Vec<_>>();
        let cover = |poses: &[Pose]| SweptBounds::of(poses, SIZE[0], SIZE[1]).unwrap_or(SweptBounds::NOWHERE);
        Self { circling: *circling, covers: poses.windows(2).map(cover).collect(), cover: cover(&poses), poses }
    }

    fn participant(&self) -> Participant<'_> {
        let [length, width] = SIZE;
        Participant {
            rectangle: Rectangle::behind(self.poses[0].front, self.poses[0].axis, length, width),
            carriage: Carriage { behind: 0.0, length },
            setback: 0.0,
            shape: &[],
            poses: &self.poses,
            straight: self.circling.curvature == 0.0,
            reach: self.circling.until,
            cover: &self.cover,
            covers: &self.covers,
            speed: 10.0,
            brakes: &BRAKES,
            stop: self.circling.until,
        }
    }
}

/// A method: the tolerance of the poses, and that of the sweep, which may follow a coarse one.
#[derive(Clone, Copy)]
struct Method {
    poses: Metre,
    sweep: Metre,
    after_coarse: bool,
}

/// The ego's distance to the foe's area, and whether the first of the two is the ego.
fn meet(method: Method, bisection: &mut Bisection, pair: &[Circling; 2]) -> Option<(bool, Metre)> {
    let [first, second] = pair.each_ref().map(|circling| Mover::new(circling, method.poses));
    if !first.cover.meets(&second.cover) {
        return None;
    }
    let [first, second] = [first.participant(), second.participant()];
    let (first, second) = (from_ref(&first), from_ref(&second));
    bisection.clear();
    if method.after_coarse {
        side::meet(bisection, first, second)?;
    }
    let found = side::refine(bisection, method.sweep, first, second)?;
    Some((found.ego.then_foe([true, false])[0], found.conflict_point.ego_distance))
}

/// The same by its definition.
fn truth([first, second]: &[Circling; 2]) -> Option<(bool, Metre)> {
    let found = [first_touch(first, second, PRECISION), first_touch(second, first, PRECISION)];
    match found {
        [Some(first), Some(second)] if second > first => Some((false, second)),
        [Some(first), _] => Some((true, first)),
        [None, second] => second.map(|second| (false, second)),
    }
}

/// Two that are near each other, of which at least one turns.
fn pair(chance: &mut Chance, scene: &str) -> [Circling; 2] {
    let mut circling = |[x, y]: [[Metre; 2]; 2], heading: Radian, curvature: Metre| Circling {
        front: [chance.between(x[0], x[1]), chance.between(y[0], y[1])],
        heading: chance.between(-heading, heading),
        curvature: chance.between(0.1, 1.0) * chance.pick(&[curvature, -curvature]),
        size: SIZE,
        until: chance.between(5.0, 60.0),
    };
    let (origin, around) = ([[0.0; 2]; 2], [[-40.0, 40.0]; 2]);
    match scene {
        BOTH => [circling(origin, PI, 0.1), circling(around, PI, 0.1)],
        FOE => [circling(origin, PI, 0.0), circling(around, PI, 0.1)],
        // On the next lane, turning a little: one comes along the flank of the other's path.
        _ => [circling(origin, 0.02, 0.01), circling([[-10.0, 25.0], [2.1, 4.0]], 0.1, 0.03)],
    }
}

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (300, 3) } else { (3_000, 5) };
    let everywhere = EVERYWHERE.map(|tolerance| {
        let method = Method { poses: tolerance, sweep: tolerance, after_coarse: false };
        ("one tolerance", format!(", {tolerance} m"), method)
    });
    let own = (DEFAULT, String::new(), Method { poses: POSES, sweep: FINE, after_coarse: true });
    let methods = everywhere.into_iter().chain([own]).collect::<Vec<_>>();
    let mut rows = Vec::new();
    for scene in SCENES {
        let mut chance = Chance::new(1);
        let pairs = (0..count).map(|_| pair(&mut chance, scene)).collect::<Vec<_>>();
        let truth = pairs.iter().map(truth).collect::<Vec<_>>();
        let timed = |(_, _, method): &(_, _, Method)| {
            let (method, pairs, mut bisection) = (*method, &pairs, Bisection::to_keep());
            Timed::new(count, move || {
                pairs.iter().for_each(|pair| _ = black_box(meet(method, &mut bisection, black_box(pair))));
            })
        };
        let times = interleaved(&mut methods.iter().map(timed).collect::<Vec<_>>(), rounds);
        for ((name, parameter, method), ns_per_item) in methods.iter().zip(times) {
            let mut bisection = Bisection::default();
            let found = pairs.iter().map(|pair| meet(*method, &mut bisection, pair)).collect::<Vec<_>>();
            let off = found.iter().zip(&truth).filter_map(|(found, truth)| match (found, truth) {
                (Some((of, found)), Some((truly_of, truth))) if of == truly_of => Some((found - truth).abs()),
                _ => None,
            });
            let off = off.collect::<Vec<_>>();
            let is = |all: &[Option<(bool, Metre)>]| all.iter().map(Option::is_some).collect::<Vec<_>>();
            let [missed, invented] = super::decisions::rates(&is(&found), &is(&truth));
            rows.push(Measurement {
                axis: Axis::Turning,
                method: name,
                parameter: format!("{scene}{parameter}"),
                error_name: "mean error of the distance, m",
                error: off.iter().sum::<Metre>() / off.len().max(1) as f64,
                false_negative_rate: missed,
                false_positive_rate: invented,
                ns_per_item,
                items: count,
                on_pareto_front: false,
                scene: scene.to_owned(),
                default: *name == DEFAULT,
            });
        }
    }
    rows
}
