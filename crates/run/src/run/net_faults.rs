//! The faults of the net: at which lanes road users overlap because SUMO's drivers do not know how lanes are drawn.

use std::collections::BTreeMap;

use ecow::EcoString;
use rustc_hash::FxHashSet;

use super::touching_lanes::touching_lanes;
use crate::output::net_faults_csv::{FaultKind, NetFault, sort};
use closecall::events::{Artefact, Conflict, STANDS};
use closecall::traffic::net::{EdgeFunction, LaneIndex, Net};
use closecall::traffic::roster::Roster;
use closecall::util::units::Metre;

/// A shallower overlap may be due to shapes that are rounded to a centimetre, in m.
const SHALLOWEST: Metre = 0.02;

/// The pairs of lanes, in the order of their indices, each with what happened there.
#[derive(Default)]
pub(super) struct NetFaults {
    pairs: BTreeMap<[LaneIndex; 2], Overlaps>,
}

/// What happened at a pair of lanes.
#[derive(Default)]
struct Overlaps {
    conflicts: u64,
    /// A single standing road user, or two that passed each other.
    times: FxHashSet<[EcoString; 2]>,
    road_users: FxHashSet<EcoString>,
    overlap: Metre,
    /// The number of the conflict with the deepest overlap, and where it is.
    deepest: (u64, [Metre; 2]),
}

impl NetFaults {
    /// Counts closed conflicts, the first of which has this number in the log.
    pub fn take(&mut self, closed: &[Conflict], first: u64, net: Option<&Net>, roster: &Roster) {
        let Some(net) = net else { return };
        (first..).zip(closed).for_each(|(number, conflict)| self.count(conflict, number, net, roster));
    }

    /// Counts a conflict if the two overlap only as drawn.
    fn count(&mut self, conflict: &Conflict, number: u64, net: &Net, roster: &Roster) {
        let is_fault = conflict.artefact == Some(Artefact::DrawnOverlap) && conflict.overlap >= SHALLOWEST;
        let Some(mut lanes) = Some(conflict).filter(|_| is_fault).and_then(|of| touching_lanes(net, of, roster)) else {
            return;
        };
        lanes.sort_unstable();
        let known = self.pairs.entry(lanes).or_default();
        known.conflicts += 1;
        let Conflict { ego, foe, ego_speed, foe_speed, overlap, x, y, .. } = conflict;
        // Of two that stand it is the foe: the ego came to it.
        let stands = [(foe, foe_speed), (ego, ego_speed)].into_iter().find(|(_, speed)| **speed < STANDS);
        let both = || [ego.min(foe).clone(), ego.max(foe).clone()];
        known.times.insert(stands.map_or_else(both, |(id, _)| [id.clone(), EcoString::new()]));
        known.road_users.extend([ego.clone(), foe.clone()]);
        if *overlap > known.overlap {
            (known.overlap, known.deepest) = (*overlap, (number, [*x, *y]));
        }
    }

    /// The faults, the worst first.
    pub fn found(&self, net: &Net) -> Vec<NetFault> {
        let mut faults = self.pairs.iter().map(|(lanes, overlaps)| fault(net, *lanes, overlaps)).collect::<Vec<_>>();
        sort(&mut faults);
        faults
    }

    /// The number of distinct road users that overlap anywhere.
    pub fn road_users(&self) -> usize {
        self.pairs.values().flat_map(|overlaps| &overlaps.road_users).collect::<FxHashSet<_>>().len()
    }
}

fn fault(net: &Net, lanes: [LaneIndex; 2], overlaps: &Overlaps) -> NetFault {
    let [lane, other_lane] = lanes.map(|lane| net.lane_id(lane).to_owned());
    let within = lanes.into_iter().find(|lane| net.function(*lane) != EdgeFunction::Normal);
    let junction = within.map(|lane| net.edges[net.lanes[lane].edge].junction.clone());
    let kind = kind(net, lanes);
    let (deepest, [x, y]) = overlaps.deepest;
    NetFault {
        lane,
        other_lane,
        junction: junction.unwrap_or_default(),
        fault: kind,
        times: overlaps.times.len() as u64,
        conflicts: overlaps.conflicts,
        road_users: overlaps.road_users.len() as u64,
        overlap: to_centimetres(overlaps.overlap),
        deepest,
        x: to_centimetres(x),
        y: to_centimetres(y),
        remedy: kind.remedy().to_owned(),
    }
}

/// Why SUMO lets road users on two lanes overlap.
fn kind(net: &Net, [one, other]: [LaneIndex; 2]) -> FaultKind {
    let both = || [one, other].into_iter();
    let edge = |lane: LaneIndex| net.lanes[lane].edge;
    let junction = |lane: LaneIndex| net.passage(lane).map(|passage| passage.junction);
    match () {
        () if both().any(|lane| !net.lanes[lane].has_vehicles) => FaultKind::OnFoot,
        () if net.relates(one, other) => FaultKind::WaitsInside,
        () if edge(one) == edge(other) || net.have_room(one, other) => FaultKind::NarrowLane,
        () if junction(one).is_some() && junction(one) == junction(other) => FaultKind::NotFoes,
        () if net.cross_as_drawn(one, other) => FaultKind::NoJunction,
        () => FaultKind::TooNear,
    }
}

fn to_centimetres(value: Metre) -> Metre {
    (value * 100.0).round() / 100.0
}
