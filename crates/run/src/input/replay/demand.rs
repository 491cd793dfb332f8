//! The types and routes of a recording's vehicles, from route and additional files.

use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use super::lists::{ListWriter, Lists, Place};
use super::types::{VehicleTypes, text, vehicle_type};
use crate::util::input_file::{ElementSource, xml_message};
use crate::{Error, Result};
use closecall::traffic::net::{EdgeIndex, Net};

/// Reads the types and the routes that route and additional files define.
///
/// # Errors
/// An error that names the file, the line and what is wrong.
pub(super) fn read(paths: &[PathBuf], net: &Net) -> Result<(VehicleTypes, PlannedRoutes)> {
    let mut reader = DemandReader::new(net);
    paths.iter().try_for_each(|path| reader.elements(path, ElementSource::open(path)?))?;
    Ok((reader.types, PlannedRoutes { routes: reader.routes, lists: reader.lists.finish()? }))
}

/// Reads a text as a route or additional file; `path` names it in errors.
///
/// # Errors
/// As for files.
pub fn parse(path: &Path, text: impl Into<Vec<u8>>, net: &Net) -> Result<()> {
    let mut reader = DemandReader::new(net);
    reader.elements(path, ElementSource::new(Box::new(std::io::Cursor::new(text.into()))))
}

/// The routes that the files define; their edges are in a temporary file.
pub struct PlannedRoutes {
    routes: Known,
    lists: Lists,
}

impl PlannedRoutes {
    /// No routes.
    ///
    /// # Errors
    /// [`Error::File`] if there can be no temporary file.
    pub fn none() -> Result<Self> {
        Ok(Self { routes: Known::default(), lists: ListWriter::default().finish()? })
    }

    /// The route of a vehicle; empty if no file has it. Vehicles of the flow F are named F.0, F.1, ….
    pub(super) fn of(&mut self, vehicle: &str) -> Result<Vec<EdgeIndex>> {
        let Known { named, vehicles, flows } = &self.routes;
        let flow = || {
            let (flow, number) = vehicle.rsplit_once('.')?;
            flows.get(flow).filter(|_| number.bytes().all(|byte| byte.is_ascii_digit()))
        };
        let place = match vehicles.get(vehicle).or_else(flow) {
            Some(PlannedRoute::Own(place)) => Some(place),
            Some(PlannedRoute::Named(name)) => named.get(name),
            None => None,
        };
        let edges = place.map_or(Ok(Vec::new()), |place| self.lists.read(*place))?;
        Ok(edges.into_iter().map(EdgeIndex).collect())
    }
}

/// The routes that are known, by id.
#[derive(Default)]
struct Known {
    named: FxHashMap<Box<str>, Place>,
    vehicles: FxHashMap<Box<str>, PlannedRoute>,
    flows: FxHashMap<Box<str>, PlannedRoute>,
}

/// The route of a vehicle or a flow.
enum PlannedRoute {
    Own(Place),
    /// That with this id: a later file may define it.
    Named(Box<str>),
}

struct DemandReader<'a> {
    net: &'a Net,
    types: VehicleTypes,
    lists: ListWriter,
    routes: Known,
}

/// An element that contains its route.
struct Holder {
    id: Box<str>,
    is_flow: bool,
}

/// What is wrong with an element.
type Found<T> = std::result::Result<T, String>;

impl<'a> DemandReader<'a> {
    fn new(net: &'a Net) -> Self {
        Self { net, types: VehicleTypes::default(), lists: ListWriter::default(), routes: Known::default() }
    }

    fn elements(&mut self, path: &Path, source: ElementSource) -> Result<()> {
        let mut reader = Reader::from_reader(source);
        let mut buffer = Vec::new();
        let mut holder = None;
        loop {
            buffer.clear();
            let line = reader.get_mut().begin_element();
            let wrong = |message: String| Error::line(path, line, message.replace('\n', " "));
            match reader.read_event_into(&mut buffer).map_err(|error| wrong(xml_message(&error)))? {
                Event::Start(tag) => match tag.name().as_ref() {
                    "vehicle" | "trip" | "flow" => holder = self.vehicle(&tag).map_err(wrong)?,
                    // Which of several routes a vehicle takes is not known.
                    "routeDistribution" => holder = None,
                    "person" | "personFlow" => self.person(&tag).map_err(wrong)?,
                    _ => self.element(&tag, holder.as_ref(), wrong)?,
                },
                Event::Empty(tag) => match tag.name().as_ref() {
                    "vehicle" | "trip" | "flow" => _ = self.vehicle(&tag).map_err(wrong)?,
                    "person" | "personFlow" => self.person(&tag).map_err(wrong)?,
                    _ => self.element(&tag, holder.as_ref(), wrong)?,
                },
                Event::End(tag) if ["vehicle", "trip", "flow"].contains(&tag.name().as_ref()) => holder = None,
                Event::Eof => return Ok(()),
                _ => {}
            }
        }
    }

