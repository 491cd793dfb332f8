//! Vissim's vehicle record (.fzp): lines of a table after `$VEHICLE:` and the names of its columns. Comments before it have the
//! units.

use std::path::Path;

use super::fcd_row::{FcdWriter, PEDESTRIAN, Sample};
use super::said::Said;
use super::table::maybe_cut;
use crate::util::header;
use crate::util::input_file::{self, next_line};
use crate::{Error, Result};
use closecall::geometry::{Point, Vector};
use closecall::util::limits::LINE;
use closecall::util::units::{Metre, MetrePerSecond};

/// What stands before the names of the columns.
const HEADER: &str = "$VEHICLE:";

/// The columns that matter.
struct Columns {
    time: usize,
    id: usize,
    front: usize,
    rear: usize,
    speed: usize,
    width: Option<usize>,
    kind: Option<usize>,
    /// To m/s.
    speed_unit: MetrePerSecond,
    /// To m.
    place_unit: Metre,
}

/// Turns a file into SUMO's fcd-output; returns what had to be assumed.
pub(super) fn convert(path: &Path, out: &mut FcdWriter) -> Result<Said> {
    let mut columns = None;
    let [mut speed_unit, mut place_unit] = [1.0 / 3.6, 1.0];
    let mut last = f64::NEG_INFINITY;
    let mut source = input_file::open(path)?;
    let mut has_ended = true;
    for number in 1.. {
        let wrong = |message: String| Error::line(path, number, message);
        let line = next_line(&mut source, &LINE).map_err(|error| wrong(error.to_string()))?;
        let Some(line) = line else { break };
        has_ended = line.ends_with('\n');
        if let Some(names) = line.trim_start_matches('\u{feff}').strip_prefix(HEADER) {
            columns = Some(Columns::of(names, speed_unit, place_unit).map_err(wrong)?);
        } else if let Some(columns) = &columns {
            if !line.trim().is_empty() {
                let time = columns.write(&line, out).map_err(wrong)?;
                if time < last {
                    return Err(wrong(format!("SIMSEC {time} follows {last}")));
                }
                last = time;
            }
        } else {
            // A comment such as "* SPEED: Speed, Speed [mph]".
            if line.contains("SPEED") && line.contains("[mph]") {
                speed_unit = 0.447_04;
            }
            if line.contains("COORDFRONT") && line.contains("[ft]") {
                place_unit = 0.3048;
            }
        }
    }
    let Some(columns) = columns else {
        return Err(Error::content(path, "this is not a .fzp file: no line begins with $VEHICLE:"));
    };
    let mut said = Said::default();
    said.missing.push(if columns.kind.is_some() {
        "Vissim's vehicle types 100, 200, 300, 400, 5xx and 6xx are its cars, trucks, buses, trams, pedestrians and bicycles; others \
         are cars"
            .to_owned()
    } else {
        "classes: it has no column VEHTYPE, so all road users are cars".to_owned()
    });
    if columns.width.is_none() {
        said.missing.push("widths: it has no column WIDTH, so they are those of SUMO's classes".to_owned());
    }
    if !has_ended {
        said.doubtful.push(maybe_cut(path));
    }
    Ok(said)
}

impl Columns {
    fn of(names: &str, speed_unit: MetrePerSecond, place_unit: Metre) -> std::result::Result<Self, String> {
        let names = names.split(';').map(|name| name.trim().to_ascii_uppercase()).collect::<Vec<_>>();
        let optional = |name: &str| header::exact(&names, name);
        let place = |name: &str| optional(name)?.ok_or_else(|| format!("it has no column {name}"));
        Ok(Self {
            time: place("SIMSEC")?,
            id: place("NO")?,
            front: place("COORDFRONT")?,
            rear: place("COORDREAR")?,
            speed: place("SPEED")?,
            width: optional("WIDTH")?,
            kind: optional("VEHTYPE")?,
            speed_unit,
            place_unit,
        })
    }

    /// Writes a line; returns its time.
    fn write(&self, line: &str, out: &mut FcdWriter) -> std::result::Result<f64, String> {
        let cells = line.split(';').map(str::trim).collect::<Vec<_>>();
        let cell =
            |place: usize, name: &str| cells.get(place).copied().ok_or_else(|| format!("it has no cell for {name}"));
        let number = |text: &str, name: &str| {
            text.parse::<f64>()
                .ok()
                .filter(|number| number.is_finite())
                .ok_or_else(|| format!("{name} is \"{text}\", not a number"))
        };
        let point = |place: usize, name: &str| {
            let text = cell(place, name)?;
            let mut parts = text.split_whitespace().map(|part| number(part, name));
            match (parts.next(), parts.next()) {
                (Some(x), Some(y)) => {
                    let height = parts.next().transpose()?.unwrap_or_default();
                    Ok((Point::new(x?, y?) * self.place_unit, height * self.place_unit))
                }
                _ => Err(format!("{name} is \"{text}\", not x y z")),
            }
        };
        let time = number(cell(self.time, "SIMSEC")?, "SIMSEC")?;
        let (front, height) = point(self.front, "COORDFRONT")?;
        let (rear, _) = point(self.rear, "COORDREAR")?;
        let ahead: Vector = front - rear;
        if ahead.norm() == 0.0 {
            return Err("COORDFRONT and COORDREAR are at one place, so that nothing tells its heading".to_owned());
        }
        let width = self.width.map(|place| number(cell(place, "WIDTH")?, "WIDTH")).transpose()?;
        out.write(&Sample {
            time,
            id: cell(self.id, "NO")?,
            class: self.kind.map(|place| cell(place, "VEHTYPE")).transpose()?.map_or("passenger", class),
            front,
            height,
            heading: ahead.y.atan2(ahead.x),
            speed: number(cell(self.speed, "SPEED")?, "SPEED")? * self.speed_unit,
            length: ahead.norm(),
            width: width.unwrap_or_default() * self.place_unit,
            lane: None,
        })?;
        Ok(time)
    }
}

/// The class of one of Vissim's own types: "100" or "100: Car".
fn class(kind: &str) -> &'static str {
    match kind.split(':').next().unwrap_or_default().trim().as_bytes() {
        [b'2', _, _] => "truck",
        [b'3', _, _] => "bus",
        [b'4', _, _] => "tram",
        [b'5', _, _] => PEDESTRIAN,
        [b'6', _, _] => "bicycle",
        _ => "passenger",
    }
}
