//! Vehicle types for a replay: an fcd-output names them only. From route and additional files, and SUMO's defaults.

use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use crate::traffic::profile::origins;
use crate::traffic::sumo_type::SumoType;
use crate::util::input_file::LineCounter;
use crate::{Error, Result};

/// Types by their id.
#[derive(Clone, Debug, Default)]
pub struct Types {
    known: FxHashMap<String, SumoType>,
}

impl Types {
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

    /// Whether a file defines this type or the one that it was made from, or SUMO has one of that name.
    pub fn define(&self, name: &str) -> bool {
        origins(name).any(|name| self.known.contains_key(name) || OWN.iter().any(|(own, _)| *own == name))
    }

    /// The type of this id: as it, or the one that it was made from, was read, else SUMO's default type of that name, else
    /// a car (or a pedestrian).
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
    let id = text("id")?.ok_or("a vType without id")?;
    let mut found = SumoType::of_class(&id, text("vClass")?.as_deref().unwrap_or("passenger"));
    found.shape = text("guiShape")?.unwrap_or(found.shape);
    found.length = number("length")?.unwrap_or(found.length);
    found.width = number("width")?.unwrap_or(found.width);
    found.mass = number("mass")?.unwrap_or(found.mass);
    found.decel = number("decel")?.unwrap_or(found.decel);
    // As SUMO has it: no emergency braking is weaker than ordinary braking.
    found.emergency_decel = number("emergencyDecel")?.unwrap_or(found.emergency_decel.max(found.decel));
    Ok(found)
}

fn unescaped(text: &str) -> std::result::Result<String, String> {
    quick_xml::escape::unescape(text).map(std::borrow::Cow::into_owned).map_err(|error| error.to_string())
}

/// The types that SUMO itself has, and the vehicle class of each.
const OWN: [(&str, &str); 6] = [
    ("DEFAULT_VEHTYPE", "passenger"),
    ("DEFAULT_PEDTYPE", "pedestrian"),
    ("DEFAULT_BIKETYPE", "bicycle"),
    ("DEFAULT_TAXITYPE", "taxi"),
    ("DEFAULT_RAILTYPE", "rail"),
    ("DEFAULT_CONTAINERTYPE", "container"),
];
