//! Whether one of a pair will wait: it has to, and can still stop where SUMO lets it wait as drivers usually do. Until then
//! its speed tells nothing of where it will be.

use super::evidence::is_open;
use super::pair::{Pair, Party, edge_of};
use crate::traffic::net::{Net, Passage};
use crate::util::units::MetrePerSecondSquared;

/// A waiting driver brakes by up to this, in m/s²: SUMO's default of cars, and a little that steps add.
const ORDINARY: MetrePerSecondSquared = 5.0;

/// Whether one of the two will wait for the other. On the same edge neither does: the one follows the other.
pub(in crate::events) fn one_will_wait(pair: &Pair) -> bool {
    let (Some(net), Some([ego, foe])) = (pair.around.net, pair.passages) else { return false };
    let edges = [&pair.ego, &pair.foe].map(|party| party.course.at(0.0).map(|lane| edge_of(net, lane)));
    if edges[0].is_some() && edges[0] == edges[1] {
        return false;
    }
    will_wait(net, pair, (&pair.ego, ego), foe) || will_wait(net, pair, (&pair.foe, foe), ego)
}

/// Whether a vehicle will wait for one on another way: at its light, or where it has to yield, within the junction if there is
/// a place for that.
fn will_wait(net: &Net, pair: &Pair, (party, passage): (&Party, &Passage), other: &Passage) -> bool {
    let can_stop = |distance: Option<f64>| {
        distance.is_some_and(|distance| distance > 0.0 && party.speed * party.speed <= 2.0 * ORDINARY * distance)
    };
    let to_enter = party.distance_to(passage.lanes[0]);
    let to_go_on = passage.lanes.last().and_then(|lane| party.distance_to(*lane));
    let is_stopped = || !is_open(pair, passage, pair.time) && passage.signal.is_some();
    party.is_vehicle()
        && ((net.yields(passage, other) && can_stop(to_go_on.or(to_enter))) || (can_stop(to_enter) && is_stopped()))
}
