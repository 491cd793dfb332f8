//! Lanes and links, read from a SUMO net (`*.net.xml`, also gzipped).
//!
//! Only what paths, obstacles of the scene and places in the log need: lane shapes, what leads where, junctions.

mod finder;
mod reader;

use std::path::Path;

use nalgebra::Point2;
use rustc_hash::FxHashMap;

use crate::Result;
use crate::geometry::lines::Lines;
use crate::units::Metre;

pub(crate) use reader::{LineCounter, open};

/// SUMO's default width of a lane in m.
const LANE_WIDTH: Metre = 3.2;

/// Which lane of a [`Net`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LaneIndex(pub u32);

/// Which edge of a [`Net`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeIndex(pub u32);

/// What an edge is for (SUMO's attribute `function`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeFunction {
    /// A road between junctions.
    Normal,
    /// Lanes within a junction.
    Internal,
    /// A pedestrian crossing.
    Crossing,
    /// Where pedestrians get from one to another.
    WalkingArea,
    /// A macroscopic connector.
    Connector,
}

/// One edge.
#[derive(Clone, Debug)]
pub struct Edge {
    /// SUMO's id.
    pub id: String,
    /// What it is for.
    pub function: EdgeFunction,
    /// Its lanes, from right to left.
    pub lanes: Vec<LaneIndex>,
    /// The junction that it belongs to (internal edges, crossings, walking areas) or leads to.
    pub junction: String,
}

/// Where a lane leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// The lane of the next normal edge that is reached in the end.
    pub to: LaneIndex,
    /// The first junction lane on the way there; none where lanes join directly.
    pub via: Option<LaneIndex>,
}

/// One lane.
#[derive(Clone, Debug)]
pub struct Lane {
    /// SUMO's id.
    pub id: String,
    /// Its edge.
    pub edge: EdgeIndex,
    /// Its place on the edge, 0 at the right.
    pub index: u32,
    /// Length in SUMO's terms, in m; a lane position is measured in these.
    pub length: Metre,
    /// Width in m.
    pub width: Metre,
    /// The centre line, two points at least.
    pub shape: Vec<Point2<Metre>>,
    /// Where it leads. A junction lane in two parts leads to its second part (`via`), then to the edge.
    pub links: Vec<Link>,
    /// The lanes from which one gets here directly (for a lane behind a junction: the junction lanes).
    pub from: Vec<LaneIndex>,
}

/// One junction.
#[derive(Clone, Debug)]
pub struct Junction {
    /// SUMO's id.
    pub id: String,
    /// Its outline.
    pub shape: Vec<Point2<Metre>>,
}

/// A road network.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// All lanes, by [`LaneIndex`].
    pub lanes: Vec<Lane>,
    /// All edges, by [`EdgeIndex`].
    pub edges: Vec<Edge>,
    /// All junctions.
    pub junctions: Vec<Junction>,
    /// The lanes' centre lines, by lane.
    pub lines: Lines,
    lane_ids: FxHashMap<String, LaneIndex>,
    edge_ids: FxHashMap<String, EdgeIndex>,
    finder: finder::Finder,
}

impl Net {
    /// The lane of this id.
    pub fn lane(&self, id: &str) -> Option<LaneIndex> {
        self.lane_ids.get(id).copied()
    }

    /// The edge of this id.
    pub fn edge(&self, id: &str) -> Option<EdgeIndex> {
        self.edge_ids.get(id).copied()
    }

    /// The lane whose centre line is nearest to a place; none where that is far off.
    pub fn lane_at(&self, place: Point2<Metre>) -> Option<LaneIndex> {
        self.finder.lane_at(&self.lanes, place)
    }

    /// The id of a lane.
    pub fn lane_id(&self, lane: LaneIndex) -> &str {
        &self.lanes[lane.0 as usize].id
    }

