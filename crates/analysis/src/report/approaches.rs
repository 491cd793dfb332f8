//! The approaches of junctions: in which direction from its middle each road and crossing lies. Without a net only the names of
//! edges are known.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use serde_json::{Value, json};

use closecall::geometry::{Bounds, Point};
use closecall::traffic::net::{EdgeFunction, EdgeIndex, JunctionIndex, Net};
use closecall::util::units::{Metre, Radian};

/// An approach lies where it is this far from the junction, in m: close to it, lanes of one road lie far apart.
const AWAY: Metre = 40.0;

/// What an approach is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    In,
    Out,
    OnFoot,
}

/// A place at the edge of a junction.
#[derive(Clone, Debug)]
struct Approach {
    /// Its edge.
    name: String,
    /// Its direction from the junction's middle, counter-clockwise from +x; none without a net.
    angle: Option<Radian>,
    role: Role,
}

/// The approaches of the junctions that have conflicts.
pub(super) struct Approaches<'a> {
    net: Option<&'a Net>,
    /// The edges of vehicles that begin or end at each junction.
    edges: FxHashMap<JunctionIndex, Vec<(EdgeIndex, Role)>>,
    of_junction: BTreeMap<String, Vec<Approach>>,
}

impl<'a> Approaches<'a> {
    /// Those in a net, none yet.
    pub fn of(net: Option<&'a Net>) -> Self {
        let mut edges = FxHashMap::<_, Vec<_>>::default();
        for (index, edge) in net.iter().flat_map(|net| net.edges.iter_enumerated()) {
            let is_road = |net: &Net| edge.lanes.iter().any(|lane| net.lanes[*lane].has_vehicles);
            if edge.function == EdgeFunction::Normal && net.is_some_and(is_road) {
                edges.entry(edge.ends[0]).or_default().push((index, Role::Out));
                edges.entry(edge.ends[1]).or_default().push((index, Role::In));
            }
        }
        Self { net, edges, of_junction: BTreeMap::new() }
    }

    /// For each junction its approaches.
    pub fn json(&self) -> Value {
        let approach = |Approach { name, angle, role }: &Approach| {
            let street = self.net.and_then(|net| Some(&net.edges[*net.edge_ids.get(name)?].street));
            let name = street.map(|street| street.as_str()).filter(|street| !street.is_empty()).unwrap_or(name);
            json!([name, angle.map(|angle| (angle * 100.0).round() / 100.0), *role as u8])
        };
        let of_junction = |(name, all): (&String, &Vec<Approach>)| {
            (format!("junction {name}"), all.iter().map(approach).collect::<Value>())
        };
        self.of_junction.iter().map(of_junction).collect()
    }

    /// Adds the roads at a junction, once.
    pub fn add_roads(&mut self, net: &Net, junction: &str, at: JunctionIndex) {
        if self.of_junction.contains_key(junction) {
            return;
        }
        let one = |&(edge, role): &(EdgeIndex, Role)| Approach {
            name: net.edges[edge].id.clone(),
            angle: Some(self.angle(net, at, point_of(net, edge, role, AWAY))),
            role,
        };
        let all = self.edges.get(&at).into_iter().flatten().map(one).collect();
        self.of_junction.insert(junction.to_owned(), all);
    }

    /// The place of an approach among those of its junction.
    pub fn known(&self, junction: &str, name: &str, role: Role) -> Option<usize> {
        self.of_junction.get(junction)?.iter().position(|known| known.name == name && known.role == role)
    }

    /// The place of an approach, which is added where it is new.
    pub fn place(&mut self, junction: &str, name: &str, role: Role, angle: Option<Radian>) -> usize {
        self.known(junction, name, role).unwrap_or_else(|| {
            let all = self.of_junction.entry(junction.to_owned()).or_default();
            all.push(Approach { name: name.to_owned(), angle, role });
            all.len() - 1
        })
    }

    /// The direction of a place from the middle of a junction: of the box around the ends of its roads.
    pub fn angle(&self, net: &Net, at: JunctionIndex, place: Point) -> Radian {
        let roads = self.edges.get(&at).into_iter().flatten();
        let ends = roads.map(|(edge, role)| point_of(net, *edge, *role, 0.0)).collect::<Vec<_>>();
        let displacement = place - middle_of(&ends);
        displacement.y.atan2(displacement.x)
    }
}

/// Where an edge is that far from the junction, on its middle lane.
fn point_of(net: &Net, edge: EdgeIndex, role: Role, away: Metre) -> Point {
    let lanes = &net.edges[edge].lanes;
    let mut shape = net.lanes[lanes[lanes.len() / 2]].shape.clone();
    if role == Role::In {
        shape.reverse();
    }
    let mut left = away;
    for ends in shape.windows(2) {
        let displacement = ends[1] - ends[0];
        let length = displacement.norm();
        if length > left {
            return ends[0] + displacement * (left / length);
        }
        left -= length;
    }
    shape[shape.len() - 1]
}

/// The middle of the box around points.
pub(super) fn middle_of(shape: &[Point]) -> Point {
    let mut bounds = Bounds::EMPTY;
    shape.iter().for_each(|point| bounds.include(*point));
    Point::from((bounds.low.coords + bounds.high.coords) / 2.0)
}
