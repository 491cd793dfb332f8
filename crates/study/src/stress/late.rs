//! Time left and time to brake: motions that are put back into the definition, in high precision.
//!
//! What is found is a time, and near a contact that only just happens it is ill-conditioned: a time that is wrong by little
//! may belong to a room that differs by less than rounding. So errors are those of the room that the time leads to, in units in
//! the last place of its distances.

use super::braking::{MuInputs, extreme, usual};
use super::case::Case;
use super::tally::{Group, Property, Tally, Unit};
use crate::reference::chance::Chance;
use crate::reference::{BigFloat, braking as reference, nearest, precise};
use closecall::braking::{Brakes, Braking, LateBraking, Leader, MuModel, response_left};
use closecall::util::units::{Metre, Second};

/// The largest error of a room, in units in the last place of the distances that it is the difference of.
const ULPS: f64 = 8.0;
const LEFT: Property =
    Property::within("mu at the response left is the gap, in ulps of the distances", ULPS, Unit::Ulps);
const LEFT_GROWS: Property = Property::always("more gap, less speed, more braking: never less time left");
const BEHIND: Property = Property::within("room used up behind a leader, in ulps of the distances", ULPS, Unit::Ulps);
const AT: Property = Property::within("distance kept at a time, in ulps of the distances", ULPS, Unit::Ulps);
const TOWARDS: Property =
    Property::within("room used up towards oncoming traffic, in ulps of the distances", ULPS, Unit::Ulps);
const GROWS: Property = Property::always("more room, less speed, more braking: never less wait");

pub(super) const CASES: &[Case] = &[
    Case::new(Group::Late, "response left", |chance, tally| {
        let (pair, gap) = (usual(chance), chance.between(0.0, 200.0));
        check_left(chance, &pair, gap, tally);
    }),
    Case::new(Group::Late, "response left, all at once", |chance, tally| {
        let (pair, gap) = (extreme(chance), chance.magnitude(1e-9, 1e6));
        check_left(chance, &pair, gap, tally);
    }),
    Case::new(Group::Late, "behind a leader", |chance, tally| {
        let (braking, leader) = (usual_late(chance), usual_leader(chance));
        check_behind(chance, &braking, &leader, tally);
    }),
    Case::new(Group::Late, "behind a leader as fast or braking alike", |chance, tally| {
        let (braking, leader) = (usual_late(chance), usual_leader(chance));
        let speeds = [leader.speed, braking.speed, braking.speed * (1.0 + f64::EPSILON)];
        let decelerations = [leader.deceleration, braking.deceleration, braking.present, 0.0];
        let (speed, deceleration) = (chance.pick(&speeds), chance.pick(&decelerations));
        check_behind(chance, &braking, &Leader { speed, deceleration, ..leader }, tally);
    }),
    Case::new(Group::Late, "behind a leader, all at once", |chance, tally| {
        let braking = extreme_late(chance);
        let leader = Leader {
            room: chance.magnitude(1e-9, 1e6),
            speed: chance.magnitude(1e-9, 300.0),
            deceleration: chance.magnitude(1e-6, 1e6),
        };
        check_behind(chance, &braking, &leader, tally);
    }),
    Case::new(Group::Late, "no further at a time", |chance, tally| {
        let braking = usual_late(chance);
        let time = chance.between(0.1, 10.0);
        check_at(chance, &braking, time, tally);
    }),
    Case::new(Group::Late, "towards each other", |chance, tally| {
        let (braking, other) = (usual_late(chance), usual_late(chance));
        check_towards(&braking, &other, chance.between(0.0, 1.0), chance.between(0.0, 300.0), tally);
    }),
];

fn usual_late(chance: &mut Chance) -> LateBraking {
    let deceleration = chance.between(3.0, 12.0);
    let part = chance.pick(&[0.0, 1e-9, 0.3, 0.9]);
    LateBraking {
        speed: chance.between(0.01, 60.0),
        present: deceleration * part,
        build_up: chance.pick(&[0.0, 1e-9, 0.1, 2.0]),
        deceleration,
    }
}

fn extreme_late(chance: &mut Chance) -> LateBraking {
    let deceleration = chance.magnitude(1e-6, 1e6);
    LateBraking {
        speed: chance.magnitude(1e-9, 300.0),
        present: deceleration * chance.pick(&[0.0, 1e-12, 1e-3, 0.5, 1.0 - 1e-9]),
        build_up: chance.magnitude(1e-9, 100.0),
        deceleration,
    }
}

fn usual_leader(chance: &mut Chance) -> Leader {
    let (speed, deceleration) = (chance.between(0.0, 60.0), chance.between(0.0, 12.0));
    Leader {
        room: chance.between(0.0, 200.0),
        speed: chance.pick(&[0.0, speed]),
        deceleration: chance.pick(&[0.0, deceleration]),
    }
}

