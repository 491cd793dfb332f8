//! A net once all of its elements are read: connections become links between lanes, and ways through the junctions.

use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::smallvec;
use typed_index_collections::TiVec;

use super::reader::{Connection, NetReader};
use crate::{Error, Result};
use closecall::geometry::Bounds;
use closecall::traffic::net::elements::{Direction, EdgeFunction, LaneIndex, Link, Passage};
use closecall::traffic::net::finder::Finder;
use closecall::traffic::net::network::{NO_PASSAGE, Net};

impl NetReader<'_> {
    /// The net of what was read.
    pub(super) fn finish(mut self) -> Result<Net> {
        if self.net.lanes.is_empty() {
            return Err(Error::content(self.path, "the net has no lanes"));
        }
        let mut passages = Vec::new();
        for connection in std::mem::take(&mut self.connections) {
            self.line = connection.line;
            let from = self.end_of(&connection.from)?;
            let to = self.end_of(&connection.to)?;
            let via = match &connection.via {
                Some(id) => Some(self.net.lane(id).ok_or_else(|| self.wrong(format!("no lane \"{id}\"")))?),
                None => None,
            };
            self.net.lanes[from].links.push(Link { to, via });
            let Connection { direction, signal, .. } = connection;
            let is_crossing = self.net.function(to) == EdgeFunction::Crossing && signal.is_some();
            if self.net.function(from) == EdgeFunction::Normal || is_crossing {
                let (from, lane) = if is_crossing { (to, Some(to)) } else { (from, via) };
                let passage =
                    |lane| Passage { junction: 0, link: 0, from, to, direction, signal, lanes: smallvec![lane] };
                passages.extend(lane.map(passage));
            }
            let from_lanes = &mut self.net.lanes[via.unwrap_or(to)].from;
            if !from_lanes.contains(&from) {
                from_lanes.push(from);
            }
        }
        self.net.junction_bounds = vec![Bounds::EMPTY; self.junctions.len()].into();
        for junction in &self.net.junctions {
            if let Some(index) = self.junctions.get(&junction.id) {
                let bounds = &mut self.net.junction_bounds[*index];
                junction.shape.iter().for_each(|point| bounds.include(*point));
            }
        }
        for (junction, ids) in self.net.junctions.iter_mut().zip(&self.link_lanes) {
            if !junction.foes.is_empty() {
                junction.link_lanes =
                    ids.split_ascii_whitespace().map(|id| self.net.lane_ids.get(id).copied()).collect();
            }
        }
        self.add_passages(passages);
        self.net.lines.shrink();
        self.net.finder = Finder::new(&self.net.lanes);
        Ok(self.net)
    }

    /// Adds the ways through the junctions: those of the connections, of which the first lane and no junction is known yet,
    /// and the crossings without a signal, which no connection tells.
    fn add_passages(&mut self, mut passages: Vec<Passage>) {
        let net = &mut self.net;
        let mut links = FxHashMap::default();
        for (junction, number) in net.junctions.iter().zip(0..) {
            for (lane, link) in junction.link_lanes.iter().zip(0..) {
                links.extend(lane.map(|lane| (lane, (number, link))));
            }
        }
        let mut of = TiVec::from(vec![NO_PASSAGE; net.lanes.len()]);
        let signalled = passages.iter().map(|passage| passage.lanes[0]).collect::<FxHashSet<_>>();
        let is_crossing = |lane: &&LaneIndex| net.function(**lane) == EdgeFunction::Crossing;
        let unsignalled = links.keys().filter(is_crossing).filter(|lane| !signalled.contains(lane));
        let mut unsignalled = unsignalled.copied().collect::<Vec<_>>();
        unsignalled.sort_unstable();
        passages.extend(unsignalled.into_iter().map(|lane| Passage {
            junction: 0,
            link: 0,
            from: lane,
            to: lane,
            direction: Direction::Straight,
            signal: None,
            lanes: smallvec![lane],
        }));
        for mut passage in passages {
            // A link has two junction lanes at most.
            let last = passage.lanes[0];
            let next = net.lanes[last].links.first().and_then(|link| link.via);
            passage.lanes.extend(next.filter(|_| net.function(last) == EdgeFunction::Internal));
            let Some((junction, link)) = passage.lanes.last().and_then(|lane| links.get(lane)) else { continue };
            (passage.junction, passage.link) = (*junction, *link);
            for lane in &passage.lanes {
                of[*lane] = net.passages.len() as u32;
            }
            net.passages.push(passage);
        }
        net.passage_of = of;
    }

    fn end_of(&self, (edge, lane): &(String, u32)) -> Result<LaneIndex> {
        let lanes = self.net.edge(edge).map(|edge| &self.net.edges[edge].lanes);
        lanes
            .and_then(|lanes| lanes.get(*lane as usize))
            .copied()
            .ok_or_else(|| self.wrong(format!("connection to lane {lane} of edge \"{edge}\", which does not exist")))
    }
}
