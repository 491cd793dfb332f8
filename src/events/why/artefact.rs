//! What SUMO or a tracker makes, not traffic: an observer would set it aside.
//!
//! SUMO's drivers know distances along their lanes, the links that are foes of theirs, and nothing of how lanes are drawn. So
//! rectangles may overlap where no driver had to notice anything. What appears, stops or jumps within one step was not driven
//! either. docs/artefacts.md has the rules.

use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

use super::manoeuvre::changes_lanes;
use super::pair::{Pair, Party, STANDS};
use crate::detection::kind::Kind;
use crate::detection::path::turn;
use crate::geometry::angle_between;
use crate::geometry::rectangle::direction;
use crate::traffic::net::{LaneIndex, Net};
use crate::traffic::profile::Category;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};

/// A driver who brakes by less has noticed nothing, in m/s²: less than comfortable braking (ITE 3.05, AASHTO 3.4).
const UNBRAKED: MetrePerSecondSquared = 2.5;
/// After another has stopped at once its follower brakes for about this long, in s.
const AFTER_A_STOP: Second = 2.0;
/// A road user turns by no more than a radian in this distance, in m: the turning circle of a small car has 9 to 10 m.
const TURNS_IN: Metre = 2.5;
/// A smaller turn is not a jump, in rad.
const LEAST_TURN: Radian = 0.35;
/// Of two that touch while one follows the other, headings differ by less in any bend that vehicles drive, in rad: on the
/// smallest turning circle, 9 m across, a car of 5 m turns by this over its length.
const FOLDED: Radian = 1.0;
/// A tracked speed may differ from the displacement by this, in m/s, or by half.
const CONTRADICTS: MetrePerSecond = 2.0;
/// A tracked heading may sway by this within 5 s, besides what it turns, in rad.
const SWAYS: Radian = 1.0;
/// A tracked heading that changes by less from half a second to the next is steady, in rad.
const STEADY: Radian = 0.05;
/// A swerving road user turns back up to twice, whatever the angle; a swaying heading does so more often.
const SWERVES: usize = 2;
/// Two whose speeds differ by less than this go along with each other, in m/s.
const ALIKE: MetrePerSecond = 1.0;

/// Why a conflict is none of traffic's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, IntoStaticStr)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Artefact {
    /// Two overlap, or would, where they are drawn and not where they drive.
    DrawnOverlap,
    /// One had just been inserted, or put elsewhere by a teleport.
    Appeared,
    /// One stopped faster than any brakes can.
    StoppedAtOnce,
    /// One changed lanes, or turned, within one step.
    Jumped,
    /// A tracker's error in a recording.
    Tracking,
}

impl Artefact {
    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// That of a pair in a step; none where it is traffic.
    pub(in crate::events) fn of(pair: &Pair) -> Option<Self> {
        let parties = [&pair.ego, &pair.foe];
        let any = |is: &dyn Fn(&Party) -> bool| parties.into_iter().any(is);
        let appears = |party: &Party| party.category != Category::Obstacle && pair.past.is_new(party.user, pair.time);
        let stops = |party: &Party| party.is_vehicle() && party.course.since_impossible_stop < AFTER_A_STOP;
        if pair.around.is_tracked {
            let errs =
                |party: &Party| appears(party) || stops(party) || jumps(pair, party) || is_mistracked(pair, party);
            return (any(&errs) || rides_along(pair)).then_some(Self::Tracking);
        }
        match () {
            () if any(&appears) => Some(Self::Appeared),
            () if any(&stops) => Some(Self::StoppedAtOnce),
            () if any(&|party| jumps(pair, party)) => Some(Self::Jumped),
            () if is_drawn(pair) => Some(Self::DrawnOverlap),
            () => None,
        }
    }
}

/// Whether a vehicle has changed lanes in this step, or turned by more than it can on its way.
fn jumps(pair: &Pair, party: &Party) -> bool {
    if !party.is_vehicle() {
        return false;
    }
    let Party { course, front, heading, .. } = party;
    let turns = || {
        let (_, from, before) = pair.past.of(party.user, pair.time).last()?;
        let turn = angle_between(&direction(before), &direction(*heading));
        Some(turn > LEAST_TURN + (front - from).norm() / TURNS_IN)
    };
    course.has_jumped || course.change.is_some_and(|change| change.time >= pair.time) || turns() == Some(true)
}

