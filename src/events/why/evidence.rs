//! The evidence for each cause: the net, what the traffic lights showed, and how the two moved. docs/causes.md has the rules.

use super::cause::{Cause, Causes};
use super::manoeuvre::{Manoeuvre, changed_into};
use super::pair::{BESIDE_A_CROSSING, Pair, Party, STANDS};
use super::sight::is_behind_curve;
use crate::detection::kind::Kind;
use crate::traffic::net::{Net, Passage};
use crate::traffic::profile::Category;
use crate::util::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Second};

/// A driver who sees amber and can stop with [`COMFORTABLE`] after this, has to, in s (ITE's change interval).
const SEES_AMBER: Second = 1.0;
/// Crossing behind another after less than this is not letting it go first, in s; our choice.
const LETS_GO_FIRST: Second = 0.5;
/// The deceleration for which a change interval is made, in m/s²: 10 ft/s² (ITE).
const COMFORTABLE: MetrePerSecondSquared = 3.05;
/// One is too fast from this share of the limit on …
const TOO_FAST: f64 = 1.1;
/// … and this, in m/s: 10 % and 2 mph, from which on the police in England acts (NPCC 2015).
const TOO_FAST_BY: MetrePerSecond = 0.894;
/// A headway below this is too short, in s: half of half the speedometer's reading in metres, fined in Germany (BKatV no. 12).
const SHORTEST_HEADWAY: Second = 0.9;
/// Closing in faster than this is approaching, not following, in m/s.
const APPROACHES: MetrePerSecond = 2.0;
/// Slower than this, distances are those of a queue, in m/s.
const QUEUE: MetrePerSecond = 3.0;
/// A leader brakes hard from this on, in m/s²: 0.45 g (Simons-Morton et al. 2012, doi:10.1093/aje/kwr440).
const HARD: MetrePerSecondSquared = 4.41;

/// The causes of a pair in a step that does this.
pub(super) fn causes_of(pair: &Pair, manoeuvre: Option<Manoeuvre>) -> Causes {
    let mut causes = Causes::default();
    let is_following = matches!(manoeuvre, None | Some(Manoeuvre::Following)) && pair.kind == Kind::RearEnd;
    if let (Some(net), Some([ego, foe]), false) = (pair.around.net, pair.passages, is_following) {
        let [ego, foe] = [(&pair.ego, ego), (&pair.foe, foe)];
        for (party, passage) in [ego, foe] {
            causes.add_if(Cause::RanRed, entered_on(pair, party, passage, is_red));
            causes.add_if(Cause::LateAmber, entered_on(pair, party, passage, is_late_amber));
        }
        let ran = causes.has(Cause::RanRed);
        causes.add_if(
            Cause::DidNotYield,
            !ran && [(ego, foe), (foe, ego)].into_iter().any(|parties| did_not_yield(net, pair, parties)),
        );
    }
    causes.add_if(Cause::ChangedLane, pair.both().iter().any(|(a, b)| changed_into(pair, a, b).is_some()));
    causes.add_if(Cause::Overtook, manoeuvre == Some(Manoeuvre::OvertakingOncoming));
    causes.add_if(Cause::OutsideCrossing, manoeuvre == Some(Manoeuvre::PersonCrossing) && is_outside_crossing(pair));
    causes.add_if(Cause::Stood, manoeuvre == Some(Manoeuvre::Object));
    causes.add_if(Cause::BehindCurve, comes_to_queue(pair, manoeuvre) && is_behind_curve(pair));
    if pair.kind == Kind::RearEnd && pair.ego.is_vehicle() && pair.foe.is_vehicle() {
        let Pair { ego, foe, gap, .. } = pair;
        let keeps_pace = ego.speed > QUEUE && ego.speed - foe.speed < APPROACHES;
        causes.add_if(Cause::LeaderBraked, foe.course.deceleration >= HARD);
        causes.add_if(Cause::TooClose, is_following && keeps_pace && gap / ego.speed < SHORTEST_HEADWAY);
    }
    let fast = pair.both().into_iter().take(if pair.kind == Kind::RearEnd { 1 } else { 2 });
    causes.add_if(Cause::TooFast, fast.into_iter().any(|(party, _)| is_too_fast(pair, party)));
    let is_new = |party: &Party| party.category != Category::Obstacle && pair.past.is_new(party.user, pair.time);
    causes.add_if(Cause::Appeared, pair.both().iter().any(|(party, _)| is_new(party)));
    causes.plausible_for(manoeuvre)
}

/// Whether the ego approaches the end of a queue; in a tight curve that is a side conflict, too.
fn comes_to_queue(pair: &Pair, manoeuvre: Option<Manoeuvre>) -> bool {
    let Pair { ego, foe, .. } = pair;
    manoeuvre == Some(Manoeuvre::Following)
        && foe.speed < QUEUE
        && ego.speed - foe.speed >= APPROACHES
        && !pair.past.is_new(foe.user, pair.time)
}

/// A road user and its way through the junction.
type Entrant<'a> = (&'a Party, &'a Passage);

/// What a traffic light shows a passing vehicle: the letter, since how long, and the vehicle's speed.
struct Shown {
    letter: u8,
    lasts: Second,
    speed: MetrePerSecond,
}

fn is_red(shown: &Shown) -> bool {
    // Red with amber is red.
    matches!(shown.letter, b'r' | b'u')
}

fn is_late_amber(shown: &Shown) -> bool {
    matches!(shown.letter, b'y' | b'Y') && shown.lasts > SEES_AMBER + shown.speed / (2.0 * COMFORTABLE)
}

