//! The SUMO configuration of a cut-out: the options of the run, with the files that they name beside it.

use std::fs;
use std::path::Path;

use quick_xml::escape::unescape;

use crate::{Error, Result};
use closecall_run::input::sumo_files::{SumoOption, options_of};
use closecall_run::util::output_file;
use closecall_run::util::xml_text::escaped;

/// The configuration.
pub(crate) const CONFIGURATION: &str = "conflict.sumocfg";
/// What SUMO saved.
pub(crate) const STATE: &str = "state.xml.gz";
/// Names that no copied file may have.
const RESERVED: [&str; 2] = [CONFIGURATION, STATE];
/// Sections of SUMO's options that say what is written or shown, not what happens.
const OUTPUTS: [&str; 3] = ["output", "gui_only", "traci_server"];
/// Files of messages, which SUMO has among the options for what it reports.
const MESSAGES: [&str; 3] = ["log", "message-log", "error-log"];

/// SUMO's options.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Configuration(Vec<Set>);

/// An option that is set.
#[derive(Clone, Debug, PartialEq)]
struct Set {
    name: String,
    value: String,
    /// The files that it names.
    files: Vec<String>,
}

impl Configuration {
    /// Reads a configuration that SUMO has saved, with its sections. Files that it reads are copied into the folder `into`;
    /// what it would write is left out.
    ///
    /// # Errors
    /// Those of reading it; [`Error::file`] where a file cannot be copied.
    pub(crate) fn gather(saved: &Path, into: &Path) -> Result<Self> {
        let from = saved.parent().unwrap_or(Path::new(""));
        let mut options = Vec::new();
        for SumoOption { section, name, value } in options_of(saved)? {
            if OUTPUTS.contains(&&*section) || MESSAGES.contains(&&*name) || name.ends_with(".output") {
                continue;
            }
            let value = unescape(&value).map_or_else(|_| value.clone(), |value| value.into_owned());
            let mut set = Set { name, value: String::new(), files: Vec::new() };
            for part in value.split(',') {
                let path = from.join(part.trim());
                let part = if !part.trim().is_empty() && path.is_file() {
                    set.files.push(copy(&path, into)?);
                    set.files.last().map_or(part, |name| &**name)
                } else {
                    part
                };
                set.value += if set.value.is_empty() { "" } else { "," };
                set.value += part;
            }
            options.push(set);
        }
        Ok(Self(options))
    }

    /// With another value of an option.
    #[must_use]
    pub fn with(self, name: &str, value: impl ToString) -> Self {
        let Self(mut options) = self;
        options.retain(|set| set.name != name);
        options.push(Set { name: name.to_owned(), value: value.to_string(), files: Vec::new() });
        Self(options)
    }

    /// Without the options whose name begins so.
    #[must_use]
    pub fn without(self, begin: &str) -> Self {
        Self(self.0.into_iter().filter(|set| !set.name.starts_with(begin)).collect())
    }

    /// The files that were copied for it.
    pub fn files(&self) -> Vec<String> {
        self.0.iter().flat_map(|set| set.files.iter().cloned()).collect()
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`Error::file`] that names the file.
    pub fn write(&self, path: &Path) -> Result<()> {
        let lines =
            self.0.iter().map(|Set { name, value, .. }| format!("    <{name} value=\"{}\"/>\n", escaped(value)));
        let text = format!("<configuration>\n{}</configuration>\n", lines.collect::<String>());
        Ok(output_file::write(path, text.as_bytes())?)
    }
}

/// Copies a file into a folder, under its own name if that is free; returns the name.
///
/// # Errors
/// [`Error::file`] that names the file.
pub fn copy(path: &Path, into: &Path) -> Result<String> {
    let own = path.file_name().unwrap_or_default().to_string_lossy();
    let mut name = own.clone().into_owned();
    let mut number = 1;
    while RESERVED.contains(&&*name) || into.join(&name).exists() {
        number += 1;
        name = format!("{number}_{own}");
    }
    fs::copy(path, into.join(&name)).map_err(|source| Error::file(path, source))?;
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_comes_along_and_what_is_written_does_not() {
        let [from, into] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        fs::write(from.path().join(STATE), "state").unwrap();
        for (folder, text) in [("a", "net"), ("b", "more")] {
            fs::create_dir(from.path().join(folder)).unwrap();
            fs::write(from.path().join(folder).join("n&t.xml"), text).unwrap();
        }
        let saved = from.path().join("saved.sumocfg");
        let text = "<c><input><net-file value=\"a/n&amp;t.xml\"/><route-files value=\"b/n&amp;t.xml,a/gone.xml\"/>\
                    <load-state value=\"state.xml.gz\"/></input>\
                    <output><fcd-output value=\"a/n&amp;t.xml\"/></output><time><begin value=\"0\"/><end value=\"9\"/></time>\
                    <report><log value=\"log.txt\"/><no-warnings value=\"true\"/></report></c>";
        fs::write(&saved, text).unwrap();
        let configuration = Configuration::gather(&saved, into.path()).unwrap().with("end", 5.5).without("no-");
        let known = [
            ("net-file", "n&t.xml"),
            ("route-files", "2_n&t.xml,a/gone.xml"),
            ("load-state", "2_state.xml.gz"),
            ("begin", "0"),
            ("end", "5.5"),
        ];
        assert_eq!(configuration.0.iter().map(|set| (&*set.name, &*set.value)).collect::<Vec<_>>(), known);
        assert_eq!(configuration.files(), ["n&t.xml", "2_n&t.xml", "2_state.xml.gz"]);
        assert_eq!(fs::read_to_string(into.path().join("n&t.xml")).unwrap(), "net");
        assert_eq!(fs::read_to_string(into.path().join("2_n&t.xml")).unwrap(), "more");
        let written = into.path().join("written.sumocfg");
        configuration.write(&written).unwrap();
        assert!(fs::read_to_string(written).unwrap().contains("<net-file value=\"n&amp;t.xml\"/>"));
    }
}
