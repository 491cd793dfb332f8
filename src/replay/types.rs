//! Vehicle types for a replay: an fcd-output names them only. From route and additional files, and SUMO's defaults.

use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use crate::net::LineCounter;
use crate::profile::{SumoType, origins};
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
        let mut reader = Reader::from_reader(LineCounter::new(crate::net::open(path)?));
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
        known.map_or_else(|| of_class(name, class()), |known| SumoType { name: name.to_owned(), ..known.clone() })
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
    let mut found = of_class(&id, text("vClass")?.as_deref().unwrap_or("passenger"));
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

fn of_class(name: &str, class: &str) -> SumoType {
    let known = CLASSES.iter().find(|(known, ..)| *known == class).unwrap_or(&CLASSES[0]);
    let (_, length, width, mass, emergency_decel, decel) = *known;
    let shape = if class == "trailer" { "truck/trailer" } else { class }.to_owned();
    SumoType {
        name: name.to_owned(),
        vehicle_class: class.to_owned(),
        shape,
        length,
        width,
        mass,
        emergency_decel,
        decel,
    }
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

/// SUMO's defaults by vehicle class, as SUMO 1.28 tells them: length and width in m, mass in kg, `emergencyDecel` and
/// `decel` in m/s². A class that is not here has those of the first.
const CLASSES: [(&str, f64, f64, f64, f64, f64); 23] = [
    ("passenger", 5.0, 1.8, 1500.0, 9.0, 4.5),
    ("emergency", 6.5, 2.16, 5000.0, 9.0, 4.5),
    ("pedestrian", 0.215, 0.478, 70.0, 5.0, 2.0),
    ("bus", 12.0, 2.5, 12000.0, 7.0, 4.0),
    ("coach", 14.0, 2.6, 25000.0, 7.0, 4.0),
    ("delivery", 6.5, 2.16, 5000.0, 9.0, 4.5),
    ("truck", 7.1, 2.4, 4500.0, 7.0, 4.0),
    ("trailer", 16.5, 2.55, 13000.0, 7.0, 4.0),
    ("tram", 22.0, 2.4, 37900.0, 7.0, 3.0),
    ("rail_urban", 109.5, 3.0, 59000.0, 7.0, 3.0),
    ("rail", 135.0, 2.84, 79500.0, 5.0, 1.3),
    ("rail_electric", 200.0, 2.95, 83000.0, 5.0, 1.3),
    ("rail_fast", 200.0, 2.95, 409000.0, 5.0, 1.3),
    ("motorcycle", 2.2, 0.9, 200.0, 10.0, 10.0),
    ("moped", 2.1, 0.78, 80.0, 10.0, 7.0),
    ("bicycle", 1.6, 0.65, 10.0, 7.0, 3.0),
    ("ship", 17.0, 4.0, 100000.0, 1.0, 0.15),
    ("container", 6.096, 2.438, 1500.0, 9.0, 4.5),
    ("subway", 109.5, 3.0, 59000.0, 9.0, 4.5),
    ("aircraft", 72.7, 79.8, 1500.0, 9.0, 4.5),
    ("wheelchair", 1.2, 0.72, 90.0, 5.0, 2.0),
    ("scooter", 1.2, 0.5, 10.0, 7.0, 3.0),
    ("drone", 0.5, 0.5, 1500.0, 9.0, 4.5),
];
