//! The detector alone, both phases, on one core and on two, from 10³ to 10⁶ road users: in a jam, in platoons, uniform; beside it,
//! on the same road users in the same steps, what one would build without it: parry2d's tree with its intersection test
//! per pair, and all pairs with the cheapest test there is. `cargo bench --bench detector`.
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
use rivals::{AllPairs, Boxes, Tree};

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

fn measure(scene: &str, start: Vec<State>) {
    let mut cars = start.clone();
    let (count, options) = (cars.len(), Options::default());
    let mut roster = Roster::default();
    let profile = roster.profile(scenes::car()).unwrap();
    let users = (0..count).map(|number| roster.enter(&number.to_string(), profile)).collect::<Vec<_>>();
    let (car, mut frame) = (roster.profile_at(profile), Frame::default());
    let mut detector = Detector::new(&options, None);
    let mut detector_of_two = Detector::new(&options, None);
    detector_of_two.set_threads(2);
    let mut keeping = [Exclusion::WaysApart, Exclusion::InLine].map(|kept| {
        let options = Options { keep: vec![kept], ..Options::default() };
        (
            format!("keep {}", kept.to_possible_value().unwrap().get_name()),
            Detector::new(&options, None),
            Times::default(),
        )
    });
    let [mut tree, mut straight_tree] = [Boxes::Circles, Boxes::StraightWays].map(Tree::new);
    let mut all_pairs = AllPairs::default();
    let [mut first, mut second, mut both, mut by_two] = [(); 4].map(|()| Times::default());
    let [mut with_tree, mut with_straight_tree, mut with_all] = [(); 3].map(|()| Times::default());
    for round in 0..(3_000_000 / count).clamp(5, 100) {
        frame.begin(frame.time + 0.1);
        // To and fro: nobody yields here, and however many rounds there are, they shall not drive into each other.
        let time = [0.0, 0.1, 0.2, 0.3, 0.2, 0.1][round % 6];
        for ((car, start), user) in cars.iter_mut().zip(&start).zip(&users) {
            car.x = start.x + start.speed * time * start.heading.cos();
            car.y = start.y + start.speed * time * start.heading.sin();
            frame.push(*user, *car);
        }
        first.add(|| {
            detector.follow(&frame, &roster);
            detector.approach(&frame);
        });
        second.add(|| detector.detect(&frame, &roster).len());
        both.0.push(first.0[round] + second.0[round]);
        by_two.add(|| {
            detector_of_two.follow(&frame, &roster);
            detector_of_two.approach(&frame);
            detector_of_two.detect(&frame, &roster).len()
        });
        if count == LARGE && round < 6 {
            for (_, detector, times) in &mut keeping {
                times.add(|| {
                    detector.follow(&frame, &roster);
                    detector.approach(&frame);
                    detector.detect(&frame, &roster).len()
                });
            }
        }
        if count <= LARGE {
            let found = with_tree.add(|| tree.contacts(&cars, car, options.epsilon));
            let again = with_straight_tree.add(|| straight_tree.contacts(&cars, car, options.epsilon));
            assert_eq!(found, again);
        }
        if count < LARGE && round < 5 || count == LARGE && round == 0 {
            with_all.add(|| all_pairs.contacts(&cars, car, options.epsilon));
        }
    }
    first.print(scene, "phase 1", count);
    second.print(scene, "phase 2", count);
    both.print(scene, "closecall", count);
    by_two.print(scene, "two threads", count);
    for (name, _, times) in keeping {
        times.print(scene, &name, count);
    }
    with_tree.print(scene, "parry2d", count);
    with_straight_tree.print(scene, "parry2d (straight)", count);
    with_all.print(scene, "all pairs", count);
}
