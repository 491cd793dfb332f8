//! What the two of a pair were doing, in the vocabulary of NHTSA's pre-crash typology (Najm, Smith and Yanagisawa 2007,
//! DOT HS 810 767), from the lanes and links before and behind their conflict point. docs/causes.md has the rules.

use serde::Serialize;
use strum::IntoStaticStr;

use super::pair::{Pair, Party, STANDS, edge_of, turn_between};
use crate::detection::kind::Kind;
use crate::traffic::net::{Direction, Net, Passage};
use crate::traffic::profile::Category;
use crate::util::units::{Metre, MetrePerSecond, Radian, Second};

/// How long a change of lanes counts as under way, in s: as long as one takes on average (Toledo and Zohar 2007,
/// doi:10.3141/1999-08).
const LANE_CHANGE: Second = 4.6;
/// A road user that moves to the side faster than this, towards another lane, changes lanes, in m/s: keeping to a lane takes
/// less.
const DRIFT: MetrePerSecond = 0.3;
/// Two that come from directions further apart than this drive towards each other, in rad.
const OPPOSITE: Radian = 0.75 * std::f64::consts::PI;
/// Two that come from directions nearer than this drive side by side, in rad.
const ALIKE: Radian = 0.25 * std::f64::consts::PI;
/// Where two ways join, the first of both is behind the joint by at least this at the conflict point, in m.
const AT_THE_JOINT: Metre = 0.1;

/// What the two of a conflict were doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, IntoStaticStr)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum), value(rename_all = "snake_case"))]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Manoeuvre {
    /// One after the other in one lane, or out of it.
    Following,
    /// The foe has just moved into the lane of the ego behind it.
    CutIn,
    /// The ego moves, or has just moved, into the foe's lane.
    LaneChange,
    /// Side by side in one direction, and neither changes lanes.
    SideBySide,
    /// Two lanes become one, and both drive straight on.
    Merge,
    /// Their paths cross; neither turns across the other's direction.
    Crossing,
    /// One turns left across the other's path, which comes towards it or runs beside it.
    LeftTurnAcross,
    /// One turns right across the other's path.
    RightTurnAcross,
    /// One turns into the road that the other drives on.
    TurnInto,
    /// One overtakes on the lane of the oncoming other.
    OvertakingOncoming,
    /// They drive towards each other.
    HeadOn,
    /// A person walks across the other's way.
    PersonCrossing,
    /// A person walks along the other's way.
    PersonAlong,
    /// A person stands in the other's way, as at the corner of a pavement.
    PersonStanding,
    /// One is an obstacle.
    Object,
}

impl Manoeuvre {
    /// The name in columns and tables.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// That of a pair in a step; none where the lanes of the two are not known.
    pub(super) fn of(pair: &Pair) -> Option<Self> {
        let categories = [pair.ego.category, pair.foe.category];
        if categories.contains(&Category::Obstacle) {
            return Some(Self::Object);
        }
        if categories.contains(&Category::Person) {
            if pair.both().iter().any(|(party, _)| stands_aside(pair, party)) {
                return Some(Self::PersonStanding);
            }
            let across = pair.kind == Kind::Side || pair.passages.is_some();
            return Some(if across { Self::PersonCrossing } else { Self::PersonAlong });
        }
        let net = pair.around.net?;
        let courses = [&pair.ego.course, &pair.foe.course];
        if courses.iter().any(|course| course.stretches.is_empty()) {
            return None;
        }
        match courses.map(|course| course.is_against) {
            [false, false] => {}
            [true, true] => return Some(Self::Following),
            _ if pair.kind == Kind::Frontal => return Some(Self::OvertakingOncoming),
            _ => return Some(Self::LaneChange),
        }
        if follow_each_other(pair) {
            return Some(in_one_direction(pair));
        }
        if let Some(passages) = pair.passages {
            return Some(through_a_junction(net, pair, passages));
        }
        let edges =
            |party: &Party| party.course.stretches.iter().map(|stretch| edge_of(net, stretch.lane)).collect::<Vec<_>>();
        let [ego, foe] = [&pair.ego, &pair.foe].map(edges);
        match pair.kind {
            _ if shares_a_lane(pair) => Some(Self::Merge),
            Kind::Frontal => Some(Self::HeadOn),
            _ if ego.iter().any(|edge| foe.contains(edge)) => Some(in_one_direction(pair)),
            Kind::Side => Some(Self::Crossing),
            Kind::RearEnd => None,
        }
    }
}

/// Whether a person stands, and not on a crossing.
fn stands_aside(pair: &Pair, party: &Party) -> bool {
    let is_on_crossing = || pair.around.net.is_some_and(|net| party.is_on_crossing(net));
    party.category == Category::Person && party.speed < STANDS && !is_on_crossing()
}

/// Whether both take a lane.
fn shares_a_lane(pair: &Pair) -> bool {
    pair.ego.course.stretches.iter().any(|stretch| pair.foe.course.of(stretch.lane).is_some())
}

