//! Where vehicles stopped, on the road and off it: SUMO's `--stop-output`.

use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

use super::clock;
use super::types::text;
use crate::run::Run;
use crate::util::input_file::{ElementSource, xml_message};
use crate::{Error, Result};
use closecall::util::limits::TIME;
use closecall::util::units::Second;

/// The stops of all vehicles.
#[derive(Default)]
pub(crate) struct RecordedStops {
    /// By id, when each stop on the road began and ended.
    of_vehicles: Stops,
    /// The same of those that parked.
    parked: Stops,
}

type Stops = FxHashMap<String, Vec<[Second; 2]>>;

/// A stop: the vehicle's id, when it began and ended, and whether it parked.
type Stop = (String, [Second; 2], bool);

impl RecordedStops {
    /// Reads the file.
    ///
    /// # Errors
    /// An error that names the file, the line and what is wrong; a file of something else is refused.
    pub fn read(path: &Path) -> Result<Self> {
        let mut reader = Reader::from_reader(ElementSource::open(path)?);
        let (mut buffer, mut stops, mut depth, mut is_of_stops) = (Vec::new(), Self::default(), 0_usize, false);
        loop {
            buffer.clear();
            let line = reader.get_mut().begin_element();
            let wrong = |message: String| Error::line(path, line, message.replace('\n', " "));
            let event = reader.read_event_into(&mut buffer).map_err(|error| wrong(xml_message(&error)))?;
            depth += usize::from(matches!(event, Event::Start(_)));
            match event {
                Event::Start(ref tag) | Event::Empty(ref tag) if tag.name().as_ref() == "stopinfo" => {
                    let (id, times, parks) = stop(tag).map_err(wrong)?;
                    let of = if parks { &mut stops.parked } else { &mut stops.of_vehicles };
                    of.entry(id).or_default().push(times);
                }
                // A run without stops has none to write.
                Event::Start(ref tag) | Event::Empty(ref tag) => is_of_stops |= tag.name().as_ref() == "stops",
                Event::End(_) => depth = depth.saturating_sub(1),
                Event::Eof if depth > 0 => return Err(wrong("the file ends before its elements do".to_owned())),
                Event::Eof if is_of_stops => return Ok(stops),
                Event::Eof => {
                    return Err(Error::content(path, "its root element is not <stops>, as in SUMO's --stop-output"));
                }
                _ => {}
            }
        }
    }

    /// States which of the vehicles that may do so stop in the step under way.
    pub fn show(&self, run: &mut Run, time: Second) {
        if self.of_vehicles.is_empty() {
            return;
        }
        for user in run.standing() {
            if stops_at(&self.of_vehicles, run.roster.id(user), time) {
                run.set_stopped(user);
            }
        }
    }

    /// Whether a vehicle is parked at this time, beside the road or on a parking area.
    pub fn is_parked(&self, id: &str, time: Second) -> bool {
        !self.parked.is_empty() && stops_at(&self.parked, id, time)
    }
}

fn stops_at(stops: &Stops, id: &str, time: Second) -> bool {
    stops.get(id).is_some_and(|stops| stops.iter().any(|[began, ended]| *began <= time && time < *ended))
}

/// The stop that a `<stopinfo>` tells.
fn stop(tag: &BytesStart) -> std::result::Result<Stop, String> {
    let needed = |name: &str| text(tag, name)?.ok_or_else(|| format!("a stopinfo has no {name}"));
    let time = |name: &str| -> std::result::Result<Second, String> {
        let told = needed(name)?;
        let number = clock::time(told.as_bytes()).ok_or_else(|| format!("{name} is \"{told}\", not a time"))?;
        TIME.check(name, number)
    };
    let (id, began, ended) = (needed("id")?, time("started")?, time("ended")?);
    // One that had not ended when the simulation did ends before it began.
    let ended = if ended < began { f64::INFINITY } else { ended };
    Ok((id, [began, ended], needed("parking").is_ok_and(|parking| parking != "0")))
}

#[cfg(test)]
mod tests {
    use crate::input::replay::stops::*;

    fn read(text: &str) -> Result<RecordedStops> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        std::io::Write::write_all(&mut file, text.as_bytes()).unwrap();
        RecordedStops::read(file.path())
    }

    #[test]
    fn stops_off_the_road_are_told_apart() {
        let stops = read(
            r#"<stops><stopinfo id="a" parking="0" started="1" ended="4"/><stopinfo id="b" parking="1" started="1" ended="4"/>
            <stopinfo id="a" parking="0" started="9" ended="-1"/></stops>"#,
        );
        let stops = stops.unwrap();
        let known = &stops.of_vehicles;
        assert_eq!((known.len(), &known["a"][..]), (1, &[[1.0, 4.0], [9.0, f64::INFINITY]][..]));
        let parked = |id, time| stops.is_parked(id, time);
        assert_eq!(
            [parked("b", 0.5), parked("b", 1.0), parked("b", 4.0), parked("a", 2.0)],
            [false, true, false, false]
        );
    }

    #[test]
    fn a_wrong_file_is_named_with_its_fault() {
        for (text, fault) in [
            ("<routes/>", "not <stops>"),
            (r#"<stops><stopinfo id="a" parking="0" started="x" ended="4"/></stops>"#, "line 1: started is \"x\""),
            (r#"<stops><stopinfo id="a" parking="0" ended="4"/></stops>"#, "has no started"),
            ("<stops>", "ends before its elements do"),
        ] {
            let error = read(text).err().unwrap().to_string();
            assert!(error.contains(fault), "{error}");
        }
        assert!(read("<stops/>").unwrap().of_vehicles.is_empty());
    }
}
