//! Vehicle types for a replay, from route and additional files and SUMO's defaults: an fcd-output only names them.

use quick_xml::events::BytesStart;
use rustc_hash::FxHashMap;

use closecall::traffic::profile::origins;
use closecall::traffic::sumo_type::SumoType;
use closecall::util::limits::{DECELERATION, DURATION, LENGTH, Limit, MASS, RESERVE, WIDTH};

/// Types by their id, and which vehicle or person has which.
#[derive(Clone, Debug, Default)]
pub(crate) struct VehicleTypes {
    known: FxHashMap<String, SumoType>,
    /// The type of each vehicle and flow, and of each person, by id.
    of_users: [FxHashMap<Box<str>, Box<str>>; 2],
}

impl VehicleTypes {
    /// Adds a type.
    pub fn insert(&mut self, found: SumoType) {
        self.known.insert(found.name.clone(), found);
    }

    /// Notes the type that a file gives to a vehicle, a flow or a person; without one it is SUMO's default type.
    pub(crate) fn assign(&mut self, id: &str, name: Option<String>, person: bool) {
        let name = name.unwrap_or_else(|| OWN[usize::from(person)].0.to_owned());
        self.of_users[usize::from(person)].insert(id.into(), name.into());
    }

    /// The type that a file gives to a vehicle or a person. A flow F has members F.0, F.1, ….
    pub(crate) fn of_user(&self, id: &str, person: bool) -> Option<&str> {
        let known = &self.of_users[usize::from(person)];
        let flow = || {
            let (flow, number) = id.rsplit_once('.')?;
            known.get(flow).filter(|_| number.bytes().all(|byte| byte.is_ascii_digit()))
        };
        known.get(id).or_else(flow).map(|name| &**name)
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

/// The type that a `<vType>` defines.
pub(super) fn vehicle_type(tag: &BytesStart) -> std::result::Result<SumoType, String> {
    let text = |name: &str| text(tag, name);
    let id = text("id")?.ok_or("a vType has no id")?;
    let number = |name: &str, limit: &Limit| -> std::result::Result<Option<f64>, String> {
        let parse = |text: String| {
            let value = text.parse().map_err(|_| format!("{name} is \"{text}\", not a number"))?;
            limit.check(name, value).map_err(|why| format!("type \"{id}\": {why}"))
        };
        text(name)?.map(parse).transpose()
    };
    let mut found = SumoType::of_class(&id, text("vClass")?.as_deref().unwrap_or("passenger"));
    found.shape = text("guiShape")?.unwrap_or(found.shape);
    found.length = number("length", &LENGTH)?.unwrap_or(found.length);
    found.width = number("width", &WIDTH)?.unwrap_or(found.width);
    found.mass = number("mass", &MASS)?.unwrap_or(found.mass);
    found.decel = number("decel", &DECELERATION)?.unwrap_or(found.decel);
    found.tau = number("tau", &DURATION)?.unwrap_or(found.tau);
    found.min_gap = number("minGap", &RESERVE)?.unwrap_or(found.min_gap);
    found.action_step = number("actionStepLength", &DURATION)?.unwrap_or(found.action_step);
    // As in SUMO, emergency braking is never weaker than ordinary braking.
    found.emergency_decel = number("emergencyDecel", &DECELERATION)?.unwrap_or(found.emergency_decel.max(found.decel));
    Ok(found)
}

/// The value of an attribute, if the element has it.
pub(super) fn text(tag: &BytesStart, name: &str) -> std::result::Result<Option<String>, String> {
    let Some(found) = tag.try_get_attribute(name).map_err(|error| error.to_string())? else { return Ok(None) };
    let value = quick_xml::escape::unescape(&found.value).map_err(|error| error.to_string())?;
    Ok(Some(value.into_owned()))
}

/// SUMO's own types, with the vehicle class of each; first that of vehicles, then that of persons.
const OWN: [(&str, &str); 6] = [
    ("DEFAULT_VEHTYPE", "passenger"),
    ("DEFAULT_PEDTYPE", "pedestrian"),
    ("DEFAULT_BIKETYPE", "bicycle"),
    ("DEFAULT_TAXITYPE", "taxi"),
    ("DEFAULT_RAILTYPE", "rail"),
    ("DEFAULT_CONTAINERTYPE", "container"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_type_follows_as_its_file_says_or_as_its_class_does() {
        let read =
            |attributes: &str| vehicle_type(&BytesStart::from_content(format!("vType {attributes}"), 5)).unwrap();
        let follows = |of: SumoType| [of.tau, of.min_gap, of.action_step];
        assert_eq!(follows(read(r#"id="a" tau="0.7" minGap="1" actionStepLength="0.5""#)), [0.7, 1.0, 0.5]);
        assert_eq!(follows(read(r#"id="b" vClass="bicycle""#)), [1.0, 0.5, 0.0]);
        assert_eq!(follows(read(r#"id="c" vClass="subway""#)), [1.0, 5.0, 0.0]);
    }
}
