//! Traffic without SUMO for the benches, the same on every machine: a jam, platoons, road users at random places.

use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::thread::Builder;
use std::time::{Duration, Instant};

use closecall::{Detector, Frame, Options, Profile, Roster, State, SumoType, UserIndex};
use closecall_study::reference::chance::Chance;

pub type Draw = fn(&mut Chance, usize) -> Vec<State>;

pub const SCENES: [(&str, Draw); 3] = [("jam", jam), ("platoons", platoons), ("uniform", uniform)];

/// SUMO's default car.
pub fn car() -> Profile {
    Profile::vehicle(&SumoType::car("car"), &Options::default())
}

/// Writes the rectangles (centre, heading in rad, length, width) and their speeds as input for other programs.
pub fn write(cars: &[State], path: &Path) -> std::io::Result<()> {
    let car = car();
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "x,y,heading,length,width,speed")?;
    for State { x, y, heading, speed, .. } in cars {
        let (sine, cosine) = heading.sin_cos();
        let (x, y) = (x - cosine * car.length / 2.0, y - sine * car.length / 2.0);
        writeln!(file, "{x},{y},{heading},{},{},{speed}", car.length, car.width)?;
    }
    file.flush()
}

/// Times of the steps, to and fro: no road user yields here, so they must not drive on into each other.
pub const TIMES: [f64; 6] = [0.0, 0.1, 0.2, 0.3, 0.2, 0.1];

/// The road users of a scene, which go to and fro.
pub struct Scene {
    pub roster: Roster,
    start: Vec<State>,
    pub now: Vec<State>,
    users: Vec<UserIndex>,
    pub frame: Frame,
}

impl Scene {
    pub fn new(start: Vec<State>) -> Self {
        let mut roster = Roster::default();
        let profile = roster.profile(car()).unwrap();
        let users = (0..start.len()).map(|number| roster.enter(&number.to_string(), profile)).collect();
        Self { roster, now: start.clone(), start, users, frame: Frame::default() }
    }

    pub fn car(&self) -> &Profile {
        self.roster.profile_of(self.users[0])
    }

    pub fn advance(&mut self, time: f64) {
        self.frame.begin(self.frame.time + 0.1);
        for ((car, start), user) in self.now.iter_mut().zip(&self.start).zip(&self.users) {
            car.x = start.x + start.speed * time * start.heading.cos();
            car.y = start.y + start.speed * time * start.heading.sin();
            self.frame.push(*user, *car);
        }
    }
}

/// A detector without a net, set up as a run does.
pub fn detector(options: &Options, threads: usize) -> Detector {
    let mut detector = Detector::new(options, None);
    detector.set_conflicts_only(true);
    detector.set_threads(threads);
    detector
}

/// Keeps this many cores busy. A virtual machine gets its idle cores back only little by little: two threads gained a
/// third of what they gain on busy cores, as beside SUMO.
pub fn wake(cores: usize, seconds: f64) {
    let until = Instant::now() + Duration::from_secs_f64(seconds);
    let busy = || while black_box(Instant::now()) < until {};
    std::thread::scope(|scope| (0..cores).for_each(|_| drop(Builder::new().spawn_scoped(scope, busy))));
}

fn state(x: f64, y: f64, heading: f64, speed: f64) -> State {
    State { x, y, z: 0.0, heading, speed }
}

/// A jam on four lanes of a motorway, bumper to bumper, at walking pace.
fn jam(chance: &mut Chance, count: usize) -> Vec<State> {
    let car = |place: usize| {
        let (row, lane) = (place / 4, place % 4);
        state(row as f64 * 7.5 + chance.between(-0.5, 0.5), lane as f64 * 3.2, 0.0, chance.between(0.5, 1.5))
    };
    (0..count).map(car).collect()
}

/// Platoons of 20 at 50 km/h, with 25 m between cars, on a grid of two-way streets 200 m apart. Platoons in the same lane
/// are 25 to 225 m apart: 1,600 cars per hour and lane, close to capacity. No car waits at a crossing.
fn platoons(chance: &mut Chance, count: usize) -> Vec<State> {
    const CARS: usize = 20;
    const APART: f64 = 25.0;
    /// The mean distance between the fronts of platoons in m.
    const BETWEEN: f64 = 600.0;
    let streets = ((count as f64 / 25.0).sqrt().ceil() as usize).max(1);
    let lanes = 4 * streets;
    let mut cars = Vec::with_capacity(count);
    for platoon in 0..count.div_ceil(CARS) {
        let lane = platoon % lanes;
        let place = platoon / lanes;
        let street = (lane / 4) as f64 * 200.0;
        let turn = lane % 4;
        let heading = turn as f64 * std::f64::consts::FRAC_PI_2;
        let start = place as f64 * BETWEEN + chance.between(0.0, 100.0);
        for car in 0..CARS.min(count - cars.len()) {
            let along = start + APART * car as f64;
            let (x, y) =
                [(along, street - 1.6), (street + 1.6, along), (along, street + 1.6), (street - 1.6, along)][turn];
            cars.push(state(x, y, heading, chance.between(12.0, 14.0)));
        }
    }
    cars
}

/// Road users at random places, one per 400 m², with random headings, at up to 50 km/h.
fn uniform(chance: &mut Chance, count: usize) -> Vec<State> {
    let side = (count as f64 * 400.0).sqrt();
    let mut car =
        || state(chance.between(0.0, side), chance.between(0.0, side), chance.angle(), chance.between(0.0, 14.0));
    (0..count).map(|_| car()).collect()
}
