//! The movements of a conflict's road users through its junction, for the page's diagrams, and which had to yield: from the
//! lanes in the log and, where several ways lead on, from the predicted path. Without a net only the edges' names are known.

use rustc_hash::FxHashMap;
use serde_json::{Value, json};

use super::approaches::{Approaches, Role, middle_of};
use closecall::detection::path::Foot;
use closecall::geometry::Point;
use closecall::traffic::net::{Direction, EdgeFunction, EdgeIndex, JunctionIndex, LaneIndex, Net, Passage};
use closecall::util::units::Metre;
use closecall_run::output::schema::LoggedConflict;

/// A path takes the lanes that it is within this distance of, in m.
const BESIDE: Metre = 1.2;
/// A person this near to a crossing is on it, in m.
const AT_CROSSING: Metre = 1.0;
/// The distance between the places of a path that are compared with lanes, in m.
const STEP: Metre = 1.0;

/// What is known of a way through a junction: places among the junction's approaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Movement {
    from: Option<usize>,
    to: Option<usize>,
    turn: Option<&'static str>,
}

/// What is known of both movements of a conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Both {
    /// The places of the ego's and of the foe's movement in the list.
    pub movements: [usize; 2],
    /// Which of the two has to yield to the other by the junction's right of way, 0 for the ego.
    pub yields: Option<u8>,
}

/// The ways through a junction that a movement may be.
type Ways<'a> = Vec<&'a Passage>;

/// The movements of the conflicts within junctions.
pub(crate) struct Movements<'a> {
    net: Option<&'a Net>,
    approaches: Approaches<'a>,
    list: Vec<Movement>,
    places: FxHashMap<Movement, usize>,
}

impl<'a> Movements<'a> {
    /// Those in a net, none yet.
    pub fn of(net: Option<&'a Net>) -> Self {
        Self { net, approaches: Approaches::of(net), list: Vec::new(), places: FxHashMap::default() }
    }

    /// Both movements of a conflict; none outside junctions and where the log has no lanes.
    pub(crate) fn of_both(&mut self, conflict: &LoggedConflict) -> Option<Both> {
        if conflict.ego_lane.is_empty() || conflict.foe_lane.is_empty() {
            return None;
        }
        let (both, yields) = match self.net {
            Some(net) => {
                let [(ego, ego_ways), (foe, foe_ways)] = self.in_net(net, conflict)?;
                ([ego, foe], yields(net, &ego_ways, &foe_ways))
            }
            None => {
                let junction = Some(conflict.junction()).filter(|junction| !junction.is_empty())?;
                ([&conflict.ego_lane, &conflict.foe_lane].map(|lane| self.by_name(junction, lane)), None)
            }
        };
        let movements = both.map(|movement| {
            *self.places.entry(movement).or_insert_with(|| {
                self.list.push(movement);
                self.list.len() - 1
            })
        });
        Some(Both { movements, yields })
    }

    /// For each junction its approaches, and all movements.
    pub fn json(&self) -> Value {
        let movement = |Movement { from, to, turn }: &Movement| json!([from, to, turn]);
        json!({ "approaches": self.approaches.json(), "list": self.list.iter().map(movement).collect::<Vec<_>>() })
    }

    /// Without a net: the edge before the junction; of one within the junction nothing is known.
    fn by_name(&mut self, junction: &str, lane: &str) -> Movement {
        if lane.starts_with(':') {
            return Movement::default();
        }
        let name = lane.rsplit_once('_').map_or(lane, |(edge, _)| edge);
        let from = self.approaches.place(junction, name, Role::In, None);
        Movement { from: Some(from), ..Movement::default() }
    }