/// Whether the speed of a tracked road user contradicts its displacement, or its heading sways more than it turns.
fn is_mistracked(pair: &Pair, party: &Party) -> bool {
    let mut places = pair.past.of(party.user, pair.time).collect::<Vec<_>>();
    places.push((pair.time, party.front, party.heading));
    let contradicts = places.len() > 1 && {
        let [(before, from, _), (now, to, _)] = [places[places.len() - 2], places[places.len() - 1]];
        let displaced = (to - from).norm() / (now - before);
        (displaced - party.speed).abs() > f64::max(CONTRADICTS, party.speed / 2.0)
    };
    let turn_between = |one: Radian, other: Radian| turn(&direction(one), &direction(other));
    let turns = places.windows(2).map(|ends| turn_between(ends[0].2, ends[1].2)).collect::<Vec<_>>();
    let swayed = turns.iter().map(|turn| turn.abs()).sum::<Radian>();
    let turned = places.first().map_or(0.0, |first| turn_between(first.2, party.heading).abs());
    let swings = turns.into_iter().filter(|turn| turn.abs() > STEADY).collect::<Vec<_>>();
    let turns_back = swings.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    let sways = swayed - turned > SWAYS && turns_back > SWERVES;
    party.category != Category::Obstacle && (contradicts || sways)
}

/// Whether a person goes along with a rider: most likely one road user that was tracked twice.
fn rides_along(pair: &Pair) -> bool {
    pair.both().into_iter().any(|(person, rider)| {
        person.category == Category::Person
            && rider.is_vehicle()
            && rider.unprotected
            && direction(person.heading).dot(&direction(rider.heading)) > 0.0
            && (person.speed - rider.speed).abs() < ALIKE
    })
}

/// Whether the two overlap, or would, only as drawn.
fn is_drawn(pair: &Pair) -> bool {
    let Some(net) = pair.around.net else { return false };
    match [&pair.ego, &pair.foe].map(|party| party.category) {
        [Category::Vehicle, Category::Vehicle] => {
            pair.both().into_iter().any(|(one, other)| waits_inside(net, one, other))
                || are_unrelated(net, pair)
                || is_folded(net, pair)
        }
        [Category::Person, Category::Vehicle] => is_not_hit(net, &pair.ego, &pair.foe),
        [Category::Vehicle, Category::Person] => is_not_hit(net, &pair.foe, &pair.ego),
        _ => false,
    }
}

/// Whether a person is where only persons go, or walks into a vehicle that stands.
fn is_not_hit(net: &Net, person: &Party, vehicle: &Party) -> bool {
    person.is_off_the_road(net) || vehicle.speed < STANDS
}

/// Whether one meets its leader head-on, or overlaps it in a bend that no vehicle can drive, as where a lane is folded: SUMO
/// keeps them apart along the lane.
fn is_folded(net: &Net, pair: &Pair) -> bool {
    let [Some(ego), Some(foe)] = [&pair.ego, &pair.foe].map(|party| party.course.at(0.0)) else { return false };
    let follows = ego == foe || net.follows(ego, foe) || net.follows(foe, ego);
    let is_along = !pair.ego.course.is_against && !pair.foe.course.is_against;
    let angle = || angle_between(&direction(pair.ego.heading), &direction(pair.foe.heading));
    follows && is_along && (pair.kind == Kind::Frontal || (pair.found.overlap > 0.0 && angle() > FOLDED))
}

/// Whether the lanes that two take where they would meet are not related, and neither changes lanes.
fn are_unrelated(net: &Net, pair: &Pair) -> bool {
    let [ego, foe] = [&pair.ego, &pair.foe];
    if [ego, foe].into_iter().any(|party| party.course.stretches.is_empty() || party.course.is_against) {
        return false;
    }
    let of_ego = ego.lanes_over([ego.to_meeting; 2]).collect::<Vec<LaneIndex>>();
    let of_foe = foe.lanes_over([0.0, foe.to_meeting]).collect::<Vec<LaneIndex>>();
    let is_known = !of_ego.is_empty() && !of_foe.is_empty();
    let relates = |one: LaneIndex, other: LaneIndex| {
        let is_beside = net.lanes[one].edge == net.lanes[other].edge;
        net.relates(one, other) || (is_beside && changes_lanes(net, pair))
    };
    is_known && !of_ego.iter().any(|one| of_foe.iter().any(|other| relates(*one, *other)))
}

/// Whether one stands inside a junction and the other, which takes another way, passes it without braking. Coming to its rear,
/// on the lane behind the junction's, is not passing.
fn waits_inside(net: &Net, waits: &Party, passes: &Party) -> bool {
    let Some(lane) = waits.course.at(0.0).filter(|lane| waits.speed < STANDS && net.is_internal(*lane)) else {
        return false;
    };
    let comes_from_behind = || {
        let front = passes.course.at(passes.to_meeting);
        front.is_some_and(|front| waits.lanes_over([0.0; 2]).any(|under| under == front))
    };
    passes.speed >= STANDS
        && passes.course.deceleration < UNBRAKED
        && passes.course.of(lane).is_none()
        && !comes_from_behind()
}
