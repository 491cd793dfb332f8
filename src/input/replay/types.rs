//! Vehicle types for a replay, from route and additional files and SUMO's defaults: an fcd-output only names them.

use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use crate::traffic::profile::origins;
use crate::traffic::sumo_type::SumoType;
use crate::util::input_file::LineCounter;
use crate::{Error, Result};

/// VehicleTypes by their id.
#[derive(Clone, Debug, Default)]
pub struct VehicleTypes {
    known: FxHashMap<String, SumoType>,
}

impl VehicleTypes {
    /// Reads the `<vType>` elements of route and additional files.
    ///
    /// # Errors
    /// An error that names the file, the line and what is wrong.
    pub fn read(paths: &[PathBuf]) -> Result<Self> {
        let mut types = Self::default();
        paths.iter().try_for_each(|path| types.add(path))?;
        Ok(types)
    }

    fn add(&mut self, path: &Path) -> Result<()> {
        let mut reader = Reader::from_reader(LineCounter::new(crate::util::input_file::open(path)?));
        let mut buffer = Vec::new();
        loop {
            buffer.clear();
            let line = reader.get_ref().line();
            let wrong = |message: String| Error::line(path, line, message.replace('\n', " "));
            match reader.read_event_into(&mut buffer).map_err(|error| wrong(error.to_string()))? {
                Event::Start(tag) | Event::Empty(tag) if tag.name().as_ref() == "vType" => {
                    let found = vehicle_type(&tag).map_err(wrong)?;
                    self.known.insert(found.name.clone(), found);
                }
                Event::Eof => return Ok(()),
                _ => {}
            }
        }
    }

    /// Whether a file or SUMO itself defines this type or the type from which it was made.
    pub fn define(&self, name: &str) -> bool {
        origins(name).any(|name| self.known.contains_key(name) || OWN.iter().any(|(own, _)| *own == name))
    }

    /// The type with this id: as a file defines it or the type from which it was made, otherwise SUMO's default type of that
    /// name, otherwise a car (or a pedestrian).
    pub fn named(&self, name: &str, person: bool) -> SumoType {
        let any = if person { "pedestrian" } else { "passenger" };
        let own = |name| OWN.iter().find(|(own, _)| *own == name).map(|(_, class)| *class);
        let class = || origins(name).find_map(own).unwrap_or(any);
        let known = origins(name).find_map(|name| self.known.get(name));
        known.map_or_else(
            || SumoType::of_class(name, class()),
            |known| SumoType { name: name.to_owned(), ..known.clone() },
        )
    }
}

fn vehicle_type(tag: &BytesStart) -> std::result::Result<SumoType, String> {
    let text = |name: &str| -> std::result::Result<Option<String>, String> {
        let found = tag.try_get_attribute(name).map_err(|error| error.to_string())?;
        found.map(|found| unescaped(&found.value)).transpose()
    };
    let number = |name: &str| -> std::result::Result<Option<f64>, String> {
        let parse = |text: String| text.parse().map_err(|_| format!("{name} is \"{text}\", not a number"));
        text(name)?.map(parse).transpose()
    };
    let id = text("id")?.ok_or("a vType has no id")?;
    let mut found = SumoType::of_class(&id, text("vClass")?.as_deref().unwrap_or("passenger"));
    found.shape = text("guiShape")?.unwrap_or(found.shape);
    found.length = number("length")?.unwrap_or(found.length);
    found.width = number("width")?.unwrap_or(found.width);
    found.mass = number("mass")?.unwrap_or(found.mass);
    found.decel = number("decel")?.unwrap_or(found.decel);
    // As in SUMO, emergency braking is never weaker than ordinary braking.
    found.emergency_decel = number("emergencyDecel")?.unwrap_or(found.emergency_decel.max(found.decel));
    Ok(found)
}

fn unescaped(text: &str) -> std::result::Result<String, String> {
    quick_xml::escape::unescape(text).map(std::borrow::Cow::into_owned).map_err(|error| error.to_string())
}

/// SUMO's own types, with the vehicle class of each.
const OWN: [(&str, &str); 6] = [
    ("DEFAULT_VEHTYPE", "passenger"),
    ("DEFAULT_PEDTYPE", "pedestrian"),
    ("DEFAULT_BIKETYPE", "bicycle"),
    ("DEFAULT_TAXITYPE", "taxi"),
    ("DEFAULT_RAILTYPE", "rail"),
    ("DEFAULT_CONTAINERTYPE", "container"),
];