    fn in_net(&mut self, net: &'a Net, conflict: &LoggedConflict) -> Option<[(Movement, Ways<'a>); 2]> {
        let edge = &net.edges[net.lanes[net.lane(&conflict.lane)?].edge];
        if edge.function == EdgeFunction::Normal || edge.junction.is_empty() {
            return None;
        }
        let (junction, at) = (&*edge.junction, edge.ends[0]);
        self.approaches.add_roads(net, junction, at);
        let LoggedConflict { ego_lane, ego_x, ego_y, ego_path, foe_lane, foe_x, foe_y, foe_path, .. } = conflict;
        // The log does not tell which one is the person: it is the shorter one.
        let is_ego_shorter = conflict.ego_length < conflict.foe_length;
        let is_person = |is_shorter| is_shorter && conflict.manoeuvre.starts_with("person_");
        let ego = (ego_lane, ego_x.zip(*ego_y), ego_path, is_person(is_ego_shorter));
        let foe = (foe_lane, foe_x.zip(*foe_y), foe_path, is_person(!is_ego_shorter));
        Some([ego, foe].map(|(lane, front, path, is_person)| {
            let Some(lane) = net.lane(lane) else { return Default::default() };
            if is_person || is_on_foot(net, lane) {
                let crossing = front.and_then(|(x, y)| net.crossing_at(Point::new(x, y), AT_CROSSING));
                let movement = self.on_foot(net, junction, at, crossing.unwrap_or(lane));
                return (movement, crossing.and_then(|crossing| net.passage(crossing)).into_iter().collect());
            }
            self.of_vehicle(net, junction, at, lane, || samples(front, path))
        }))
    }

    /// The movement of a person: its crossing, or the pavement that it is on.
    fn on_foot(&mut self, net: &Net, junction: &str, at: JunctionIndex, lane: LaneIndex) -> Movement {
        let lane = &net.lanes[lane];
        let angle = self.approaches.angle(net, at, middle_of(&lane.shape));
        let place = self.approaches.place(junction, &net.edges[lane.edge].id, Role::OnFoot, Some(angle));
        Movement { from: Some(place), to: Some(place), turn: None }
    }

    fn of_vehicle(
        &self,
        net: &'a Net,
        junction: &str,
        at: JunctionIndex,
        lane: LaneIndex,
        path: impl Fn() -> Vec<Point>,
    ) -> (Movement, Ways<'a>) {
        let index = net.lanes[lane].edge;
        let edge = &net.edges[index];
        let place_of = |edge: EdgeIndex, role| self.approaches.known(junction, &net.edges[edge].id, role);
        let edge_of = |lane: LaneIndex| net.lanes[lane].edge;
        if let Some(passage) = net.passage(lane).filter(|_| edge.ends[0] == at) {
            let movement = Movement {
                from: place_of(edge_of(passage.from), Role::In),
                to: place_of(edge_of(passage.to), Role::Out),
                turn: Some(turn(passage.direction)),
            };
            return (movement, vec![passage]);
        }
        if edge.ends[1] != at || edge.function != EdgeFunction::Normal {
            let to = place_of(index, Role::Out).filter(|_| edge.ends[0] == at);
            return (Movement { to, ..Movement::default() }, Vec::new());
        }
        let from = place_of(index, Role::In);
        let vias = edge.lanes.iter().flat_map(|lane| &net.lanes[*lane].links).filter_map(|link| link.via);
        let passages = vias.filter_map(|via| net.passage(via)).collect::<Vec<_>>();
        let first = passages.first().map(|passage| edge_of(passage.to));
        let passage = if passages.iter().all(|passage| Some(edge_of(passage.to)) == first) {
            passages.first().copied()
        } else {
            let path = path();
            let count = |passage: &&Passage| {
                let is_on = |place: &&Point| passage.lanes.iter().any(|lane| is_beside(net, *lane, **place));
                path.iter().filter(is_on).count()
            };
            let counts = passages.iter().map(count).collect::<Vec<_>>();
            let best = (0..passages.len()).max_by_key(|place| counts[*place]);
            // Where two ways lead to different roads equally well, it is not known which.
            let is_sure = |best: &usize| {
                let rivals =
                    (0..passages.len()).filter(|place| edge_of(passages[*place].to) != edge_of(passages[*best].to));
                rivals.into_iter().all(|place| counts[place] < counts[*best])
            };
            best.filter(is_sure).map(|best| passages[best])
        };
        let to = passage.and_then(|passage| place_of(edge_of(passage.to), Role::Out));
        let is_alike = |other: &&Passage| passage.is_some_and(|passage| edge_of(other.to) == edge_of(passage.to));
        let alike = passages.iter().copied().filter(is_alike).collect::<Ways>();
        (Movement { from, to, turn: passage.map(|passage| turn(passage.direction)) }, alike)
    }
}

/// Which of two has to yield to the other, where that is the same on all ways that they may take.
fn yields(net: &Net, ego: &[&Passage], foe: &[&Passage]) -> Option<u8> {
    let all = |one: &[&Passage], to: &[&Passage]| {
        !one.is_empty() && !to.is_empty() && one.iter().all(|one| to.iter().all(|to| net.yields(one, to)))
    };
    if all(ego, foe) { Some(0) } else { all(foe, ego).then_some(1) }
}

/// Whether a lane is for persons only.
fn is_on_foot(net: &Net, lane: LaneIndex) -> bool {
    match net.function(lane) {
        EdgeFunction::Crossing | EdgeFunction::WalkingArea => true,
        EdgeFunction::Normal => !net.lanes[lane].has_vehicles,
        EdgeFunction::Internal | EdgeFunction::Connector => false,
    }
}

