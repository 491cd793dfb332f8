//! How many vehicles enter each junction, to relate its conflicts to.

use std::collections::BTreeMap;

use closecall::traffic::net::{EdgeFunction, JunctionIndex, LaneIndex, Net};
use closecall::traffic::roster::UserIndex;
use closecall::util::index::row_of;
use typed_index_collections::TiVec;

/// The vehicles that entered each junction so far.
#[derive(Debug, Default)]
pub(super) struct Entering {
    /// The lane that each road user was last seen on, by [`UserIndex`].
    lanes: TiVec<UserIndex, Option<LaneIndex>>,
    /// By [`JunctionIndex`].
    counts: TiVec<JunctionIndex, u64>,
}

impl Entering {
    /// Sees a vehicle on a lane.
    pub fn see(&mut self, net: &Net, user: UserIndex, lane: LaneIndex) {
        let known = row_of(&mut self.lanes, user, || None);
        if *known == Some(lane) {
            return;
        }
        let before = known.replace(lane);
        if let Some(junction) = entered(net, before, lane) {
            *row_of(&mut self.counts, junction, || 0) += 1;
        }
    }

    /// A road user leaves the scene.
    pub(crate) fn forget(&mut self, user: UserIndex) {
        if let Some(lane) = self.lanes.get_mut(user) {
            *lane = None;
        }
    }

    /// The counts by SUMO's id of the junction, of those with lanes of their own.
    pub(crate) fn by_junction(&self, net: &Net) -> BTreeMap<String, u64> {
        let within = net.edges.iter().filter(|edge| edge.function == EdgeFunction::Internal);
        let count = |junction: JunctionIndex| self.counts.get(junction).copied().filter(|count| *count > 0);
        within.filter_map(|edge| Some((edge.junction.to_string(), count(edge.ends[0])?))).collect()
    }
}

/// The junction that a vehicle has entered, or driven through, since it was on another lane; none if it is where it was.
fn entered(net: &Net, before: Option<LaneIndex>, now: LaneIndex) -> Option<JunctionIndex> {
    let edge_of = |lane: LaneIndex| net.lanes[lane].edge;
    let edge = &net.edges[edge_of(now)];
    let is_new = match before.map(edge_of) {
        None => edge.function == EdgeFunction::Internal,
        Some(from) => {
            let before = &net.edges[from];
            let was_there = before.function == EdgeFunction::Internal && before.ends[0] == edge.ends[0];
            from != edge_of(now) && !was_there
        }
    };
    is_new.then_some(edge.ends[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_enters_each_junction_once() {
        let net = crate::net::read(std::path::Path::new(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../sumo_nets/priority/priority.net.xml"
        )))
        .unwrap();
        let passage = net.lanes.keys().filter_map(|lane| net.passage(lane));
        let passage = passage.max_by_key(|passage| passage.lanes.len()).unwrap();
        let through = [&[passage.from][..], &passage.lanes, &[passage.to]].concat();
        let total = |seen: &[&[LaneIndex]]| {
            let mut entering = Entering::default();
            for (user, lanes) in (0..).zip(seen) {
                lanes.iter().for_each(|lane| entering.see(&net, UserIndex(user), *lane));
            }
            entering.by_junction(&net).values().sum::<u64>()
        };
        assert!(passage.lanes.len() > 1, "two parts");
        assert_eq!(total(&[&through]), 1);
        assert_eq!(total(&[&[passage.from, passage.to]]), 1, "through it between two steps");
        assert_eq!(total(&[&[passage.from], &[passage.to]]), 0, "two vehicles that stay");
        assert_eq!(total(&[&through, &through]), 2);
    }
}
