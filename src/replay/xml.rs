//! fcd-output in XML.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::recording::{Step, in_order};
use crate::net::LineCounter;
use crate::units::Second;
use crate::{Error, Result};

/// An `<fcd-export>` that is being read.
pub struct XmlRecording {
    path: PathBuf,
    reader: Reader<LineCounter>,
    buffer: Vec<u8>,
    last: Option<Second>,
}

impl XmlRecording {
    pub(super) fn new(path: &Path, source: Box<dyn BufRead>) -> Result<Self> {
        let mut recording = Self {
            path: path.to_owned(),
            reader: Reader::from_reader(LineCounter::new(source)),
            buffer: Vec::new(),
            last: None,
        };
        loop {
            recording.buffer.clear();
            match recording.reader.read_event_into(&mut recording.buffer) {
                Ok(Event::Start(tag)) if tag.name().as_ref() == "fcd-export" => return Ok(recording),
                Ok(Event::Start(_) | Event::Empty(_)) => {
                    return Err(Error::content(path, "it is no fcd-output: its root element is not <fcd-export>"));
                }
                Ok(Event::Eof) => return Err(Error::content(path, "it is no fcd-output: there is no <fcd-export>")),
                Ok(_) => {}
                Err(error) => return Err(Error::content(path, error.to_string().replace('\n', " "))),
            }
        }
    }

    pub(super) fn next_step(&mut self, step: &mut Step) -> Result<bool> {
        let mut inside = false;
        loop {
            self.buffer.clear();
            let line = self.reader.get_ref().line();
            let event = match self.reader.read_event_into(&mut self.buffer) {
                Ok(event) => event,
                Err(error) => return Err(cut_short(&self.path, self.last, error.to_string())),
            };
            let wrong = |message: String| Error::line(&self.path, line, message);
            match event {
                Event::Start(tag) if tag.name().as_ref() == "timestep" => {
                    begin(&tag, self.last, step).map_err(wrong)?;
                    inside = true;
                }
                Event::Empty(tag) if tag.name().as_ref() == "timestep" => {
                    begin(&tag, self.last, step).map_err(wrong)?;
                    self.last = Some(step.time);
                    return Ok(true);
                }
                Event::End(tag) if tag.name().as_ref() == "timestep" => {
                    self.last = Some(step.time);
                    return Ok(true);
                }
                Event::Start(tag) | Event::Empty(tag) if inside => add(&tag, step).map_err(wrong)?,
                Event::End(tag) if tag.name().as_ref() == "fcd-export" => return Ok(false),
                Event::Eof => {
                    return Err(cut_short(&self.path, self.last, "the file ends before </fcd-export>".to_owned()));
                }
                _ => {}
            }
        }
    }
}

fn cut_short(path: &Path, last: Option<Second>, message: String) -> Error {
    Error::CutShort { path: path.to_owned(), time: last.unwrap_or(f64::NAN), message: message.replace('\n', " ") }
}

fn begin(tag: &BytesStart, last: Option<Second>, step: &mut Step) -> std::result::Result<(), String> {
    let attribute = tag.try_get_attribute("time").map_err(|error| error.to_string())?;
    let attribute = attribute.ok_or("a timestep without time")?;
    let time = attribute.value.parse::<f64>().map_err(|_| format!("time is \"{}\"", attribute.value))?;
    in_order(last, time)?;
    step.begin(time);
    Ok(())
}

fn add(tag: &BytesStart, step: &mut Step) -> std::result::Result<(), String> {
    let person = match tag.name().as_ref() {
        "vehicle" => false,
        "person" => true,
        _ => return Ok(()),
    };
    let row = step.add();
    row.person = person;
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|error| error.to_string())?;
        let value = attribute.value.as_ref();
        if value.contains('&') {
            let value = quick_xml::escape::unescape(value).map_err(|error| error.to_string())?;
            row.set(attribute.key.as_ref(), &value)?;
        } else {
            row.set(attribute.key.as_ref(), value)?;
        }
    }
    match row.missing() {
        Some(missing) => Err(format!("\"{}\" has no attribute {missing}", row.id)),
        None => Ok(()),
    }
}
