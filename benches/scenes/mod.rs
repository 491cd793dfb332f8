//! Traffic without SUMO, for the benches: a jam, platoons, road users anywhere. The same on every machine.

use std::io::Write;
use std::path::Path;

use closecall::options::Options;
use closecall::study::reference::chance::Chance;
use closecall::traffic::frame::State;
use closecall::traffic::profile::Profile;
use closecall::traffic::sumo_type::SumoType;

pub type Draw = fn(&mut Chance, usize) -> Vec<State>;

pub const SCENES: [(&str, Draw); 3] = [("jam", jam), ("platoons", platoons), ("uniform", uniform)];

/// SUMO's default car.
pub fn car() -> Profile {
    Profile::vehicle(&SumoType::car("car"), &Options::default())
}

/// Writes the road users' rectangles (centre, heading in rad, length, width), for other programs.
pub fn write(cars: &[State], path: &Path) -> std::io::Result<()> {
    let car = car();
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "x,y,heading,length,width")?;
    for State { x, y, heading, .. } in cars {
        let (sine, cosine) = heading.sin_cos();
        let (x, y) = (x - cosine * car.length / 2.0, y - sine * car.length / 2.0);
        writeln!(file, "{x},{y},{heading},{},{}", car.length, car.width)?;
    }
    file.flush()
}

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

/// Platoons of 20 at 50 km/h, 25 m apart, on a grid of two-way streets 200 m apart. Platoons in a lane are 25 to 225 m
/// apart: 1,600 cars per hour and lane, close to capacity. No vehicle waits where streets cross.
fn platoons(chance: &mut Chance, count: usize) -> Vec<State> {
    const CARS: usize = 20;
    const APART: f64 = 25.0;
    /// From a platoon's begin to that of the next, on average, in m.
    const BETWEEN: f64 = 600.0;
    let streets = ((count as f64 / 25.0).sqrt().ceil() as usize).max(1);
    let lanes = 4 * streets;
    let mut cars = Vec::with_capacity(count);
    for platoon in 0..count.div_ceil(CARS) {
        let (lane, place) = (platoon % lanes, platoon / lanes);
        let (street, way) = ((lane / 4) as f64 * 200.0, lane % 4);
        let heading = way as f64 * std::f64::consts::FRAC_PI_2;
        let start = place as f64 * BETWEEN + chance.between(0.0, 100.0);
        for car in 0..CARS.min(count - cars.len()) {
            let along = start + APART * car as f64;
            let (x, y) =
                [(along, street - 1.6), (street + 1.6, along), (along, street + 1.6), (street - 1.6, along)][way];
            cars.push(state(x, y, heading, chance.between(12.0, 14.0)));
        }
    }
    cars
}

/// One road user per 400 m², at random positions and headings, up to 50 km/h.
fn uniform(chance: &mut Chance, count: usize) -> Vec<State> {
    let side = (count as f64 * 400.0).sqrt();
    let mut car =
        || state(chance.between(0.0, side), chance.between(0.0, side), chance.angle(), chance.between(0.0, 14.0));
    (0..count).map(|_| car()).collect()
}