fn is_beside(net: &Net, lane: LaneIndex, place: Point) -> bool {
    (Foot::on_any_part(net.lines.line(lane.0), place).point - place).norm() <= BESIDE
}

/// Places along a path of the log, from the front bumper on.
fn samples(front: Option<(Metre, Metre)>, path: &str) -> Vec<Point> {
    let numbers = path.split(' ').filter_map(|number| number.parse::<f64>().ok()).collect::<Vec<_>>();
    let points = numbers.chunks_exact(2).map(|point| Point::new(point[0], point[1]));
    let points = front.map(|(x, y)| Point::new(x, y)).into_iter().chain(points).collect::<Vec<_>>();
    let between = points.windows(2).flat_map(|ends| {
        let displacement = ends[1] - ends[0];
        let steps = (displacement.norm() / STEP).ceil();
        (0..steps as usize).map(move |step| ends[0] + displacement * (step as f64 / steps))
    });
    between.chain(points.last().copied()).collect()
}

fn turn(direction: Direction) -> &'static str {
    match direction {
        Direction::Straight => "straight on",
        Direction::Left => "turning left",
        Direction::Right => "turning right",
        Direction::Around => "turning back",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall_run::output::sample_conflict::sample;

    /// A conflict at a lane, with the ego on one and the foe on another, about to drive along a path.
    fn conflict(lane: &str, ego_lane: &str, foe_lane: &str, foe_path: &str) -> LoggedConflict {
        sample(&[
            ("lane", lane),
            ("ego_lane", ego_lane),
            ("foe_lane", foe_lane),
            ("ego_path", ""),
            ("foe_x", ""),
            ("foe_path", foe_path),
        ])
        .unwrap()
    }

    #[test]
    fn a_path_tells_which_way_leads_on() {
        let net = closecall_run::net::read(std::path::Path::new(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../sumo_nets/town/town.net.xml"
        )))
        .unwrap();
        let mut movements = Movements::of(Some(&net));
        let mut turns = Vec::new();
        for (index, lane) in net.lanes.iter_enumerated() {
            let Some(passage) = net.passage(index) else { continue };
            if net.function(index) != EdgeFunction::Internal || passage.lanes[0] != index {
                continue;
            }
            let all = passage.lanes.iter().flat_map(|lane| &net.lanes[*lane].shape);
            let path = all.map(|point| format!("{} {}", point.x, point.y)).collect::<Vec<_>>().join(" ");
            let both = movements.of_both(&conflict(&lane.id, &lane.id, net.lane_id(passage.from), &path)).unwrap();
            let [ego, foe] = both.movements;
            assert_eq!((ego, both.yields), (foe, None), "{}", lane.id);
            let Movement { from, to, turn } = movements.list[ego];
            assert!(from.is_some() && to.is_some(), "{}", lane.id);
            turns.extend(turn);
        }
        turns.sort_unstable();
        turns.dedup();
        assert!(turns.len() > 2, "{turns:?}");
    }

    #[test]
    fn the_one_without_the_right_of_way_yields() {
        let net = closecall_run::net::read(std::path::Path::new(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../sumo_nets/priority/priority.net.xml"
        )))
        .unwrap();
        let mut movements = Movements::of(Some(&net));
        let passages = net.lanes.keys().filter_map(|lane| net.passage(lane)).collect::<Vec<_>>();
        let id = |passage: &Passage| net.lane_id(passage.lanes[0]);
        let mut found = 0;
        for (one, other) in passages.iter().flat_map(|one| passages.iter().map(move |other| (one, other))) {
            let has_to = |one, other| net.yields(one, other);
            let expected = if has_to(one, other) { Some(0) } else { has_to(other, one).then_some(1) };
            let both = movements.of_both(&conflict(id(one), id(one), id(other), "")).unwrap();
            assert_eq!(both.yields, expected, "{} {}", id(one), id(other));
            found += u32::from(expected.is_some());
        }
        assert!(found > 0);
    }

    #[test]
    fn without_a_net_an_approach_is_its_edge() {
        let mut movements = Movements::of(None);
        let both = movements.of_both(&conflict(":J_1_0", "a_b_0", ":J_1_0", "")).unwrap();
        assert_eq!(movements.json()["approaches"]["junction J"][0][0], "a_b");
        assert_eq!((movements.list[both.movements[1]], both.yields), (Movement::default(), None));
        assert_eq!(movements.of_both(&conflict("a_0", "a_0", "b_0", "")), None, "outside junctions");
    }
}