/// Whether one is, or has been as far as is known, on the first lane that both take, and the conflict is on that lane or
/// behind it: they do not come together at its beginning.
fn follow_each_other(pair: &Pair) -> bool {
    let [ego, foe] = [&pair.ego, &pair.foe].map(|party| &party.course.stretches);
    let Some(first) = ego.iter().position(|stretch| pair.foe.course.of(stretch.lane).is_some()) else { return false };
    let of_foe = foe.iter().position(|stretch| stretch.lane == ego[first].lane);
    (first == 0 || of_foe == Some(0)) && pair.ego.to_meeting >= ego[first].begin - AT_THE_JOINT
}

/// Two that drive on one lane or beside each other.
fn in_one_direction(pair: &Pair) -> Manoeuvre {
    let [ego, foe] = pair.both().map(|(one, other)| changed_into(pair, one, other));
    // Of two that changed lanes, the later one came into the other's way.
    match () {
        () if foe > ego => Manoeuvre::CutIn,
        () if ego.is_some() => Manoeuvre::LaneChange,
        () if !shares_a_lane(pair) => Manoeuvre::SideBySide,
        () => Manoeuvre::Following,
    }
}

/// Whether one of the two changes lanes, or has just done so.
pub(super) fn changes_lanes(net: &Net, pair: &Pair) -> bool {
    pair.both().into_iter().any(|(party, _)| {
        let recent = party.course.change.is_some_and(|change| pair.time - change.time <= LANE_CHANGE);
        recent
            || (party.course.lateral_speed.abs() > DRIFT
                && !party.course.at(0.0).is_some_and(|lane| net.is_internal(lane)))
    })
}

/// Since when one is in the lane of the other to which it changed, or changes now; none where it came otherwise, or long ago.
pub(super) fn changed_into(pair: &Pair, one: &Party, other: &Party) -> Option<Second> {
    let course = &one.course;
    // The other may have left the lane since, ahead of it.
    let is_into = |lane| other.course.of(lane).is_some() || follow_each_other(pair);
    // One that was not there yet saw no change.
    let was_there = |time| pair.past.of(other.user, pair.time).next().is_some_and(|(first, ..)| first <= time);
    let changed = course.change.filter(|change| {
        pair.time - change.time <= LANE_CHANGE
            && !other.course.change.is_some_and(|other| other.is_with(change))
            && is_into(change.to)
            && was_there(change.time)
    });
    let drifts = || -> Option<Second> {
        let (net, own) = pair.around.net.zip(course.at(0.0))?;
        let lane = &net.lanes[own];
        let towards = if net.left_hand { -course.lateral_speed } else { course.lateral_speed };
        let next = if towards > 0.0 { lane.index.checked_add(1) } else { lane.index.checked_sub(1) }?;
        let next = net.edges[lane.edge].lanes.get(next as usize)?;
        let is_towards = other.course.of(*next).is_some() && other.course.of(own).is_none();
        (is_towards && course.lateral_speed.abs() > DRIFT).then_some(pair.time)
    };
    drifts().or(changed.map(|change| change.time))
}

/// Two whose ways meet in a junction.
fn through_a_junction(net: &Net, pair: &Pair, passages: [&Passage; 2]) -> Manoeuvre {
    let [one, other] = passages;
    let turns = passages.map(|passage| passage.direction != Direction::Straight);
    let comes_from = turn_between(net, one.from, other.from).abs();
    if one.from == other.from {
        return in_one_direction_or(pair, Manoeuvre::Following);
    }
    if edge_of(net, one.to) == edge_of(net, other.to) {
        return match (edge_of(net, one.from) == edge_of(net, other.from), turns) {
            (true, _) if one.to != other.to => in_one_direction(pair),
            (true, _) => Manoeuvre::Merge,
            (false, [false, false]) => Manoeuvre::Merge,
            _ => Manoeuvre::TurnInto,
        };
    }
    let turned = passages.map(|passage| passage.direction).into_iter().find(|to| *to != Direction::Straight);
    let across = match turned {
        Some(Direction::Right) => Manoeuvre::RightTurnAcross,
        Some(_) => Manoeuvre::LeftTurnAcross,
        None if comes_from > OPPOSITE && pair.kind == Kind::Frontal => Manoeuvre::HeadOn,
        None => Manoeuvre::Crossing,
    };
    if comes_from > OPPOSITE {
        // Of two that turn, the one that turns across the other turns to the far side.
        let far = if net.left_hand { Direction::Right } else { Direction::Left };
        return match passages.iter().any(|passage| passage.direction == far) {
            true if net.left_hand => Manoeuvre::RightTurnAcross,
            true => Manoeuvre::LeftTurnAcross,
            false => across,
        };
    }
    if comes_from < ALIKE { in_one_direction_or(pair, across) } else { Manoeuvre::Crossing }
}

/// A change of lanes where one is under way, or else this; side by side until one turns.
fn in_one_direction_or(pair: &Pair, otherwise: Manoeuvre) -> Manoeuvre {
    match in_one_direction(pair) {
        Manoeuvre::CutIn => Manoeuvre::CutIn,
        _ => otherwise,
    }
}
