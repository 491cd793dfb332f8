//! The detector alone, both phases, on one core and on two, from 10³ to 10⁶ road users: in a jam, in platoons, uniform; beside it,
//! on the same road users in the same steps, what one would build without it: parry2d's tree with its intersection test
//! per pair, and all pairs, by that test and by the cheapest there is. `cargo bench --bench detector`.
//!
//! Straight paths: without SUMO nobody has a route. `-- --scenes FOLDER` also writes the scenes of up to 10⁴ road
//! users, for benches/commonroad.py.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]

#[path = "detector/rivals.rs"]
mod rivals;
mod scenes;

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use clap::ValueEnum;
use closecall::detector::Detector;
use closecall::frame::{Frame, Roster, State};
use closecall::options::Options;
use closecall::reference::chance::Chance;
use closecall::scene::Exclusion;
use rivals::{AllPairs, AllTested, Boxes, Tree};

/// With more road users than this parry2d and all pairs are not asked; with as many, all pairs only once.
const LARGE: usize = 100_000;

/// The times of one way to look at a step, in s.
#[derive(Default)]
struct Times(Vec<f64>);

impl Times {
    fn add<T>(&mut self, action: impl FnOnce() -> T) -> T {
        let started = Instant::now();
        let result = black_box(action());
        self.0.push(started.elapsed().as_secs_f64());
        result
    }

    /// Prints the median per road user in ns, if there is one.
    fn print(mut self, scene: &str, method: &str, count: usize) {
        self.0.sort_by(f64::total_cmp);
        if let Some(median) = self.0.get(self.0.len() / 2) {
            println!("step,{scene},{method},{count},{:.1},ns per road user", median * 1e9 / count as f64);
        }
    }
}

fn main() {
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

/// To and fro: nobody yields here, and however many steps there are, they shall not drive into each other.
const TIMES: [f64; 6] = [0.0, 0.1, 0.2, 0.3, 0.2, 0.1];

/// One after the other looks at all steps: in a process there is only one, with its data in the cache.
fn measure(scene: &str, start: Vec<State>) {
    let (count, options) = (start.len(), Options::default());
    let mut roster = Roster::default();
    let profile = roster.profile(scenes::car()).unwrap();
    let users = (0..count).map(|number| roster.enter(&number.to_string(), profile)).collect::<Vec<_>>();
    let (car, mut frame, mut cars) = (roster.profile_at(profile), Frame::default(), start.clone());
    let advance = |frame: &mut Frame, cars: &mut [State], time: f64| {
        frame.begin(frame.time + 0.1);
        for ((car, start), user) in cars.iter_mut().zip(&start).zip(&users) {
            car.x = start.x + start.speed * time * start.heading.cos();
            car.y = start.y + start.speed * time * start.heading.sin();
            frame.push(*user, *car);
        }
    };
    let mut detector = Detector::new(&options, None);
    let [mut first, mut second, mut both] = [(); 3].map(|()| Times::default());
    let mut two = Detector::new(&options, None);
    two.set_threads(2);
    let mut others = vec![("two threads".to_owned(), two, Times::default())];
    if count == LARGE {
        others.extend([Exclusion::WaysApart, Exclusion::InLine].map(|kept| {
            let options = Options { keep: vec![kept], ..Options::default() };
            let name = format!("keep {}", kept.to_possible_value().unwrap().get_name());
            (name, Detector::new(&options, None), Times::default())
        }));
    }
    let mut trees = [("parry2d", Boxes::Circles), ("parry2d (straight)", Boxes::StraightWays)]
        .map(|(name, boxes)| (name, Tree::new(boxes), Times::default(), 0));
    let (mut all_pairs, mut with_all) = (AllPairs::default(), Times::default());
    let (mut all_tested, mut with_tests) = (AllTested::default(), Times::default());
    let steps = TIMES.repeat((500_000 / count).clamp(1, 16));
    for &time in &steps {
        advance(&mut frame, &mut cars, time);
        first.add(|| {
            detector.follow(&frame, &roster);
            detector.approach(&frame, &roster);
        });
        second.add(|| detector.detect(&roster).len());
        both.0.push(first.0[first.0.len() - 1] + second.0[second.0.len() - 1]);
    }
    drop(detector);
    for (_, detector, times) in &mut others {
        for &time in &steps {
            advance(&mut frame, &mut cars, time);
            times.add(|| {
                detector.follow(&frame, &roster);
                detector.approach(&frame, &roster);
                detector.detect(&roster).len()
            });
        }
    }
    if count <= LARGE {
        for (_, tree, times, found) in &mut trees {
            for &time in &steps {
                advance(&mut frame, &mut cars, time);
                *found += times.add(|| tree.contacts(&cars, car, options.epsilon));
            }
        }
        assert_eq!(trees[0].3, trees[1].3);
        for _ in 0..if count < LARGE { 5 } else { 1 } {
            with_all.add(|| all_pairs.contacts(&cars, car, options.epsilon));
            with_tests.add(|| all_tested.contacts(&cars, car, options.epsilon));
        }
    }
    first.print(scene, "phase 1", count);
    second.print(scene, "phase 2", count);
    both.print(scene, "closecall", count);
    for (name, _, times) in others {
        times.print(scene, &name, count);
    }
    for (name, _, times, _) in trees {
        times.print(scene, name, count);
    }
    with_all.print(scene, "all pairs", count);
    with_tests.0.iter_mut().for_each(|time| *time *= AllTested::share(count));
    with_tests.print(scene, "all tested", count);
}
