//! Crash and injury probabilities: of any driver, of contacts that are certain or hardly possible.

use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::chance::Chance;
use crate::reference::{nearest, precise, probability as reference};
use closecall::braking::{LateBraking, Leader};
use closecall::detection::kind::Kind;
use closecall::detection::measures::crash_probability::crash_probability;
use closecall::detection::measures::injury::{Body, injury_probability};
use closecall::options::{DriverModel, DriverOptions};
use closecall::traffic::driver_distributions::Driver;

/// The response time's distribution is a single formula.
const LATE: Property = Property::within("response later than a time", 1e-13, Unit::Absolute);
/// 16 nodes for the deceleration, and more where a response time that hardly varies makes nearly a step.
const CRASH: Property = Property::within("crash probability", 1e-3, Unit::Absolute);
const CRASH_OF_ANY: Property = Property::within("crash probability", 1e-2, Unit::Absolute);
/// The weakest sufficient deceleration is found to a hundred-thousandth of its range.
const BRAKES: Property = Property::within("crash probability of a braking driver", 1e-5, Unit::Absolute);
const INJURY: Property = Property::within("injury probability", 1e-13, Unit::Relative);
const CERTAIN: Property = Property::always("between 0 and 1");
const CRASH_GROWS: Property = Property::always("less room, more speed: never less crash probability");
const INJURY_GROWS: Property = Property::always("more change of speed: never less injury probability");

/// Intervals of the reference's integral. Where the response time varies by a fiftieth, its own error is below 1e-4.
const INTERVALS: u32 = 512;

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Probability, "behind a leader", |chance, tally| {
        let (room, speed) = (chance.between(0.0, 120.0), chance.between(0.0, 40.0));
        let leader = Leader { room, speed: chance.pick(&[0.0, speed]), deceleration: chance.pick(&[0.0, 4.5, 9.0]) };
        let speed = chance.between(1.0, 40.0);
        check_crash(chance, speed, &leader, &[0.92, 0.28, 8.45, 1.42, 4.23, 12.68], CRASH, tally);
    })
    .costing(300),
    Case::new(Group::Probability, "any driver", |chance, tally| {
        let mean = chance.between(0.3, 2.5);
        let deceleration = chance.between(3.0, 10.0);
        let driver = [
            mean,
            mean * chance.between(0.02, 0.6),
            deceleration,
            deceleration * chance.between(0.1, 0.3),
            deceleration * chance.between(0.3, 0.8),
            deceleration * chance.between(1.2, 2.0),
        ];
        let leader = Leader { room: chance.between(0.0, 120.0), speed: 0.0, deceleration: 0.0 };
        let speed = chance.between(1.0, 40.0);
        check_crash(chance, speed, &leader, &driver, CRASH_OF_ANY, tally);
    })
    .costing(300),
    Case::new(Group::Probability, "response time from 1e-9 s to 1e9 s", |chance, tally| {
        let (mean, deviation) = (chance.between(0.3, 2.5), chance.between(0.05, 1.0));
        let driver = driver(&[mean, deviation, 8.0, 1.0, 4.0, 12.0]);
        let any = [chance.magnitude(1e-9, 1e9), chance.between(0.0, 4.0) * mean];
        let time = chance.pick(&any);
        let found = driver.responds_later_than(time);
        tally.compare(LATE, found, &reference::Lognormal::new(mean, deviation).above(time), &(mean, deviation, time));
    })
    .costing(20),
    Case::new(Group::Probability, "injury, to 300 m/s", check_injury).costing(10),
];

fn driver(&[response_mean, response_sd, mean, deviation, low, high]: &[f64; 6]) -> Driver {
    let options = DriverOptions {
        response_mean: Some(response_mean),
        response_sd: Some(response_sd),
        deceleration_mean: Some(mean),
        deceleration_sd: Some(deviation),
        deceleration_min: Some(low),
        deceleration_max: Some(high),
        ..DriverOptions::default()
    };
    Driver::new(DriverModel::Attentive, &options, &DriverOptions::default(), 1.0)
}

