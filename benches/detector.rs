//! The detector alone, both phases, on one core, from 10³ to 10⁶ road users: in a jam, in platoons, uniform; beside it,
//! on the same road users in the same steps, what one would build without it: parry2d's tree with its intersection test
//! per pair, and all pairs, by that test and by the cheapest there is. `cargo bench --bench detector`.
//!
//! Straight paths: routes need SUMO. `-- --scenes FOLDER` also writes the scenes of up to 10⁴ road users, for
//! benches/commonroad.py.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]

#[path = "detector/rivals.rs"]
mod rivals;
mod scenes;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use clap::ValueEnum;
use closecall::{Detector, Options, Profile, Shortcut, State};
use closecall_study::reference::chance::Chance;

use rivals::{AllPairs, AllTested, Boxes, Making, Tree};
use scenes::{Scene, TIMES, detector, wake};

/// With more road users than this, parry2d and all pairs are not measured.
const LARGE: usize = 100_000;

/// Turns of each method. Other load on the machine comes and goes for seconds at a time, so a time is the least of all
/// turns, and a ratio the median of those within a turn.
const TURNS: usize = 3;

/// The same with more than [`LARGE`] road users.
const TURNS_OF_LARGE: usize = 1;

/// The cores are kept busy for this long before each turn, in s.
const WAKING: f64 = 0.5;

/// All pairs take long, so they take part in the first turns only.
const TURNS_OF_ALL_PAIRS: usize = 1;

/// The times of one method, in s.
struct Times {
    name: String,
    /// Those of the current turn.
    turn: Vec<f64>,
    /// The median of each turn.
    medians: Vec<f64>,
}

impl Times {
    fn of(name: impl Into<String>) -> Self {
        Self { name: name.into(), turn: Vec::new(), medians: Vec::new() }
    }

    fn add<T>(&mut self, action: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let result = black_box(action());
        self.turn.push(started.elapsed().as_secs_f64());
        result
    }

    fn end_turn(&mut self) {
        self.medians.push(median(&mut self.turn));
        self.turn.clear();
    }

    /// Prints the time per road user in ns.
    fn print(&self, scene: &str, count: usize) {
        let least = self.medians.iter().fold(f64::INFINITY, |least, time| least.min(*time));
        println!("step,{scene},{},{count},{:.1},ns per road user", self.name, least * 1e9 / count as f64);
    }

    /// Prints it, and the ratio to another method's time in the same turn.
    fn print_beside(&self, other: &Self, scene: &str, count: usize) {
        self.print(scene, count);
        let mut ratios = self.medians.iter().zip(&other.medians).map(|(own, other)| own / other).collect::<Vec<_>>();
        println!("longer,{scene},{},{count},{:.4},times {}", self.name, median(&mut ratios), other.name);
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    wake(2, 15.0);
    let words = std::env::args().skip(1).filter(|word| word != "--bench").collect::<Vec<_>>();
    println!("what,scene,method,size,value,unit");
    for (scene, draw) in scenes::SCENES {
        for count in [1_000, 10_000, LARGE, 1_000_000] {
            let cars = draw(&mut Chance::new(1), count);
            if let ([_, folder], true) = (&words[..], count <= 10_000) {
                scenes::write(&cars, &Path::new(folder).join(format!("{scene}-{count}.csv"))).unwrap();
            }
            measure(scene, cars);
        }
    }
}

/// A method: the detector or a rival.
trait Look {
    /// Does the step.
    fn look(&mut self, scene: &Scene);

    /// Its times: of the whole, then of its parts.
    fn times(&mut self) -> &mut [Times];
}

/// The detector: both phases, and each of them.
struct Phases(Detector, [Times; 3]);

impl Phases {
    fn new(name: &str, options: &Options) -> Self {
        Self(detector(options, 1), [name, "phase 1", "phase 2"].map(Times::of))
    }
}

impl Look for Phases {
    fn look(&mut self, Scene { frame, roster, .. }: &Scene) {
        let Self(detector, [both, first, second]) = self;
        first.add(|| {
            detector.track_paths(frame, roster);
            detector.broad_phase(frame, roster);
        });
        second.add(|| detector.narrow_phase(frame, roster).len());
        both.turn.extend(first.turn.last().zip(second.turn.last()).map(|(first, second)| first + second));
    }

