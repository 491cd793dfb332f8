//! Reads the elements of a SUMO net: XML as netconvert writes it, plain or gzipped.

use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use super::attributes::ElementAttributes;
use super::projection::Projection;
use crate::util::input_file::{ElementSource, xml_message};
use crate::{Error, Result};
use closecall::geometry::Vector;
use closecall::geometry::polylines::stretch;
use closecall::traffic::net::elements::{
    Direction, Edge, EdgeFunction, Junction, JunctionIndex, Lane, Location, Signal, USUAL_WIDTH,
};
use closecall::traffic::net::network::Net;
use closecall::util::limits::{LANE_LENGTH, LANE_WIDTH, POSITION};

/// Reads a net file.
///
/// # Errors
/// An error that names the file and line: unreadable, not a SUMO net, a lane without geometry, a connection to a lane that
/// does not exist.
pub fn read(path: &Path) -> Result<Net> {
    read_from(path, ElementSource::open(path)?)
}

/// Reads a net from a text; `path` names it in errors.
///
/// # Errors
/// As for [`read`].
pub fn parse(path: &Path, text: impl Into<Vec<u8>>) -> Result<Net> {
    read_from(path, ElementSource::new(Box::new(std::io::Cursor::new(text.into()))))
}

/// Reads a net; `path` names it in errors.
fn read_from(path: &Path, source: ElementSource) -> Result<Net> {
    let heights = [f64::INFINITY, f64::NEG_INFINITY];
    let net = Net { heights, ..Net::default() };
    let (junctions, lights) = Default::default();
    NetReader { path, line: 1, net, connections: Vec::new(), junctions, link_lanes: Vec::new(), lights }.read(source)
}

/// Reads the elements of a net, then connects them.
pub(super) struct NetReader<'a> {
    pub path: &'a Path,
    pub line: u64,
    pub net: Net,
    pub connections: Vec<Connection>,
    /// The junctions at which edges begin or end.
    pub junctions: FxHashMap<String, JunctionIndex>,
    /// By junction, the ids of its links' lanes.
    pub link_lanes: Vec<String>,
    /// The numbers of the traffic lights, by id.
    pub lights: FxHashMap<String, u32>,
}

/// A `<connection>`, whose lanes may follow later in the file.
pub(super) struct Connection {
    pub line: u64,
    pub from: (String, u32),
    pub to: (String, u32),
    pub via: Option<String>,
    pub direction: Direction,
    pub signal: Option<Signal>,
}

