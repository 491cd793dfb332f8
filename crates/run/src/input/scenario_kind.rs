//! What a file of SUMO is, by its first element, and what to pass where it is passed as a scenario.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::Event;

use super::sumo_files::files_of;
use crate::util::input_file::ElementSource;
use crate::{Error, Result};

/// A file of SUMO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumoFile {
    /// A configuration: what a scenario is.
    Configuration,
    /// A net.
    Net,
    /// Routes, or the demand.
    Routes,
    /// An additional file.
    Additional,
    /// A recording: fcd-output.
    Recording,
}

impl SumoFile {
    /// What a file is by its first element; none of all others, and where that cannot be read.
    pub fn of(path: &Path) -> Option<Self> {
        match first_element(path)?.as_str() {
            "configuration" | "sumoConfiguration" => Some(Self::Configuration),
            "net" => Some(Self::Net),
            "routes" => Some(Self::Routes),
            "additional" => Some(Self::Additional),
            "fcd-export" => Some(Self::Recording),
            _ => None,
        }
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Configuration => "a SUMO configuration",
            Self::Net => "a SUMO net",
            Self::Routes => "a SUMO route file",
            Self::Additional => "a SUMO additional file",
            Self::Recording => "a recording (fcd-output)",
        }
    }

    /// What to do with such a file: the command, or the configuration beside it that names it.
    pub fn advice(self, path: &Path) -> String {
        let file = path.display();
        match (self, &configurations_with(path)[..]) {
            (Self::Configuration, _) => format!("closecall run {file}"),
            (Self::Recording, _) => format!("closecall replay {file} --net NET"),
            (_, [only]) => format!("closecall run {}, which names it", only.display()),
            (_, [first, others @ ..]) => {
                format!("closecall run {}, one of {} .sumocfg that name it", first.display(), others.len() + 1)
            }
            (_, []) => "closecall run takes the .sumocfg that names it; sumo -n NET -r ROUTES --save-configuration \
                        NEW.sumocfg writes one"
                .to_owned(),
        }
    }
}

/// Refuses a file of SUMO that a scenario names, but is not.
///
/// # Errors
/// [`Error::Content`] that says what the file is and what to pass.
pub fn check_is_scenario(path: &Path) -> Result<()> {
    refuse(path, "not a configuration", |file| file != SumoFile::Configuration)
}

/// Refuses a file of SUMO other than a recording.
///
/// # Errors
/// [`Error::Content`] that says what the file is and what to pass.
pub fn check_is_recording(path: &Path) -> Result<()> {
    refuse(path, "not a recording", |file| file != SumoFile::Recording)
}

fn refuse(path: &Path, why: &str, is_wrong: impl FnOnce(SumoFile) -> bool) -> Result<()> {
    match SumoFile::of(path) {
        Some(file) if is_wrong(file) => {
            Err(Error::content(path, format!("it is {}, {why}: {}", file.name(), file.advice(path))))
        }
        _ => Ok(()),
    }
}

/// The name of the first element of an XML file.
fn first_element(path: &Path) -> Option<String> {
    let mut source = ElementSource::open(path).ok()?;
    // A table would be read to its end in search of an element.
    let text = String::from_utf8_lossy(source.fill_buf().ok()?).into_owned();
    if !text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return None;
    }
    let mut reader = Reader::from_reader(source);
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        reader.get_mut().begin_element();
        match reader.read_event_into(&mut buffer).ok()? {
            Event::Start(tag) | Event::Empty(tag) => return Some(tag.name().as_ref().to_owned()),
            Event::Eof => return None,
            _ => {}
        }
    }
}

/// The configurations in the folder of a file that name it, by name.
fn configurations_with(path: &Path) -> Vec<PathBuf> {
    let same = |other: &Path| Some((other.canonicalize().ok()?, path.canonicalize().ok()?));
    let names_it = |configuration: &PathBuf| {
        let files = files_of(configuration).unwrap_or_default();
        files.iter().any(|(_, file)| same(file).is_some_and(|(one, other)| one == other))
    };
    beside(path).unwrap_or_default().into_iter().filter(names_it).collect()
}

/// The configurations in the folder of a file.
fn beside(path: &Path) -> std::io::Result<Vec<PathBuf>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let listed = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(listed)? {
        let path = folder.join(entry?.file_name());
        if path.extension().is_some_and(|extension| extension == "sumocfg") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_net_names_the_configuration_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let net = folder.path().join("a.net.xml");
        std::fs::write(&net, "<?xml version=\"1.0\"?>\n<!-- made -->\n<net version=\"1.20\">\n</net>").unwrap();
        assert_eq!(SumoFile::of(&net), Some(SumoFile::Net));
        let message = check_is_scenario(&net).unwrap_err().to_string();
        assert!(message.contains("it is a SUMO net, not a configuration") && message.contains("--save-configuration"));
        let configuration = folder.path().join("a.sumocfg");
        std::fs::write(&configuration, "<configuration><net-file value=\"a.net.xml\"/></configuration>").unwrap();
        assert!(check_is_scenario(&configuration).is_ok());
        let message = check_is_recording(&net).unwrap_err().to_string();
        assert!(message.ends_with(&format!("closecall run {}, which names it", configuration.display())), "{message}");
    }
}