    /// Reads a net file.
    ///
    /// # Errors
    /// An error that names the file, line and what is wrong: unreadable, no SUMO net, a lane without geometry, a
    /// connection to nowhere.
    pub fn read(path: &Path) -> Result<Self> {
        reader::read(path, reader::open(path)?)
    }

    /// The net in a text; `path` is what errors call it.
    ///
    /// # Errors
    /// As [`Net::read`] has them.
    pub fn parse(path: &Path, text: impl Into<Vec<u8>>) -> Result<Self> {
        reader::read(path, Box::new(std::io::Cursor::new(text.into())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn net(text: &str) -> Result<Net> {
        Net::parse(Path::new("corner.net.xml"), text)
    }

    const CORNER: &str = r#"<net>
        <edge id=":b_0" function="internal"><lane id=":b_0_0" length="5" shape="100,0 102,2 102,5"/></edge>
        <edge id="ab" from="a" to="b"><lane id="ab_0" length="100" shape="0,0 100,0"/></edge>
        <edge id="bc" from="b" to="c"><lane id="bc_0" length="50" shape="102,5 102,5 102,55" width="2.5"/></edge>
        <junction id="b" x="100" y="0" shape="100,0 102,2 102,5"/>
        <connection from="ab" to="bc" fromLane="0" toLane="0" via=":b_0_0" dir="l" state="M"/>
        <connection from=":b_0" to="bc" fromLane="0" toLane="0" dir="l" state="M"/>
    </net>"#;

    #[test]
    fn lanes_know_what_leads_where_through_the_junction() {
        let net = net(CORNER).unwrap();
        let (ab, via, bc) = (net.lane("ab_0").unwrap(), net.lane(":b_0_0").unwrap(), net.lane("bc_0").unwrap());
        assert_eq!(net.lanes[ab.0 as usize].links, [Link { to: bc, via: Some(via) }]);
        assert_eq!(net.lanes[via.0 as usize].links, [Link { to: bc, via: None }]);
        assert_eq!(net.lanes[bc.0 as usize].from, [via]);
        assert_eq!(net.edges[net.edge(":b_0").unwrap().0 as usize].junction, "b");
    }

    #[test]
    fn a_place_is_on_the_nearest_lane() {
        let net = net(CORNER).unwrap();
        assert_eq!(net.lane_at(Point2::new(40.0, 1.0)), net.lane("ab_0"));
        assert_eq!(net.lane_at(Point2::new(103.0, 30.0)), net.lane("bc_0"));
        assert_eq!(net.lane_at(Point2::new(40.0, 30.0)), None);
    }

    #[test]
    fn a_repeated_point_is_dropped() {
        let net = net(CORNER).unwrap();
        let index = net.lane("bc_0").unwrap();
        let lane = &net.lanes[index.0 as usize];
        assert_eq!((lane.shape.len(), lane.width, net.lines.length(index.0)), (2, 2.5, 50.0));
    }

    #[test]
    fn an_escaped_id_is_the_one_that_sumo_says() {
        let net = net(&CORNER.replace("ab_0", "a&amp;b_0")).unwrap();
        assert!(net.lane("a&b_0").is_some());
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (from, to, said) in [
            ("0,0 100,0", "0,0", r#"line 3: lane "ab_0" has 1 shape point(s); at least two are needed"#),
            ("0,0 100,0", "0,0 nan,0", r#"line 3: "ab_0": shape point "nan,0" is out of range"#),
            ("0,0 100,0", "0,0 x", r#"line 3: "ab_0": shape point "x" is not x,y or x,y,z"#),
            (r#"via=":b_0_0""#, r#"via="gone""#, r#"line 6: no lane "gone""#),
            (r#"length="100""#, r#"length="-1""#, r#"line 3: lane "ab_0": its length must be given, 0 m or more"#),
            ("</net>", "", "the file ends before its elements do"),
            ("<net>", "<routes>", "it is no SUMO net: its root element is not <net>"),
        ] {
            let message = net(&CORNER.replace(from, to)).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
        }
    }
}