/// Whether a traffic light showed this in the step in which a road user came onto the junction, or its crossing: only what it
/// did tells, as one that cannot stop by its brakes may still do so in SUMO.
fn entered_on(pair: &Pair, party: &Party, passage: &Passage, is_wrong: fn(&Shown) -> bool) -> bool {
    let is_shown = |signal, time: Second| {
        let shown = pair.around.signals.at(signal, time);
        shown.is_some_and(|(letter, since)| is_wrong(&Shown { letter, lasts: time - since, speed: party.speed }))
    };
    let has_entered = || match party.category {
        Category::Person => party.speed >= STANDS && is_on_a_crossing(pair, party),
        _ => party.distance_to(passage.lanes[0]).is_some_and(|distance| distance < 0.0),
    };
    let Some(signal) = passage.signal.filter(|_| has_entered()) else { return false };
    // Within a step it is not known whether the light or the road user came first.
    let time = entered(pair, party, passage);
    time.is_some_and(|time| is_shown(signal, time) && is_shown(signal, (time + pair.around.step).min(pair.time)))
}

/// When a road user entered its way through a junction, now if it has not yet; none where that is longer ago than is known.
fn entered(pair: &Pair, party: &Party, passage: &Passage) -> Option<Second> {
    match party.category {
        Category::Person if is_on_a_crossing(pair, party) => entered_crossing(pair, party),
        Category::Person => Some(pair.time),
        _ => party.distance_to(passage.lanes[0]).and_then(|distance| match distance {
            ..0.0 => passed_before(pair, party, -distance),
            _ => Some(pair.time),
        }),
    }
}

fn is_on_a_crossing(pair: &Pair, party: &Party) -> bool {
    pair.around.net.is_some_and(|net| party.is_on_crossing(net))
}

/// When a vehicle was this far behind where it is now; none where that is longer ago than is known.
fn passed_before(pair: &Pair, party: &Party, driven: Metre) -> Option<Second> {
    let mut places = pair.past.of(party.user, pair.time).map(|(time, front, _)| (time, front)).collect::<Vec<_>>();
    places.push((pair.time, party.front));
    let mut left = driven;
    places.windows(2).rev().find_map(|ends| {
        let [(before, from), (after, to)] = *ends else { return None };
        let distance = (to - from).norm();
        if distance >= left && distance > 0.0 {
            return Some(after - (after - before) * left / distance);
        }
        left -= distance;
        None
    })
}

/// When a person that is on a crossing now stepped on it; none where that is longer ago than is known.
fn entered_crossing(pair: &Pair, party: &Party) -> Option<Second> {
    let net = pair.around.net?;
    let places = pair.past.of(party.user, pair.time).collect::<Vec<_>>();
    let before = places.iter().rposition(|(_, place, _)| !net.is_on_crossing(*place))?;
    Some(places.get(before + 1).map_or(pair.time, |(time, ..)| *time))
}

/// Whether a road user that has to yield on its way goes on, having passed the place to wait or unable to stop there, and
/// does not let the other go first.
fn did_not_yield(net: &Net, pair: &Pair, (one, other): (Entrant, Entrant)) -> bool {
    let (party, passage) = one;
    let goes_on = || match party.category {
        Category::Person => is_on_a_crossing(pair, party),
        _ => passage
            .lanes
            .last()
            .and_then(|lane| party.distance_to(*lane))
            .is_some_and(|distance| party.passes(distance)),
    };
    // The right of way holds between the two from when both are in the junction.
    let both =
        || [one, other].into_iter().filter_map(|(party, passage)| entered(pair, party, passage)).reduce(f64::max);
    net.yields(passage, other.1)
        && goes_on()
        && !goes_second(pair, party, other.0)
        && both().is_some_and(|time| is_open(pair, passage, time) && is_open(pair, other.1, time))
}

/// Whether one passes the conflict point behind the other, and with room, as both drive now.
fn goes_second(pair: &Pair, one: &Party, other: &Party) -> bool {
    one.to_meeting * other.speed > other.to_meeting * one.speed
        && pair.found.nearness.is_none_or(|near| near.values.ttc().is_none())
        && (pair.around.tadv)(pair.found).is_none_or(|tadv| tadv >= LETS_GO_FIRST)
}

/// Whether a traffic light left the order to the right of way at a time; false where its state is not known.
pub(super) fn is_open(pair: &Pair, passage: &Passage, time: Second) -> bool {
    let Some(signal) = passage.signal else { return true };
    let shown = pair.around.signals.at(signal, time);
    shown.is_some_and(|(letter, _)| !matches!(letter, b'r' | b'u' | b'y' | b'Y'))
}

fn is_outside_crossing(pair: &Pair) -> bool {
    let moves = pair.both().iter().all(|(party, _)| party.is_vehicle() || party.speed > 0.0);
    moves
        && pair.passages.is_none()
        && pair.around.net.is_some_and(|net| net.has_crossings() && !net.is_for_persons(pair.at, BESIDE_A_CROSSING))
}

fn is_too_fast(pair: &Pair, party: &Party) -> bool {
    let Some((net, lane)) = pair.around.net.zip(party.course.at(0.0)) else { return false };
    // The limit of a lane within a junction is what SUMO takes for its curve.
    let limit = match net.passage(lane) {
        Some(passage) => [passage.from, passage.to].map(|lane| net.lanes[lane].speed).into_iter().fold(0.0, f64::max),
        None => net.lanes[lane].speed,
    };
    party.is_vehicle() && party.speed > TOO_FAST * limit + TOO_FAST_BY
}