    fn element(&mut self, tag: &BytesStart, holder: Option<&Holder>, wrong: impl Fn(String) -> Error) -> Result<()> {
        match tag.name().as_ref() {
            "vType" => self.types.insert(vehicle_type(tag).map_err(wrong)?),
            "route" => {
                let Some(edges) = self.edges(tag).map_err(&wrong)? else { return Ok(()) };
                let place = self.lists.write(edges)?;
                match holder {
                    Some(Holder { id, is_flow: false }) => {
                        _ = self.routes.vehicles.insert(id.clone(), PlannedRoute::Own(place))
                    }
                    Some(Holder { id, .. }) => _ = self.routes.flows.insert(id.clone(), PlannedRoute::Own(place)),
                    None => {
                        if let Some(id) = text(tag, "id").map_err(wrong)? {
                            self.routes.named.insert(id.into(), place);
                        }
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// A vehicle, or a flow of vehicles; returned if its route may follow.
    fn vehicle(&mut self, tag: &BytesStart) -> Found<Option<Holder>> {
        let Some(id) = text(tag, "id")?.map(String::into_boxed_str) else { return Ok(None) };
        let is_flow = tag.name().as_ref() == "flow";
        self.types.assign(&id, text(tag, "type")?, false);
        let Some(route) = text(tag, "route")? else { return Ok(Some(Holder { id, is_flow })) };
        let known = if is_flow { &mut self.routes.flows } else { &mut self.routes.vehicles };
        known.insert(id, PlannedRoute::Named(route.into()));
        Ok(None)
    }

    fn person(&mut self, tag: &BytesStart) -> Found<()> {
        if let Some(id) = text(tag, "id")? {
            self.types.assign(&id, text(tag, "type")?, true);
        }
        Ok(())
    }

    /// The edges of a route; none where the net lacks one of them.
    fn edges(&self, tag: &BytesStart) -> Found<Option<Vec<u32>>> {
        let edges = text(tag, "edges")?.unwrap_or_default();
        let edges = edges.split([' ', ',', '\t', '\n']).filter(|id| !id.is_empty());
        Ok(edges.map(|id| self.net.edge(id).map(|edge| edge.0)).collect())
    }
}

#[cfg(test)]
mod tests {
    use crate::input::replay::demand::*;

    #[test]
    fn routes_are_nested_or_named_and_of_vehicles_or_flows() {
        let edge = |id| format!(r#"<edge id="{id}"><lane id="{id}_0" length="9" shape="0,0 9,0"/></edge>"#);
        let net =
            crate::net::parse(Path::new("net"), format!("<net>{}</net>", ["a", "b", "c"].map(edge).concat())).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, format!("<routes>{text}</routes>")).unwrap();
            path
        };
        let routes = write(
            "a.rou.xml",
            r#"<vType id="t"/>
            <vehicle id="own" type="t" depart="0"><stop lane="a_0"/><route edges="a b"/></vehicle>
            <vehicle id="named" route="late" depart="1"/>
            <trip id="trip" from="a" to="c"/>
            <person id="walker" depart="0"><walk edges="a"/></person>
            <flow id="flow" type="truck" begin="0" end="9" number="3"><route edges="b,c"/></flow>
            <flow id="flow.x" route="late" begin="0" end="9" number="3"><param key="a" value="b"/></flow>
            <vehicle id="several"><routeDistribution><route edges="a"/><route edges="b"/></routeDistribution></vehicle>
            <vehicle id="elsewhere"><route edges="a z"/></vehicle>"#,
        );
        let named = write("b.add.xml", r#"<route id="late" edges="c"/><route edges="a"/>"#);
        let (types, mut planned) = read(&[routes, named], &net).unwrap();
        assert!(types.define("t"));
        for (id, person, kind) in [
            ("own", false, Some("t")),
            ("flow.7", false, Some("truck")),
            ("named", false, Some("DEFAULT_VEHTYPE")),
            ("walker", true, Some("DEFAULT_PEDTYPE")),
            ("walker", false, None),
            ("flow.x.y", false, None),
        ] {
            assert_eq!(types.of_user(id, person), kind, "{id}");
        }
        for (vehicle, route) in [
            ("own", "ab"),
            ("named", "c"),
            ("trip", ""),
            ("flow", ""),
            ("flow.0", "bc"),
            ("flow.12", "bc"),
            ("flow.x.2", "c"),
            ("flow.x", ""),
            ("several", ""),
            ("elsewhere", ""),
            ("own.1", ""),
        ] {
            let edges = planned.of(vehicle).unwrap();
            let found = edges.iter().map(|edge| &*net.edges[*edge].id).collect::<String>();
            assert_eq!(found, route, "{vehicle}");
        }
    }
}