    fn times(&mut self) -> &mut [Times] {
        &mut self.1
    }
}

/// A rival, and how many contacts it found.
struct Rival<Contacts>(Contacts, Times, usize);

impl<Contacts: FnMut(&[State], &Profile) -> usize> Rival<Contacts> {
    fn new(name: &str, contacts: Contacts) -> Self {
        Self(contacts, Times::of(name), 0)
    }
}

impl<Contacts: FnMut(&[State], &Profile) -> usize> Look for Rival<Contacts> {
    fn look(&mut self, scene: &Scene) {
        let Self(contacts, times, found) = self;
        *found += times.add(|| contacts(&scene.now, scene.car()));
    }

    fn times(&mut self) -> &mut [Times] {
        std::slice::from_mut(&mut self.1)
    }
}

/// In each turn one method after the other does all steps, so that its own data are in the cache.
fn measure(name: &str, start: Vec<State>) {
    let (count, options) = (start.len(), Options::default());
    let mut scene = Scene::new(start);
    let mut one = Phases::new("closecall", &options);
    let mut others = Vec::new();
    if count == LARGE {
        others.extend([Shortcut::PathsApart, Shortcut::InLine].map(|kept| {
            let options = Options { no_shortcuts: vec![kept], ..Options::default() };
            Phases::new(&format!("keep {}", kept.to_possible_value().unwrap().get_name()), &options)
        }));
    }
    let mut trees = [
        ("parry2d", Boxes::Circles, Making::Anew),
        ("parry2d (kept)", Boxes::Circles, Making::Kept),
        ("parry2d (kept; straight)", Boxes::StraightWays, Making::Kept),
    ]
    .map(|(name, boxes, making)| {
        let mut tree = Tree::new(boxes, making);
        Rival::new(name, move |cars: &[State], car: &Profile| tree.contacts(cars, car, options.epsilon))
    });
    let (mut circles, mut tested) = (AllPairs::default(), AllTested::default());
    let mut circles = Rival::new("all pairs", |cars: &[State], car| circles.contacts(cars, car, options.epsilon));
    let mut tested = Rival::new("all tested", |cars: &[State], car| tested.contacts(cars, car, options.epsilon));
    let steps = TIMES.repeat((500_000 / TURNS / count).clamp(1, 16));
    let turns = if count > LARGE { TURNS_OF_LARGE } else { TURNS };
    for number in 0..turns {
        let mut turn = |look: &mut dyn Look, steps: &[f64]| {
            for time in steps {
                scene.advance(*time);
                look.look(&scene);
            }
            look.times().iter_mut().for_each(Times::end_turn);
        };
        wake(2, WAKING);
        turn(&mut one, &steps);
        others.iter_mut().for_each(|other| turn(other, &steps));
        if count <= LARGE {
            trees.iter_mut().for_each(|tree| turn(tree, &steps));
        }
        if count <= LARGE && number < TURNS_OF_ALL_PAIRS {
            turn(&mut circles, &steps[..1]);
            turn(&mut tested, &steps[..1]);
        }
    }
    assert!(trees.iter().all(|tree| tree.2 == trees[0].2));
    tested.1.medians.iter_mut().for_each(|time| *time *= AllTested::share(count));
    let closecall = &one.1[0];
    one.1.iter().for_each(|times| times.print(name, count));
    others.iter().for_each(|Phases(_, times)| times[0].print_beside(closecall, name, count));
    if count <= LARGE {
        let rivals = trees.iter().map(|tree| &tree.1).chain([&circles.1, &tested.1]);
        rivals.for_each(|times| times.print_beside(closecall, name, count));
    }
}