impl NetReader<'_> {
    fn read(mut self, source: ElementSource) -> Result<Net> {
        let mut reader = Reader::from_reader(source);
        let mut buffer = Vec::new();
        let mut root = false;
        let mut depth = 0_usize;
        loop {
            buffer.clear();
            self.line = reader.get_mut().begin_element();
            let event = reader.read_event_into(&mut buffer).map_err(|error| self.wrong(xml_message(&error)))?;
            match event {
                Event::Start(ref tag) | Event::Empty(ref tag) => {
                    if !root && tag.name().as_ref() != "net" {
                        return Err(self.wrong("not a SUMO net: its root element is not <net>"));
                    }
                    root = true;
                    depth += usize::from(matches!(event, Event::Start(_)));
                    self.element(tag)?;
                }
                Event::End(_) => depth = depth.saturating_sub(1),
                Event::Eof => break,
                _ => {}
            }
        }
        if !root || depth > 0 {
            return Err(self.wrong("the file ends before its elements do"));
        }
        self.finish()
    }

    fn element(&mut self, tag: &BytesStart) -> Result<()> {
        let (path, line) = (self.path, self.line);
        let attributes = || ElementAttributes::of(tag, path, line);
        match tag.name().as_ref() {
            "net" => {
                self.net.left_hand = matches!(attributes()?.get("lefthand"), Some("true" | "1"));
                Ok(())
            }
            "edge" => self.edge(&attributes()?),
            "lane" => self.lane(&attributes()?),
            "junction" => self.junction(&attributes()?),
            "request" => self.request(&attributes()?),
            "connection" => self.connection(&attributes()?),
            "location" => self.location(&attributes()?),
            _ => Ok(()),
        }
    }

    fn edge(&mut self, attributes: &ElementAttributes) -> Result<()> {
        let id = attributes.required("id")?;
        let function = match attributes.get("function") {
            Some("internal") => EdgeFunction::Internal,
            Some("crossing") => EdgeFunction::Crossing,
            Some("walkingarea") => EdgeFunction::WalkingArea,
            Some("connector") => EdgeFunction::Connector,
            _ => EdgeFunction::Normal,
        };
        let within = junction_of_internal(id);
        let ends = ["from", "to"].map(|end| self.junction_index(attributes.get(end).unwrap_or(within)));
        let junction = attributes.get("to").unwrap_or(within).to_owned();
        let index = self.net.edges.next_key();
        if self.net.edge_ids.insert(id.to_owned(), index).is_some() {
            return Err(self.wrong(format!("edge \"{id}\" is there twice")));
        }
        let street = attributes.get("name").unwrap_or_default().into();
        self.net.edges.push(Edge { id: id.to_owned(), street, function, lanes: Vec::new(), junction, ends });
        Ok(())
    }

    fn junction_index(&mut self, id: &str) -> JunctionIndex {
        match self.junctions.get(id) {
            Some(known) => *known,
            None => {
                let index = JunctionIndex(self.junctions.len() as u32);
                self.junctions.insert(id.to_owned(), index);
                index
            }
        }
    }

    fn lane(&mut self, attributes: &ElementAttributes) -> Result<()> {
        let id = attributes.required("id")?;
        let Some(edge) = self.net.edges.last_key() else {
            return Err(self.wrong(format!("lane \"{id}\" is not inside an edge")));
        };
        let (shape, heights) = attributes.shape(attributes.required("shape")?)?;
        self.net.heights = heights.iter().fold(self.net.heights, |[low, high], z| [low.min(*z), high.max(*z)]);
        if shape.len() < 2 {
            let points = shape.len();
            return Err(self.wrong(format!("lane \"{id}\" has {points} shape point(s); at least two are needed")));
        }
        let length = attributes.number("length", f64::NAN, &LANE_LENGTH)?;
        let width = attributes.number("width", USUAL_WIDTH, &LANE_WIDTH)?;
        let limit = attributes.get("speed").and_then(|speed| speed.parse().ok()).filter(|speed| *speed > 0.0);
        let speed = limit.unwrap_or(f64::INFINITY);
        let has_vehicles = attributes.get("allow") != Some("pedestrian") && attributes.get("disallow") != Some("all");
        let index = self.net.lanes.next_key();
        let edge_lanes = &mut self.net.edges[edge].lanes;
        let place = edge_lanes.len() as u32;
        edge_lanes.push(index);
        if self.net.lane_ids.insert(id.to_owned(), index).is_some() {
            return Err(self.wrong(format!("lane \"{id}\" is there twice")));
        }
        self.net.lines.begin();
        let drawn = shape.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
        self.net.lines.set_stretch(stretch(length, drawn));
        shape.iter().for_each(|point| self.net.lines.push(*point));
        let (links, from) = (Vec::new(), Vec::new());
        let id = id.to_owned();
        self.net.lanes.push(Lane { id, edge, index: place, length, width, speed, has_vehicles, shape, links, from });
        Ok(())
    }

    fn junction(&mut self, attributes: &ElementAttributes) -> Result<()> {
        let id = attributes.required("id")?;
        let shape = match attributes.get("shape") {
            Some(shape) => attributes.shape(shape)?.0,
            None => Vec::new(),
        };
        let (link_lanes, foes, responses) = (Vec::new(), Vec::new(), Vec::new());
        self.net.junctions.push(Junction { id: id.to_owned(), shape, link_lanes, foes, responses });
        self.link_lanes.push(attributes.get("intLanes").unwrap_or_default().to_owned());
        Ok(())
    }

    /// A link through the junction read last; SUMO writes them in order.
    fn request(&mut self, attributes: &ElementAttributes) -> Result<()> {
        let foes = attributes.required("foes")?.into();
        let Some(junction) = self.net.junctions.last_mut() else {
            return Err(self.wrong("a request is not inside a junction"));
        };
        junction.foes.push(foes);
        junction.responses.push(attributes.get("response").unwrap_or_default().into());
        Ok(())
    }

    fn connection(&mut self, attributes: &ElementAttributes) -> Result<()> {
        let index = attributes.get("linkIndex").and_then(|index| index.parse().ok());
        let signal = attributes.get("tl").zip(index).map(|(light, index)| Signal { light: self.light(light), index });
        let end = |edge: &str, lane: &str| -> Result<(String, u32)> {
            let index = attributes.required(lane)?;
            let index = index.parse().map_err(|_| self.wrong(format!("connection: {lane} is \"{index}\"")))?;
            Ok((attributes.required(edge)?.to_owned(), index))
        };
        let connection = Connection {
            line: self.line,
            direction: match attributes.get("dir") {
                Some("l") => Direction::Left,
                Some("r") => Direction::Right,
                Some("t" | "T") => Direction::Around,
                _ => Direction::Straight,
            },
            signal,
            from: end("from", "fromLane")?,
            to: end("to", "toLane")?,
            via: attributes.get("via").map(str::to_owned),
        };
        self.connections.push(connection);
        Ok(())
    }

    /// The number of a traffic light.
    fn light(&mut self, id: &str) -> u32 {
        if let Some(known) = self.lights.get(id) {
            return *known;
        }
        let light = self.net.lights.len() as u32;
        self.net.lights.push(id.to_owned());
        self.lights.insert(id.to_owned(), light);
        light
    }

    fn location(&mut self, attributes: &ElementAttributes) -> Result<()> {
        let text = attributes.get("netOffset").unwrap_or("0,0");
        let mut values = text.split(',').map(|value| value.trim().parse::<f64>().ok());
        let (Some(Some(x)), Some(Some(y))) = (values.next(), values.next()) else {
            return Err(self.wrong(format!("netOffset is \"{text}\", not x,y")));
        };
        for offset in [x, y] {
            POSITION.check("netOffset", offset).map_err(|why| self.wrong(why))?;
        }
        let projection = attributes.get("projParameter").unwrap_or("!").to_owned();
        let location = Location { offset: Vector::new(x, y), projection };
        self.net.to_degrees = Projection::of(Some(&location)).ok().flatten().map(Projection::into_degrees);
        self.net.location = Some(location);
        Ok(())
    }

    pub fn wrong(&self, message: impl Into<String>) -> Error {
        Error::line(self.path, self.line, message)
    }
}

/// The junction of an internal edge: `:J_0` lies in junction J.
fn junction_of_internal(edge: &str) -> &str {
    let name = edge.strip_prefix(':').unwrap_or(edge);
    name.rsplit_once('_').map_or(name, |(junction, _)| junction)
}
