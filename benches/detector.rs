//! The detector alone, both phases, from 10³ to 10⁶ road users: in a jam, in platoons, uniform. `cargo bench --bench
//! detector`. Straight paths: without SUMO nobody has a route.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may")]

use std::hint::black_box;
use std::time::Instant;

use closecall::detector::Detector;
use closecall::frame::{Frame, Roster, State};
use closecall::options::Options;
use closecall::profile::{Profile, SumoType};
use closecall::reference::chance::Chance;

type Draw = fn(&mut Chance, usize) -> Vec<State>;

fn state(x: f64, y: f64, heading: f64, speed: f64) -> State {
    State { x, y, z: 0.0, heading, speed }
}

/// Four lanes of a motorway, bumper to bumper, at walking pace.
fn jam(chance: &mut Chance, count: usize) -> Vec<State> {
    let car = |place: usize| {
        let (row, lane) = (place / 4, place % 4);
        state(row as f64 * 7.5 + chance.between(-0.5, 0.5), lane as f64 * 3.2, 0.0, chance.between(0.5, 1.5))
    };
    (0..count).map(car).collect()
}

/// Platoons of 20 at 50 km/h, 25 m apart, on a grid of two-way streets 200 m apart.
fn platoons(chance: &mut Chance, count: usize) -> Vec<State> {
    let streets = ((count as f64 / 30.0).sqrt().ceil() as usize).max(1);
    let length = streets as f64 * 200.0;
    let mut cars = Vec::with_capacity(count);
    while cars.len() < count {
        let (street, start) = (chance.below(streets) as f64 * 200.0, chance.between(0.0, length));
        let way = chance.below(4);
        for place in 0..20.min(count - cars.len()) {
            let along = start + 25.0 * place as f64;
            let heading = way as f64 * std::f64::consts::FRAC_PI_2;
            let (x, y) =
                [(along, street - 1.6), (street + 1.6, along), (along, street + 1.6), (street - 1.6, along)][way];
            cars.push(state(x, y, heading, chance.between(12.0, 14.0)));
        }
    }
    cars
}

/// One on 400 m², anywhere, any way, up to 50 km/h.
fn uniform(chance: &mut Chance, count: usize) -> Vec<State> {
    let side = (count as f64 * 400.0).sqrt();
    let mut car =
        || state(chance.between(0.0, side), chance.between(0.0, side), chance.angle(), chance.between(0.0, 14.0));
    (0..count).map(|_| car()).collect()
}

fn main() {
    let options = Options::default();
    let sumo = SumoType {
        name: "car".to_owned(),
        vehicle_class: "passenger".to_owned(),
        shape: "passenger".to_owned(),
        length: 5.0,
        width: 1.8,
        mass: 1500.0,
        emergency_decel: 9.0,
        decel: 4.5,
    };
    let scenes: [(&str, Draw); 3] = [("jam", jam), ("platoons", platoons), ("uniform", uniform)];
    println!("scene, road users, ns per road user and step: phase 1, phase 2; pairs, encounters per road user");
    for (scene, draw) in scenes {
        for count in [1_000, 10_000, 100_000, 1_000_000] {
            let mut roster = Roster::default();
            let profile = roster.profile(Profile::vehicle(&sumo, &options)).unwrap();
            let mut frame = Frame::default();
            let mut cars = draw(&mut Chance::new(1), count);
            let users = (0..count).map(|number| roster.enter(&number.to_string(), profile)).collect::<Vec<_>>();
            let mut detector = Detector::new(&options, None);
            let (mut first, mut second, mut found) = (Vec::new(), Vec::new(), 0);
            let rounds = (3_000_000 / count).clamp(5, 100);
            for _ in 0..rounds {
                frame.begin(frame.time + 0.1);
                for (car, user) in cars.iter_mut().zip(&users) {
                    car.x += car.speed * 0.1 * car.heading.cos();
                    car.y += car.speed * 0.1 * car.heading.sin();
                    frame.push(*user, *car);
                }
                let started = Instant::now();
                black_box(detector.approach(&frame, &roster));
                let between = Instant::now();
                found = detector.detect(&frame, &roster).len();
                first.push(between - started);
                second.push(between.elapsed());
            }
            let median = |times: &mut Vec<std::time::Duration>| {
                times.sort();
                times[times.len() / 2].as_secs_f64() * 1e9 / count as f64
            };
            let work = detector.work();
            println!(
                "{scene}, {count}, {:.0}, {:.0}; {:.2}, {:.2}",
                median(&mut first),
                median(&mut second),
                work.pairs as f64 / work.rows as f64,
                found as f64 / count as f64
            );
        }
    }
}
