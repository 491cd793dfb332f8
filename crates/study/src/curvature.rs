//! The window of states from which `--path arc` takes the curvature: a short one follows noise, a long one sees a bend late.

use std::f64::consts::PI;
use std::hint::black_box;

use super::clock::{Timed, interleaved};
use super::measurement::{Axis, Measurement, Plan};
use super::reference::chance::Chance;
use closecall::detection::path::turning::Turning;
use closecall::detection::path::{Pose, arc};
use closecall::geometry::rectangle::direction;
use closecall::geometry::{Point, Vector};
use closecall::util::units::{Metre, MetrePerSecond, Radian, Second};

/// Windows as multiples of closecall's, which is 1 s and 2 m; 0 keeps the last two states.
const WINDOWS: [f64; 6] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0];
const DEFAULT: f64 = 1.0;
const STEP: Second = 0.1;
/// The place is predicted this far ahead.
const AHEAD: Second = 2.0;
const LENGTH: Metre = 5.0;
/// How well places (m) and headings (degrees) are known: rounded to this, or with a normal error of it.
const SCENES: [(&str, Noise); 3] = [
    ("exact states", Noise::Rounded(1e-9, 1e-9)),
    ("recorded with two decimals", Noise::Rounded(0.01, 0.01)),
    ("tracked in a video: 0.1 m, 0.5 degrees", Noise::Normal(0.1, 0.5)),
];

#[derive(Clone, Copy)]
enum Noise {
    Rounded(Metre, f64),
    Normal(Metre, f64),
}

impl Noise {
    fn of(self, chance: &mut Chance, [x, y]: [Metre; 2], heading: Radian) -> (Point, Vector) {
        let degrees = heading.to_degrees();
        let (x, y, degrees) = match self {
            Self::Rounded(place, angle) => {
                let to = |value: f64, unit: f64| (value / unit).round() * unit;
                (to(x, place), to(y, place), to(degrees, angle))
            }
            Self::Normal(place, angle) => {
                let mut off = |deviation: f64| deviation * chance.normal();
                (x + off(place), y + off(place), degrees + off(angle))
            }
        };
        (Point::new(x, y), direction(degrees.to_radians()))
    }
}

/// A way of straight parts and bends: for each part its length and curvature.
struct Road(Vec<[Metre; 2]>);

impl Road {
    fn draw(chance: &mut Chance) -> Self {
        let mut parts = Vec::new();
        for _ in 0..3 {
            let (radius, angle) = (chance.magnitude(8.0, 150.0), chance.between(0.3, 0.5 * PI));
            parts.push([chance.between(10.0, 60.0), 0.0]);
            parts.push([radius * angle, chance.pick(&[1.0, -1.0]) / radius]);
        }
        Self(parts)
    }

    fn length(&self) -> Metre {
        self.0.iter().map(|[length, _]| length).sum()
    }

    /// No more than 3 m/s² to the side.
    fn speed(&self, chance: &mut Chance) -> MetrePerSecond {
        let tightest = self.0.iter().map(|[_, curvature]| curvature.abs()).fold(0.0, f64::max);
        chance.between(3.0, 15.0).min((3.0 / tightest).sqrt())
    }

    /// The place at a distance along the way.
    fn place(&self, mut distance: Metre) -> [Metre; 2] {
        let [mut x, mut y, mut heading] = [0.0; 3];
        for [length, curvature] in &self.0 {
            let part = distance.min(*length);
            let half = part * curvature / 2.0;
            let chord = if half == 0.0 { part } else { part * half.sin() / half };
            x += chord * (heading + half).cos();
            y += chord * (heading + half).sin();
            heading += 2.0 * half;
            distance -= part;
            if distance <= 0.0 {
                break;
            }
        }
        [x, y]
    }

    /// The heading of a road user whose front is there: from its rear on the way to the front.
    fn heading(&self, distance: Metre) -> Radian {
        let ([x, y], [rear_x, rear_y]) = (self.place(distance), self.place(distance - LENGTH));
        (y - rear_y).atan2(x - rear_x)
    }
}

/// A state as it is known, and where the front bumper really is later.
struct Seen {
    time: Second,
    front: Point,
    axis: Vector,
    speed: MetrePerSecond,
    later: [Metre; 2],
}

/// The states of one road user along a way.
fn drive(chance: &mut Chance, noise: Noise) -> Vec<Seen> {
    let road = Road::draw(chance);
    let speed = road.speed(chance);
    let steps = ((road.length() - LENGTH) / speed - AHEAD) / STEP;
    let seen = |step: u32| {
        let time = f64::from(step) * STEP;
        let driven = LENGTH + speed * time;
        let (front, axis) = noise.of(chance, road.place(driven), road.heading(driven));
        Seen { time, front, axis, speed, later: road.place(driven + speed * AHEAD) }
    };
    (0..steps.max(0.0) as u32).map(seen).collect()
}

/// The curvature at each state.
fn curvatures(drive: &[Seen], windows: f64) -> impl Iterator<Item = (&Seen, f64)> {
    let mut turning = Turning::default();
    drive.iter().map(move |seen| {
        turning.see_within(windows, seen.time, seen.front, seen.axis);
        (seen, turning.curvature)
    })
}

/// How far from its real place the front bumper is predicted.
fn error(seen: &Seen, curvature: f64, poses: &mut Vec<Pose>) -> Metre {
    poses.clear();
    arc::poses(seen.front, seen.axis, curvature, LENGTH, &[seen.speed * AHEAD], poses);
    let [x, y] = seen.later;
    poses.last().map_or(f64::NAN, |pose| (pose.front - Point::new(x, y)).norm())
}

pub(super) fn measure(plan: &Plan) -> Vec<Measurement> {
    let (count, rounds) = if plan.quick { (50, 5) } else { (1_000, 9) };
    let mut rows = Vec::new();
    for (scene, noise) in SCENES {
        let mut chance = Chance::new(1);
        let drives = (0..count).map(|_| drive(&mut chance, noise)).collect::<Vec<_>>();
        let states = drives.iter().map(Vec::len).sum::<usize>();
        let timed = |windows: &f64| {
            let (windows, drives) = (*windows, &drives);
            Timed::new(states, move || {
                drives.iter().for_each(|drive| curvatures(drive, windows).for_each(|found| _ = black_box(found.1)));
            })
        };
        let times = interleaved(&mut WINDOWS.iter().map(timed).collect::<Vec<_>>(), rounds);
        for (windows, ns_per_item) in WINDOWS.into_iter().zip(times) {
            let mut poses = Vec::new();
            let found = drives.iter().flat_map(|drive| curvatures(drive, windows));
            let errors = found.map(|(seen, curvature)| error(seen, curvature, &mut poses)).sum::<Metre>();
            rows.push(Measurement {
                axis: Axis::Curvature,
                method: if windows == 0.0 { "two states" } else { "window" },
                parameter: if windows == 0.0 { scene.to_owned() } else { format!("{scene}, {windows} s") },
                error_name: "mean error of the place 2 s ahead, m",
                error: errors / states.max(1) as f64,
                false_negative_rate: 0.0,
                false_positive_rate: 0.0,
                ns_per_item,
                items: states,
                on_pareto_front: false,
                scene: scene.to_owned(),
                default: windows == DEFAULT,
            });
        }
    }
    rows
}
