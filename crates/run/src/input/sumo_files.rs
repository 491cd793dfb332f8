//! The input files that a SUMO configuration names, and whether they are complete.

use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::Event;

use crate::util::input_file::{self, ElementSource, xml_message};
use crate::{Error, Result};

/// Checks that an XML file is well-formed to its end: SUMO reads demand piece by piece and would find a fault only during
/// the run.
///
/// # Errors
/// An error that names the file, the line and what is wrong.
pub fn check_xml(path: &Path) -> Result<()> {
    let mut reader = Reader::from_reader(ElementSource::open(path)?);
    reader.config_mut().check_end_names = true;
    let mut buffer = Vec::new();
    let mut depth = 0_i64;
    let mut elements = 0_u64;
    loop {
        buffer.clear();
        let line = reader.get_mut().begin_element();
        match reader.read_event_into(&mut buffer) {
            Ok(Event::Start(_)) => {
                depth += 1;
                elements += 1;
            }
            Ok(Event::Empty(_)) => elements += 1,
            Ok(Event::End(_)) => depth -= 1,
            Ok(Event::Eof) => break,
            Ok(_) => {}
            Err(error) => return Err(Error::line(path, line, xml_message(&error))),
        }
    }
    if depth != 0 || elements == 0 {
        return Err(Error::content(path, "the file ends before its elements do"));
    }
    Ok(())
}

/// The fault in the files that a SUMO configuration names, if one is found: SUMO's own messages do not always name the
/// file.
pub fn fault(configuration: &Path) -> Option<Error> {
    check_xml(configuration).err().or_else(|| {
        let named = files_of(configuration).ok()?;
        named.into_iter().find_map(|(option, path)| {
            let checked = if option == "net-file" { crate::net::read(&path).map(|_| ()) } else { check_xml(&path) };
            checked.err()
        })
    })
}

/// Checks that none of the files that a configuration names is a pipe or a device, for which SUMO would wait, or which
/// would never end. What else is wrong with them, SUMO says itself.
///
/// # Errors
/// [`Error::Content`] that names the file.
pub fn check_are_files(configuration: &Path) -> Result<()> {
    let named = files_of(configuration).unwrap_or_default();
    named.iter().filter(|(_, path)| path.exists()).try_for_each(|(_, path)| input_file::file(path).map(|_| ()))
}

/// The net that a SUMO configuration names, if it can be read.
pub fn net_of(configuration: &Path) -> Option<PathBuf> {
    let named = files_of(configuration).ok()?;
    named.into_iter().find(|(option, _)| *option == "net-file").map(|(_, path)| path)
}

/// The value of an option in a SUMO configuration, if it is set there.
pub fn value_of(configuration: &Path, option: &str) -> Option<String> {
    options_of(configuration).ok()?.into_iter().find(|set| set.name == option).map(|set| set.value)
}

/// The files that a configuration names, each with the option that names it.
pub(super) fn files_of(configuration: &Path) -> Result<Vec<(&'static str, PathBuf)>> {
    const OPTIONS: [(&str, &str); 6] = [
        ("net-file", "net-file"),
        ("n", "net-file"),
        ("route-files", "route-files"),
        ("r", "route-files"),
        ("additional-files", "additional-files"),
        ("a", "additional-files"),
    ];
    let folder = configuration.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    for SumoOption { name, value, .. } in options_of(configuration)? {
        if let Some((_, option)) = OPTIONS.iter().find(|(known, _)| *known == name) {
            let names = value.split(',').map(str::trim).filter(|name| !name.is_empty());
            files.extend(names.map(|name| (*option, folder.join(name))));
        }
    }
    Ok(files)
}

/// An option that a configuration sets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SumoOption {
    /// The element that it is in, by which SUMO groups options; it has no meaning for SUMO.
    pub section: String,
    /// Its name.
    pub name: String,
    /// Its value, with XML's escapes.
    pub value: String,
}

/// The options that a configuration sets, in its order.
///
/// # Errors
/// [`Error::File`] or [`Error::Line`] where it cannot be read.
pub fn options_of(configuration: &Path) -> Result<Vec<SumoOption>> {
    let mut reader = Reader::from_reader(ElementSource::open(configuration)?);
    let mut buffer = Vec::new();
    let mut options = Vec::new();
    let mut section = String::new();
    loop {
        buffer.clear();
        let line = reader.get_mut().begin_element();
        let event = reader.read_event_into(&mut buffer);
        let event = event.map_err(|error| Error::line(configuration, line, xml_message(&error)))?;
        let tag = match event {
            Event::Start(tag) | Event::Empty(tag) => tag,
            Event::Eof => return Ok(options),
            _ => continue,
        };
        let name = tag.name().as_ref().to_owned();
        match tag.try_get_attribute("value") {
            Ok(Some(value)) => {
                options.push(SumoOption { section: section.clone(), name, value: value.value.into_owned() });
            }
            _ => section = name,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::input::sumo_files::*;

    fn with_file<T>(name: &str, text: &str, action: impl FnOnce(&Path) -> T) -> T {
        let path = std::env::temp_dir().join(format!("closecall-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let result = action(&path);
        std::fs::remove_file(&path).unwrap();
        result
    }

    #[test]
    fn a_late_fault_in_a_route_file_names_its_line() {
        let message =
            with_file("bad.rou.xml", "<routes>\n<vehicle>\n</route>\n</routes>", check_xml).unwrap_err().to_string();
        assert!(message.contains("bad.rou.xml, line 3: "), "{message}");
        let message = with_file("cut.rou.xml", "<routes>\n<vehicle/>\n", check_xml).unwrap_err().to_string();
        assert!(message.contains("the file ends before its elements do"), "{message}");
    }
}
