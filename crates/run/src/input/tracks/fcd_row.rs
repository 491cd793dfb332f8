//! One road user in one step, written as a row of SUMO's fcd-output in CSV; and the types of all of them.

use std::borrow::Cow;
use std::io::{BufWriter, Error as IoError, Write};
use std::sync::Arc;

use quick_xml::escape::escape;
use rustc_hash::FxHashMap;
use tempfile::{NamedTempFile, TempPath};

use super::matching::LaneFinder;
use crate::util::input_file::longer;
use closecall::geometry::Point;
use closecall::traffic::net::LaneIndex;
use closecall::traffic::sumo_type::SumoType;
use closecall::util::limits::{ANGLE, HEIGHT, LENGTH, NAME, POSITION, SPEED, TIME, WIDTH, is_noise, said_of_noise};
use closecall::util::units::{Metre, MetrePerSecond, Radian, Second};

/// One road user in one step.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sample<'a> {
    pub time: Second,
    pub id: &'a str,
    /// SUMO's vehicle class.
    pub class: &'static str,
    /// The middle of its front.
    pub front: Point,
    pub height: Metre,
    /// Counter-clockwise from +x.
    pub heading: Radian,
    pub speed: MetrePerSecond,
    /// 0 where it is not known: that of its class.
    pub length: Metre,
    pub width: Metre,
    /// Its lane, where the recording tells.
    pub lane: Option<LaneIndex>,
}

/// Writes a recording, step by step.
pub(super) struct FcdWriter<'a> {
    fcd: BufWriter<NamedTempFile>,
    lanes: Option<LaneFinder<'a>>,
    /// By name: the vehicle class, length and width.
    types: FxHashMap<String, (&'static str, Metre, Metre)>,
    /// The names of the types by class, and by length and width in bits where they are known.
    kinds: FxHashMap<(&'static str, [Option<u64>; 2]), Arc<str>>,
    row: String,
    /// By id, the last step that has it: those of vehicles and those of persons.
    written: [FxHashMap<String, Second>; 2],
    below_zero: u64,
}

/// The class of persons.
pub(super) const PEDESTRIAN: &str = "pedestrian";

const HEADER: &str = "timestep_time;vehicle_id;vehicle_type;vehicle_x;vehicle_y;vehicle_z;vehicle_angle;vehicle_speed;vehicle_lane;\
    vehicle_pos;person_id;person_type;person_x;person_y;person_z;person_angle;person_speed\n";

impl<'a> FcdWriter<'a> {
    pub fn create(lanes: Option<LaneFinder<'a>>) -> crate::Result<Self> {
        let draft = || {
            let mut fcd = BufWriter::new(tempfile::Builder::new().prefix("closecall-").suffix(".csv").tempfile()?);
            fcd.write_all(HEADER.as_bytes())?;
            Ok(fcd)
        };
        let fcd = draft().map_err(|source: IoError| crate::Error::file(&std::env::temp_dir(), source))?;
        Ok(Self {
            fcd,
            lanes,
            types: FxHashMap::default(),
            kinds: FxHashMap::default(),
            row: String::new(),
            written: Default::default(),
            below_zero: 0,
        })
    }

    /// Appends a road user; those of a step follow each other.
    ///
    /// # Errors
    /// Which value is impossible.
    pub fn write(&mut self, sample: &Sample) -> Result<(), String> {
        let Sample { time, id, class, front, height, heading, mut speed, .. } = *sample;
        if is_noise(speed) {
            speed = 0.0;
            self.below_zero += 1;
        }
        TIME.check("time", time)?;
        POSITION.check("x", front.x)?;
        POSITION.check("y", front.y)?;
        HEIGHT.check("z", height)?;
        SPEED.check("speed", speed)?;
        ANGLE.check("heading", heading)?;
        match id.len() {
            0 => return Err("it has no id".to_owned()),
            length if length > NAME.count() => return Err(longer("its id", &NAME)),
            _ => {}
        }
        let written = &mut self.written[usize::from(class == PEDESTRIAN)];
        match written.get_mut(id) {
            Some(last) if *last == time => return Err("it is there twice".to_owned()),
            Some(last) => *last = time,
            None => _ = written.insert(id.to_owned(), time),
        }
        let kind = self.kind(sample)?;
        let place = if class == PEDESTRIAN {
            None
        } else {
            self.lanes.as_ref().and_then(|lanes| lanes.find(front, heading, sample.lane))
        };
        let (before, after) = if class == PEDESTRIAN { (";;;;;;;;;;", "") } else { (";", ";") };
        let row = &mut self.row;
        row.clear();
        push(row, time);
        row.extend([before, &*quoted(id), ";", &*kind]);
        for number in [front.x, front.y, height, 90.0 - heading.to_degrees(), speed] {
            row.push(';');
            push(row, number);
        }
        row.push_str(after);
        if let Some((lane, position)) = place {
            row.extend([&*quoted(lane), ";"]);
            push(row, position);
            row.push_str(";;;;;;;");
        } else if class != PEDESTRIAN {
            row.push_str(";;;;;;;;");
        }
        row.push('\n');
        self.fcd.write_all(self.row.as_bytes()).map_err(|error| error.to_string())
    }

    /// A line on values that were read differently from the file.
    pub fn remarks(&self) -> Option<String> {
        said_of_noise(self.below_zero)
    }

    /// The name of the type of this class and size.
    fn kind(&mut self, sample: &Sample) -> Result<Arc<str>, String> {
        let sizes =
            [sample.length, sample.width].map(|given| if given == 0.0 { None } else { Some(centimetres(given)) });
        let key = (sample.class, sizes.map(|size| size.map(Metre::to_bits)));
        if let Some(known) = self.kinds.get(&key) {
            return Ok(known.clone());
        }
        let usual = SumoType::of_class("", sample.class);
        let (length, width) = (sizes[0].unwrap_or(usual.length), sizes[1].unwrap_or(usual.width));
        LENGTH.check("length", length)?;
        WIDTH.check("width", width)?;
        let name = format!("{} {length}x{width}", sample.class);
        self.types.entry(name.clone()).or_insert((sample.class, length, width));
        Ok(self.kinds.entry(key).or_insert(name.into()).clone())
    }

    /// Completes the recording and the file of its types.
    pub fn finish(self) -> std::io::Result<(TempPath, TempPath)> {
        let fcd = self.fcd.into_inner().map_err(|error| error.into_error())?.into_temp_path();
        let mut types = tempfile::Builder::new().prefix("closecall-").suffix(".add.xml").tempfile()?;
        let mut text = "<additional>\n".to_owned();
        let mut sorted = self.types.into_iter().collect::<Vec<_>>();
        sorted.sort_by(|a, b| a.0.cmp(&b.0));
        for (name, (class, length, width)) in sorted {
            let name = escape(&name);
            text += &format!("    <vType id=\"{name}\" vClass=\"{class}\" length=\"{length}\" width=\"{width}\"/>\n");
        }
        types.write_all((text + "</additional>\n").as_bytes())?;
        Ok((fcd, types.into_temp_path()))
    }
}

/// A size in whole centimetres.
fn centimetres(size: Metre) -> Metre {
    (size * 100.0).round() / 100.0
}

/// Appends a number with as many digits as tell it from all others.
fn push(text: &mut String, number: f64) {
    text.push_str(zmij::Buffer::new().format_finite(number));
}

/// A text as a cell of the CSV.
fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains([';', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}
