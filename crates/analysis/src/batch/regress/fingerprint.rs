//! The fingerprint of an input file: its hash, and the parts that are usually edited, so that a change can be named.

use std::collections::BTreeMap;
use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde::{Deserialize, Serialize};

use crate::Result;
use closecall_run::output::input_hash::Input;

/// If a file has more parts of one sort than this, none is kept: expected results should stay smaller than the net.
const MOST_PARTS: usize = 1000;

/// A part's attributes by name.
type Attributes = BTreeMap<String, String>;

/// An input file, as it was when a run read it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// Its path, relative to the scenario's folder.
    pub path: String,
    /// Its SHA-256 in hexadecimal digits.
    pub sha256: String,
    /// Vehicle types, signal programs and junction types: `vType car` with its attributes, and so on.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parts: BTreeMap<String, Attributes>,
}

impl Fingerprint {
    /// Reads the parts of a file; empty if it is not XML.
    ///
    /// # Errors
    /// [`closecall_run::Error::File`] where it cannot be read.
    pub fn of(folder: &Path, input: Input) -> Result<Self> {
        let path = folder.join(&input.path);
        let name = path.strip_prefix(folder).unwrap_or(&input.path).to_string_lossy().replace('\\', "/");
        Ok(Self { parts: parts(&path)?, path: name, sha256: input.sha256 })
    }

    /// What differs from `now`, in words, the file's name first; empty if nothing does.
    pub fn changes(&self, now: &Self) -> Vec<String> {
        if self.sha256 == now.sha256 {
            return Vec::new();
        }
        let names = self.parts.keys().chain(now.parts.keys()).collect::<std::collections::BTreeSet<_>>();
        let changed = names.into_iter().filter_map(|name| {
            let what = match (self.parts.get(name), now.parts.get(name)) {
                (Some(old), Some(new)) => attribute_changes(old, new),
                (Some(_), None) => Some("gone".to_owned()),
                (None, Some(_)) => Some("new".to_owned()),
                (None, None) => None,
            };
            Some(format!("{}: {name}: {}", self.path, what?))
        });
        let changed = changed.collect::<Vec<_>>();
        if changed.is_empty() { vec![self.path.clone()] } else { changed }
    }
}

fn attribute_changes(old: &Attributes, new: &Attributes) -> Option<String> {
    let names = old.keys().chain(new.keys()).collect::<std::collections::BTreeSet<_>>();
    let value = |attributes: &Attributes, name: &str| attributes.get(name).map_or("(none)", String::as_str).to_owned();
    let changed = names
        .into_iter()
        .filter(|name| old.get(*name) != new.get(*name))
        .map(|name| format!("{name} {} → {}", value(old, name), value(new, name)))
        .collect::<Vec<_>>();
    (!changed.is_empty()).then(|| changed.join(", "))
}

fn parts(path: &Path) -> Result<BTreeMap<String, Attributes>> {
    let mut reader = Reader::from_reader(closecall_run::util::input_file::open(path)?);
    let mut buffer = Vec::new();
    let mut parts = BTreeMap::new();
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    let mut program = None;
    loop {
        buffer.clear();
        let tag = match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(tag) | Event::Empty(tag)) => tag,
            Ok(Event::Eof) => break,
            Ok(_) => continue,
            // SUMO could read the file, so this is not the user's error: the file has no parts.
            Err(_) => return Ok(BTreeMap::new()),
        };
        let sort = tag.name().as_ref().to_owned();
        let mut attributes = attributes(&tag);
        let id = attributes.remove("id").unwrap_or_default();
        match sort.as_str() {
            "vType" => {}
            "tlLogic" => {
                program = Some(format!("tlLogic {id} {}", attributes.get("programID").map_or("", String::as_str)));
            }
            "junction" => attributes.retain(|name, _| name == "type"),
            "phase" => {
                let phases = program.as_ref().and_then(|program| parts.get_mut(program));
                if let Some(phases) = phases {
                    add_phase(phases, &attributes);
                }
                continue;
            }
            _ => continue,
        }
        // Internal junctions change with every build of a net.
        if sort == "junction" && attributes.get("type").is_some_and(|kind| kind == "internal") {
            continue;
        }
        *count.entry(sort.clone()).or_default() += 1;
        let name = if sort == "tlLogic" { program.clone().unwrap_or_default() } else { format!("{sort} {id}") };
        parts.insert(name, attributes);
    }
    let too_many = |name: &str| {
        let sort = name.split(' ').next().unwrap_or_default();
        count.get(sort).is_some_and(|count| *count > MOST_PARTS)
    };
    parts.retain(|name, _| !too_many(name));
    Ok(parts)
}

/// Makes a phase an attribute of its program: `phase 3`, its seconds and its lights.
fn add_phase(program: &mut Attributes, phase: &Attributes) {
    let number = program.keys().filter(|name| name.starts_with("phase ")).count();
    let text = |name: &str| phase.get(name).map_or("", String::as_str);
    program.insert(format!("phase {number:02}"), format!("{} s {}", text("duration"), text("state")));
}

fn attributes(tag: &BytesStart) -> Attributes {
    let read = tag.attributes().flatten();
    read.map(|attribute| (attribute.key.as_ref().to_owned(), attribute.value.to_string())).collect()
}

#[cfg(test)]
mod tests {
    use crate::batch::regress::fingerprint::*;

    fn fingerprint(text: &str) -> Fingerprint {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        std::fs::write(&path, text).unwrap();
        Fingerprint::of(folder.path(), Input::of(&path).unwrap()).unwrap()
    }

    #[test]
    fn a_change_is_named_by_part_and_attribute() {
        let text = r#"<net><vType id="car" tau="1.0"/><tlLogic id="a" programID="0"><phase duration="30" state="Gr"/>
            <phase duration="3" state="yr"/></tlLogic><junction id="j" type="priority_stop" x="1"/></net>"#;
        let before = fingerprint(text);
        for (from, to, said) in [
            (r#"tau="1.0""#, r#"tau="0.5""#, "a.xml: vType car: tau 1.0 → 0.5"),
            (r#""30""#, r#""33""#, "a.xml: tlLogic a 0: phase 00 30 s Gr → 33 s Gr"),
            ("priority_stop", "priority", "a.xml: junction j: type priority_stop → priority"),
            (r#"x="1""#, r#"x="2""#, "a.xml"),
            (r#"<vType id="car" tau="1.0"/>"#, "", "a.xml: vType car: gone"),
        ] {
            assert_eq!(before.changes(&fingerprint(&text.replace(from, to))), [said]);
        }
        assert!(before.changes(&before).is_empty());
    }

    #[test]
    fn a_file_that_is_not_xml_has_only_a_hash() {
        assert!(fingerprint("a,b\n1,2\n").parts.is_empty());
    }
}
