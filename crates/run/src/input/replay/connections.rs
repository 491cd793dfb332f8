//! The edges between two edges of the net, where only one connection is the shortest.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use closecall::traffic::net::{EdgeIndex, Net};
use closecall::util::units::Metre;

/// A connection that needs a search over more edges than this is not the only one.
const MOST_EDGES: usize = 1000;
/// The net's lengths have two decimals; sums are compared in mm.
const PER_METRE: Metre = 1000.0;

/// The connections that were looked for.
#[derive(Debug, Default)]
pub(super) struct Connections {
    known: FxHashMap<(EdgeIndex, EdgeIndex), Option<Connection>>,
}

/// The edges between two edges.
#[derive(Clone, Debug)]
struct Connection {
    length: Metre,
    edges: Arc<[EdgeIndex]>,
}

impl Connections {
    /// The edges between two edges: those of the shortest connection, if no other is as short and it is not longer than
    /// this.
    pub fn between(&mut self, net: &Net, from: EdgeIndex, to: EdgeIndex, at_most: Metre) -> Option<Arc<[EdgeIndex]>> {
        let known = self.known.entry((from, to)).or_insert_with(|| shortest(net, from, to));
        known.as_ref().filter(|known| known.length <= at_most).map(|known| known.edges.clone())
    }
}

/// An edge that the search has reached.
struct Found {
    /// Length of the edges before it, in mm.
    length: u64,
    before: EdgeIndex,
    /// Whether another way to it is as short.
    is_ambiguous: bool,
}

/// Dijkstra's search over the edges.
fn shortest(net: &Net, from: EdgeIndex, to: EdgeIndex) -> Option<Connection> {
    let mut found = FxHashMap::<EdgeIndex, Found>::default();
    let mut settled = FxHashSet::default();
    let mut nearest = BinaryHeap::from([Reverse((0, from.0))]);
    let mut begun = false;
    while let Some(Reverse((length, edge))) = nearest.pop() {
        let edge = EdgeIndex(edge);
        if begun && edge == to {
            return path(&found, from, to);
        }
        if !settled.insert(edge) {
            continue;
        }
        if settled.len() > MOST_EDGES {
            return None;
        }
        let through = if begun { length + millimetres(net, edge) } else { 0 };
        begun = true;
        for next in next_edges(net, edge) {
            match found.get_mut(&next) {
                Some(known) if known.length < through => {}
                Some(known) if known.length == through => known.is_ambiguous |= known.before != edge,
                _ => {
                    found.insert(next, Found { length: through, before: edge, is_ambiguous: false });
                    nearest.push(Reverse((through, next.0)));
                }
            }
        }
        // A way round that ends where it began.
        if from == to {
            settled.remove(&from);
        }
    }
    None
}

/// The edges between, if no part of the way there is ambiguous.
fn path(found: &FxHashMap<EdgeIndex, Found>, from: EdgeIndex, to: EdgeIndex) -> Option<Connection> {
    let last = found.get(&to)?;
    let mut edges = Vec::new();
    let mut step = last;
    while !step.is_ambiguous {
        if step.before == from {
            edges.reverse();
            return Some(Connection { length: last.length as Metre / PER_METRE, edges: edges.into() });
        }
        edges.push(step.before);
        step = found.get(&step.before)?;
    }
    None
}

/// The length of an edge in m.
pub(super) fn length(net: &Net, edge: EdgeIndex) -> Metre {
    net.edges[edge].lanes.first().map_or(0.0, |lane| net.lanes[*lane].length)
}

fn millimetres(net: &Net, edge: EdgeIndex) -> u64 {
    (length(net, edge) * PER_METRE).round() as u64
}

/// The edges to which links lead, each once.
fn next_edges(net: &Net, edge: EdgeIndex) -> Vec<EdgeIndex> {
    let lanes = net.edges[edge].lanes.iter().map(|lane| &net.lanes[*lane]);
    let mut next = lanes.flat_map(|lane| &lane.links).map(|link| net.lanes[link.to].edge).collect::<Vec<_>>();
    next.sort_unstable();
    next.dedup();
    next
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::input::replay::connections::*;

    /// The edges between edges of a net that has these edges with their lengths, and these connections.
    fn between(edges: &str, connections: &str, from: &str, to: &str) -> Option<Vec<String>> {
        let mut text = "<net>".to_owned();
        for edge in edges.split_whitespace() {
            let (id, length) = edge.split_once(':').unwrap();
            text += &format!(r#"<edge id="{id}"><lane id="{id}_0" length="{length}" shape="0,0 9,0"/></edge>"#);
        }
        for connection in connections.split_whitespace() {
            let (from, to) = connection.split_once('>').unwrap();
            text += &format!(r#"<connection from="{from}" to="{to}" fromLane="0" toLane="0"/>"#);
        }
        let net = crate::net::parse(Path::new("net"), text + "</net>").unwrap();
        let [from, to] = [from, to].map(|id| net.edge(id).unwrap());
        let found = Connections::default().between(&net, from, to, 100.0)?;
        Some(found.iter().map(|edge| net.edges[*edge].id.clone()).collect())
    }

    #[test]
    fn the_shortest_connection_is_the_one_if_no_other_is_as_short() {
        let edges = "a:500 b:10 c:20 d:5 e:500";
        let links = "a>b b>e a>c c>e c>d d>e";
        assert_eq!(between(edges, links, "a", "e").unwrap(), ["b"]);
        assert_eq!(between(&edges.replace("b:10", "b:20"), links, "a", "e"), None, "b and c are as long");
        assert_eq!(between(&edges.replace("b:10", "b:20.01"), links, "a", "e").unwrap(), ["c"]);
        assert_eq!(between(edges, "a>e a>b b>e", "a", "e").unwrap(), [""; 0], "a link");
        assert_eq!(between(edges, "a>c c>d d>e", "a", "e").unwrap(), ["c", "d"]);
        assert_eq!(between(edges, "a>b", "a", "e"), None);
        assert_eq!(
            between(&edges.replace("b:10", "b:101"), "a>b b>e", "a", "e"),
            None,
            "further than it can have driven"
        );
        assert_eq!(between(edges, "a>b b>a", "a", "a").unwrap(), ["b"], "a ring");
    }
}
