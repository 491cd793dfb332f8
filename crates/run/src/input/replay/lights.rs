//! What the traffic lights showed: SUMO's output of a `timedEvent` of type SaveTLSStates or SaveTLSSwitchStates.

use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use super::clock;
use super::types::text;
use crate::run::Run;
use crate::util::input_file::{ElementSource, xml_message};
use crate::{Error, Result};
use closecall::traffic::net::Net;
use closecall::util::limits::TIME;
use closecall::util::units::Second;

/// The states of traffic lights, read as far as the replay has come.
pub struct RecordedLights {
    path: PathBuf,
    reader: Reader<ElementSource>,
    buffer: Vec<u8>,
    /// The numbers of the net's traffic lights, by id.
    lights: FxHashMap<String, u32>,
    /// Elements that have begun and not ended.
    depth: usize,
    /// The first state that is later than the step.
    next: Option<LightState>,
}

/// What a traffic light shows from a time on.
struct LightState {
    time: Second,
    light: u32,
    letters: String,
}

impl RecordedLights {
    /// Opens the file and reads its first state.
    ///
    /// # Errors
    /// An error that names the file, the line and what is wrong; a file that knows no traffic light of the net is refused.
    pub fn open(path: &Path, net: &Net) -> Result<Self> {
        let reader = Reader::from_reader(ElementSource::open(path)?);
        let lights = net.lights.iter().zip(0..).map(|(id, light)| (id.clone(), light)).collect();
        let mut opened = Self { path: path.to_owned(), reader, buffer: Vec::new(), lights, depth: 0, next: None };
        opened.next = opened.read()?;
        match opened.next {
            Some(_) => Ok(opened),
            None => Err(Error::content(path, "it has no <tlsState> of a traffic light of the net")),
        }
    }

    /// States what the traffic lights show in the step under way.
    ///
    /// # Errors
    /// An error that names the file, the line and what is wrong.
    pub fn show(&mut self, run: &mut Run, time: Second) -> Result<()> {
        while let Some(state) = self.next.take_if(|state| state.time <= time) {
            run.set_signal(state.light, &state.letters);
            self.next = self.read()?;
        }
        Ok(())
    }

    /// Reads the next state of a light that the net has; none at the end of the file.
    fn read(&mut self) -> Result<Option<LightState>> {
        loop {
            self.buffer.clear();
            let line = self.reader.get_mut().begin_element();
            let wrong = |message: String| Error::line(&self.path, line, message.replace('\n', " "));
            let event = self.reader.read_event_into(&mut self.buffer).map_err(|error| wrong(xml_message(&error)))?;
            self.depth += usize::from(matches!(event, Event::Start(_)));
            match event {
                Event::Start(ref tag) | Event::Empty(ref tag) if tag.name().as_ref() == "tlsState" => {
                    let state = state(tag, &self.lights).map_err(wrong)?;
                    if state.is_some() {
                        return Ok(state);
                    }
                }
                Event::End(_) => self.depth = self.depth.saturating_sub(1),
                // The last states would hold for ever.
                Event::Eof if self.depth > 0 => return Err(wrong("the file ends before its elements do".to_owned())),
                Event::Eof => return Ok(None),
                _ => {}
            }
        }
    }
}

/// The state that a `<tlsState>` tells; none if the net does not have its light.
fn state(tag: &BytesStart, lights: &FxHashMap<String, u32>) -> std::result::Result<Option<LightState>, String> {
    let needed = |name: &str| text(tag, name)?.ok_or_else(|| format!("a tlsState has no {name}"));
    let (id, time, letters) = (needed("id")?, needed("time")?, needed("state")?);
    let number = clock::time(time.as_bytes()).ok_or_else(|| format!("time is \"{time}\", not a time"))?;
    let time = TIME.check("time", number)?;
    Ok(lights.get(&id).map(|light| LightState { time, light: *light, letters }))
}

#[cfg(test)]
mod tests {
    use crate::input::replay::lights::*;

    const NET: &str = r#"<net><edge id="e" from="a" to="b"><lane id="e_0" length="9" shape="0,0 9,0"/></edge>
        <edge id="f" from="b" to="c"><lane id="f_0" length="9" shape="9,0 18,0"/></edge>
        <connection from="e" to="f" fromLane="0" toLane="0" tl="J" linkIndex="0"/></net>"#;

    fn opened(text: &str) -> Result<RecordedLights> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        std::io::Write::write_all(&mut file, text.as_bytes()).unwrap();
        RecordedLights::open(file.path(), &crate::net::parse(Path::new("net"), NET).unwrap())
    }

    #[test]
    fn states_of_other_lights_are_skipped() {
        let text =
            r#"<tlsStates><tlsState time="0" id="K" state="r"/><tlsState time="2" id="J" state="Gr"/></tlsStates>"#;
        let first = opened(text).unwrap().next.unwrap();
        assert_eq!((first.time, first.light, &*first.letters), (2.0, 0, "Gr"));
    }

    #[test]
    fn a_wrong_file_is_named_with_its_fault() {
        for (text, fault) in [
            ("<tlsStates/>", "no <tlsState> of a traffic light"),
            (r#"<tlsState time="x" id="J" state="G"/>"#, "line 1: time is \"x\""),
            (r#"<tlsState time="1" id="J"/>"#, "has no state"),
            (r#"<tlsStates><tlsState time="1" id="K" state="r"/>"#, "ends before its elements do"),
        ] {
            let error = opened(text).err().unwrap().to_string();
            assert!(error.contains(fault), "{error}");
        }
    }
}