fn check_left(chance: &mut Chance, pair: &MuInputs, gap: Metre, tally: &mut Tally) {
    let gap = gap + pair.epsilon;
    let left = |pair: &MuInputs, gap, model| {
        pair.with(|ego, foe| response_left(model, *ego, *foe, pair.sigma, pair.epsilon, gap))
    };
    for model in MuModel::ALL {
        let found = left(pair, gap, model);
        let inputs = (pair, gap, model, found);
        let with = |response| {
            pair.with(|ego, foe| {
                let brakes = Brakes { response, ..*ego.brakes };
                let foe_brakes =
                    if pair.sigma > 0.0 { *foe.brakes } else { Brakes { response: pair.r, ..*foe.brakes } };
                let (ego, foe) = (Braking { brakes: &brakes, ..*ego }, Braking { brakes: &foe_brakes, ..*foe });
                (
                    reference::mu(model, &ego, &foe, pair.sigma, pair.epsilon),
                    reference::stopping_distance(&ego),
                    reference::stopping_distance(&foe),
                )
            })
        };
        let (needs, travelled, foe_travelled) = with(if found < f64::INFINITY { found } else { 0.0 });
        tally.error(LEFT, error(found, &(precise(gap) - needs), &(travelled + foe_travelled + precise(gap))), &inputs);
        let factor = 1.0 + chance.magnitude(1e-6, 1.0);
        let easier = [
            left(pair, gap * factor, model),
            left(&MuInputs { v: pair.v / factor, ..*pair }, gap, model),
            left(&MuInputs { a: pair.a * factor, ..*pair }, gap, model),
        ];
        tally.holds(LEFT_GROWS, easier.iter().all(|easier| is_no_less(*easier, found)), &(inputs, factor, easier));
    }
}

fn check_behind(chance: &mut Chance, braking: &LateBraking, leader: &Leader, tally: &mut Tally) {
    let found = braking.longest_wait_behind(leader);
    let inputs = (braking, leader, found);
    let wait = wait(found);
    let room = reference::least_room_behind(leader, braking, wait);
    let travelled = precise(leader.room) + reference::late_distance(braking, wait);
    tally.error(BEHIND, error(found, &room, &travelled), &inputs);
    let factor = 1.0 + chance.magnitude(1e-6, 1.0);
    let slower = LateBraking { speed: braking.speed / factor, ..*braking };
    let harder = LateBraking { deceleration: braking.deceleration * factor, ..*braking };
    let easier = [
        braking.longest_wait_behind(&Leader { room: leader.room * factor, ..*leader }),
        slower.longest_wait_behind(leader),
        harder.longest_wait_behind(leader),
        braking.longest_wait_behind(&Leader { speed: leader.speed * factor, ..*leader }),
    ];
    tally.holds(GROWS, easier.iter().all(|easier| is_no_less(*easier, found)), &(inputs, factor, easier));
}

fn check_at(chance: &mut Chance, braking: &LateBraking, time: Second, tally: &mut Tally) {
    let distance = braking.speed * time * chance.between(0.0, 1.1);
    let found = braking.longest_wait_at(time, distance);
    let room = precise(distance) - reference::late_distance_at(braking, wait(found), time);
    tally.error(AT, error(found, &room, &precise(braking.speed * time + distance)), &(braking, time, distance, found));
}

fn check_towards(braking: &LateBraking, other: &LateBraking, share: f64, room: Metre, tally: &mut Tally) {
    let found = braking.longest_wait_towards(other, share, room);
    let wait = wait(found);
    let used = reference::late_distance(braking, wait) + precise(share) * reference::late_distance(other, wait);
    tally.error(
        TOWARDS,
        error(found, &(precise(room) - &used), &(precise(room) + used)),
        &(braking, other, share, room, found),
    );
}

/// A wait as the reference takes it: none lasts for ever, and one below 0 is too long even if it is 0.
fn wait(found: Second) -> Option<Second> {
    (found < f64::INFINITY).then_some(found.max(0.0))
}

/// The error of a longest wait that leads to a room, in units in the last place of `travelled`: no room is left, and none is
/// lacking. For an endless wait only the latter counts, for a wait already too long only the former.
fn error(wait: Second, room: &BigFloat, travelled: &BigFloat) -> f64 {
    if wait.is_nan() || *travelled == BigFloat::ZERO {
        return if wait.is_nan() { f64::INFINITY } else { 0.0 };
    }
    let ulps = nearest(&(room / travelled)) / f64::EPSILON;
    match wait {
        f64::INFINITY => (-ulps).max(0.0),
        _ if wait <= 0.0 => ulps.max(0.0),
        _ => ulps.abs(),
    }
}

/// Whether a wait is at least as long as another, up to rounding; below 0 it only says that any is too long.
fn is_no_less(wait: Second, other: Second) -> bool {
    /// Waits that differ by less, relative to the longer, are equal.
    const SAME: f64 = 1e-9;
    let [wait, other] = [wait, other].map(|wait| wait.max(0.0));
    wait >= other || (wait - other).abs() <= SAME * wait.abs().max(other.abs())
}