fn check_crash(chance: &mut Chance, speed: f64, leader: &Leader, of: &[f64; 6], within: Property, tally: &mut Tally) {
    let driver = driver(of);
    let [response_mean, response_sd, braking @ ..] = *of;
    let response = reference::Lognormal::new(response_mean, response_sd);
    let wait = |speed, leader: &Leader, deceleration| {
        LateBraking { speed, present: 0.0, build_up: 0.1, deceleration }.longest_wait_behind(leader)
    };
    let found = crash_probability(&driver, false, |deceleration| wait(speed, leader, deceleration));
    let inputs = (speed, leader, of, found);
    let late = |deceleration| match wait(speed, leader, deceleration) {
        wait if wait <= 0.0 => 1.0,
        f64::INFINITY => 0.0,
        wait => nearest(&response.above(wait)),
    };
    let expected = reference::mean_over_normal(braking, INTERVALS, late);
    tally.error(within, (found - expected).abs(), &(inputs, expected));

    // Braking at once is too late below the deceleration at which the wait is 0, where the integral ends.
    let [mean, deviation, low, high] = braking;
    let is_too_weak = |deceleration| wait(speed, leader, deceleration) < 0.0;
    let needed = weakest(low, high, is_too_weak);
    let found_braking = crash_probability(&driver, true, |deceleration| wait(speed, leader, deceleration));
    let expected =
        reference::normal_between(mean, deviation, low, needed) / reference::normal_between(mean, deviation, low, high);
    tally.error(BRAKES, (found_braking - nearest(&expected)).abs(), &(inputs, needed));

    let factor = 1.0 + chance.magnitude(1e-3, 1.0);
    let worse = [
        crash_probability(&driver, false, |deceleration| wait(speed * factor, leader, deceleration)),
        crash_probability(&driver, false, |deceleration| {
            wait(speed, &Leader { room: leader.room / factor, ..*leader }, deceleration)
        }),
    ];
    tally.holds(CERTAIN, [found, found_braking].iter().chain(&worse).all(|found| (0.0..=1.0).contains(found)), &inputs);
    tally.holds(CRASH_GROWS, worse.iter().all(|worse| *worse >= found - 1e-12), &(inputs, factor, worse));
}

/// The largest value up to which every one is too weak, by halving.
fn weakest(low: f64, high: f64, is_too_weak: impl Fn(f64) -> bool) -> f64 {
    let [mut weak, mut strong] = [low, high];
    if !is_too_weak(low) {
        return low;
    }
    if is_too_weak(high) {
        return high;
    }
    for _ in 0..60 {
        let middle = (weak + strong) / 2.0;
        *(if is_too_weak(middle) { &mut weak } else { &mut strong }) = middle;
    }
    strong
}

fn check_injury(chance: &mut Chance, tally: &mut Tally) {
    let kind = chance.below(Kind::ALL.len());
    let kind = Kind::ALL[kind];
    let speed = chance.magnitude(1e-9, 300.0);
    let unprotected = chance.pick(&[true, false]);
    let foe = Body { delta_v: speed, unprotected };
    let ego = Body { delta_v: 0.0, unprotected: false };
    let found = injury_probability(kind, ego, foe);
    // The exponents in decimal, as printed: km/h for those that nothing protects, miles per hour for occupants.
    let decimal = |thousandths: f64| precise(thousandths) / precise(1000.0);
    let exponent = if unprotected {
        decimal(90.0) * decimal(3600.0) * precise(speed) - decimal(6900.0)
    } else {
        let direction = match kind {
            Kind::Frontal => 0.0,
            Kind::Side => 1462.0,
            Kind::RearEnd => -1921.0,
        };
        let miles = precise(3600.0) * precise(speed) / (precise(1_609_344.0) / precise(1000.0));
        decimal(198.0) * miles + decimal(direction) - decimal(9032.0)
    };
    // The ego, at rest, is hit in front.
    let of_ego = reference::logistic(&-decimal(9032.0));
    let of_foe = reference::logistic(&exponent);
    let expected = if of_foe > of_ego { of_foe } else { of_ego };
    tally.compare(INJURY, found, &expected, &(kind, speed, unprotected));
    tally.holds(CERTAIN, (0.0..=1.0).contains(&found), &(kind, speed, unprotected));
    let worse = injury_probability(kind, ego, Body { delta_v: speed * (1.0 + chance.magnitude(1e-6, 1.0)), ..foe });
    tally.holds(INJURY_GROWS, worse >= found, &(kind, speed, unprotected, worse));
}
