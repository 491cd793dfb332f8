//! Stiff brakes: stopping distance and μ if terms differ greatly in size, cancel, or are almost zero.

use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::braking as reference;
use crate::reference::chance::Chance;
use crate::reference::{LEAST_SIZE, deviation, nearest};
use closecall::braking::{Brakes, Braking, MuModel, mu, stopping_distance};
use closecall::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// The largest relative error of a published μ.
const BOUND: f64 = 1e-12;
/// A closed form of a few operations.
const STOPPING: Property = Property::within("stopping distance, in ulps", 4.0, Unit::Ulps);
/// μ is a difference: rounding is that of the distances that it is the difference of.
const OF_DISTANCES: Property = Property::within("mu, in ulps of the distances", 8.0, Unit::Ulps);
const MINIMAL: Property = Property::within("mu minimal", BOUND, Unit::Relative);
const AT_REST: Property = Property::within("mu at_rest", BOUND, Unit::Relative);
const PAPER: Property = Property::within("mu paper", BOUND, Unit::Relative);
const ORDER: Property = Property::always("minimal >= at_rest >= epsilon");
const MONOTONE: Property = Property::always("more speed, less braking, more response: never less");

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Braking, "deceleration 1e-9 to 1e9", |chance, tally| {
        let pair = MuInputs { a: chance.magnitude(1e-9, 1e9), ai: chance.magnitude(1e-9, 1e9), ..usual(chance) };
        check(chance, &pair, tally);
    }),
    Case::new(Group::Braking, "build-up 0 to 100 s", |chance, tally| {
        let pair = MuInputs { t3: chance.magnitude(1e-9, 100.0), ..usual(chance) };
        check(chance, &pair, tally);
    }),
    Case::new(Group::Braking, "speed 5e-324 to 300 m/s", |chance, tally| {
        let least = f64::from_bits(1);
        let speeds = [0.0, least, chance.magnitude(f64::MIN_POSITIVE, 1e-200), chance.magnitude(1e-200, 300.0)];
        let pair = MuInputs { v: chance.pick(&speeds), vi: chance.pick(&speeds), ..usual(chance) };
        check(chance, &pair, tally);
    }),
    Case::new(Group::Braking, "equal speeds and brakes", |chance, tally| {
        let base = usual(chance);
        let last_places = |chance: &mut Chance, value: f64| value * (1.0 + f64::from(chance.around(4)) * f64::EPSILON);
        let vi = last_places(chance, base.v);
        let ai = last_places(chance, base.a);
        let pair = MuInputs {
            vi,
            ai,
            r: chance.pick(&[0.0, 1e-12, 1.0]),
            t3: chance.pick(&[0.0, 1e-9, 0.1]),
            sigma: 1.0,
            ..base
        };
        check(chance, &pair, tally);
    }),
    Case::new(Group::Braking, "no response, no build-up", |chance, tally| {
        let pair = MuInputs { r: 0.0, t3: 0.0, ..usual(chance) };
        check(chance, &pair, tally);
    }),
    Case::new(Group::Braking, "all at once", |chance, tally| {
        let pair = extreme(chance);
        check(chance, &pair, tally);
    }),
];

/// The inputs of a μ.
#[derive(Clone, Copy, Debug)]
pub(super) struct MuInputs {
    pub v: MetrePerSecond,
    pub vi: MetrePerSecond,
    pub a: MetrePerSecondSquared,
    pub ai: MetrePerSecondSquared,
    pub r: Second,
    pub t3: Second,
    pub sigma: f64,
    pub epsilon: Metre,
}

impl MuInputs {
    pub fn with<T>(&self, use_it: impl FnOnce(&Braking, &Braking) -> T) -> T {
        let brakes = Brakes { response: self.r, build_up: self.t3, deceleration: self.a };
        let foe_brakes = Brakes { deceleration: self.ai, ..brakes };
        use_it(&Braking { speed: self.v, brakes: &brakes }, &Braking { speed: self.vi, brakes: &foe_brakes })
    }

    fn mu(&self, model: MuModel) -> f64 {
        self.with(|ego, foe| mu(model, *ego, *foe, self.sigma, self.epsilon))
    }
}

pub(super) fn usual(chance: &mut Chance) -> MuInputs {
    MuInputs {
        v: chance.between(0.0, 60.0),
        vi: chance.between(0.0, 60.0),
        a: chance.between(1.0, 12.0),
        ai: chance.between(1.0, 12.0),
        r: chance.between(0.0, 3.0),
        t3: chance.between(0.0, 1.0),
        sigma: chance.angle().cos(),
        epsilon: chance.pick(&[0.0, 0.5]),
    }
}

pub(super) fn extreme(chance: &mut Chance) -> MuInputs {
    let sigmas = [1.0, 1.0 - f64::EPSILON, 1e-300, 0.0, -1e-300, -1.0];
    MuInputs {
        v: chance.magnitude(1e-12, 300.0),
        vi: chance.magnitude(1e-12, 300.0),
        a: chance.magnitude(1e-9, 1e9),
        ai: chance.magnitude(1e-9, 1e9),
        r: chance.magnitude(1e-9, 10.0),
        t3: chance.magnitude(1e-9, 100.0),
        sigma: chance.pick(&sigmas),
        epsilon: 0.0,
    }
}

fn check(chance: &mut Chance, pair: &MuInputs, tally: &mut Tally) {
    pair.with(|ego, foe| {
        tally.compare(STOPPING, stopping_distance(ego.speed, ego.brakes), &reference::stopping_distance(ego), pair);
        let of_foe = nearest(&reference::stopping_distance(foe));
        let distances = nearest(&reference::stopping_distance(ego)) + pair.sigma.abs() * of_foe + pair.epsilon;
        for (model, property) in [(MuModel::Minimal, MINIMAL), (MuModel::AtRest, AT_REST), (MuModel::Paper, PAPER)] {
            let expected = reference::mu(model, ego, foe, pair.sigma, pair.epsilon);
            tally.compare(property, pair.mu(model), &expected, pair);
            // The printed formula uses other distances.
            if model != MuModel::Paper {
                let off = deviation(pair.mu(model), &expected).absolute;
                tally.error(OF_DISTANCES, off / (distances * f64::EPSILON).max(LEAST_SIZE), &(pair, model));
            }
        }
    });
    let minimal = pair.mu(MuModel::Minimal);
    let at_rest = pair.mu(MuModel::AtRest);
    tally.holds(ORDER, minimal >= at_rest * (1.0 - BOUND) && at_rest >= pair.epsilon, pair);
    let factor = 1.0 + chance.magnitude(1e-6, 1.0);
    let worse = [
        MuInputs { v: pair.v * factor, ..*pair },
        MuInputs { a: pair.a / factor, ..*pair },
        MuInputs { r: pair.r * factor, ..*pair },
    ];
    for changed in worse {
        // With σ < 0 the response time applies to both, and a longer one needs more room for both.
        let more = [(MuModel::Minimal, minimal), (MuModel::AtRest, at_rest)];
        let holds = more.iter().all(|(model, before)| changed.mu(*model) >= before * (1.0 - BOUND));
        tally.holds(MONOTONE, holds, &(pair, changed));
    }
}
