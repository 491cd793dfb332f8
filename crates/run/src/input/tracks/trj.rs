//! SSAM's trajectories (.trj), versions 1.04 and 3.0, as Vissim, Aimsun, Paramics, SUMO and closecall write them.
//!
//! FORMAT, DIMENSIONS, then for each step TIMESTEP and a VEHICLE record per vehicle; `output::formats::trajectories` tells
//! more. The file has neither types nor persons: the class follows from the size. Links and lanes are those of closecall's
//! own files where the net has them at the vehicle's place.

use std::io::{BufRead, Read};
use std::path::Path;

use rustc_hash::FxHashMap;

use super::fcd_row::{FcdWriter, Sample};
use super::said::Said;
use crate::output::formats::{FAR, origin_of_trajectories};
use crate::util::decimal::Written;
use crate::util::input_file;
use crate::{Error, Result};
use closecall::geometry::{Point, Vector};
use closecall::traffic::net::{EdgeIndex, LaneIndex, Net};
use closecall::util::units::Metre;

/// The first byte of each record.
const FORMAT: u8 = 0;
const DIMENSIONS: u8 = 1;
const TIMESTEP: u8 = 2;
const VEHICLE: u8 = 3;
/// The units of DIMENSIONS that are feet.
const ENGLISH: u8 = 0;
const FOOT: Metre = 0.3048;
/// From this version on, the first record has a byte that tells whether places have heights.
const WITH_HEIGHTS: f32 = 2.0;
/// A longer vehicle counts as a truck, in m.
const TRUCK: Metre = 6.5;
/// A narrower one counts as a bicycle, in m.
const NARROW: Metre = 1.2;

/// Whether a file begins as one of these does.
pub(super) fn is_trj(first: &[u8]) -> bool {
    matches!(first, [FORMAT, b'L' | b'B', ..])
}

/// The file as it is read.
struct Reader<'a> {
    path: &'a Path,
    source: Box<dyn BufRead + Send>,
    is_little: bool,
    /// Bytes read so far.
    at: u64,
}

/// Turns a file into SUMO's fcd-output; returns what had to be assumed.
pub(super) fn convert(path: &Path, net: Option<&Net>, out: &mut FcdWriter) -> Result<Said> {
    let mut reader = Reader { path, source: input_file::open(path)?, is_little: true, at: 0 };
    let has_heights = reader.format()?;
    let mut unit = 1.0;
    let mut scale = 1.0;
    let mut time = None;
    let mut ids: FxHashMap<i32, String> = FxHashMap::default();
    let origin = net.map_or(Vector::zeros(), origin_of_trajectories);
    while let Some(kind) = reader.kind()? {
        match kind {
            DIMENSIONS => {
                unit = if reader.byte()? == ENGLISH { FOOT } else { 1.0 };
                scale = f64::from(reader.float()?);
                if !(scale.is_finite() && scale > 0.0) {
                    return Err(reader.wrong(format!("its scale is {scale}, it must be above 0")));
                }
                let [_, _, _, _] = [reader.int()?, reader.int()?, reader.int()?, reader.int()?];
            }
            TIMESTEP => {
                // The shortest decimals of 32 bits are those that the simulation wrote.
                let now = shortest(reader.float()?);
                if time.is_some_and(|before| now <= before) {
                    return Err(reader.wrong(format!(
                        "time {} s follows {} s",
                        Written(now),
                        Written(time.unwrap_or_default())
                    )));
                }
                time = Some(now);
            }
            VEHICLE => {
                let Some(time) = time else { return Err(reader.wrong("a vehicle comes before the first time step")) };
                let number = reader.int()?;
                let link = reader.int()?;
                let lane = reader.byte()?;
                let [front_x, front_y, rear_x, rear_y] = reader.floats()?.map(|it: f64| it * unit * scale);
                let [length, width, speed, _] = reader.floats()?.map(|it: f64| it * unit);
                let heights = if has_heights { [reader.float()?, reader.float()?] } else { [0.0; 2] };
                let front = Point::new(front_x, front_y);
                // closecall's own places are relative to a far net's corner; others are those of the net.
                let front = if front.coords.amax() <= FAR { front + origin } else { front };
                let ahead = Vector::new(front_x - rear_x, front_y - rear_y);
                if ahead.norm() == 0.0 {
                    return Err(reader.wrong(format!("vehicle {number}: front and rear are at one place")));
                }
                let id = ids.entry(number).or_insert_with(|| number.to_string());
                let written = out.write(&Sample {
                    time,
                    id,
                    class: class(length, width),
                    front,
                    height: shortest(heights[0]) * unit,
                    heading: ahead.y.atan2(ahead.x),
                    speed,
                    length,
                    width,
                    lane: net.and_then(|net| told(net, link, lane)),
                });
                written.map_err(|why| reader.wrong(format!("vehicle {number} at {} s: {why}", Written(time))))?;
            }
            other => return Err(reader.wrong(format!("a record begins with {other}; 1, 2 and 3 are known"))),
        }
    }
    let types = "the format has no types: vehicles longer than 6.5 m are trucks, those narrower than 1.2 m bicycles";
    Ok(Said { missing: vec![types.to_owned()], ..Said::default() })
}

/// The lane of a link and number, as closecall writes them.
fn told(net: &Net, link: i32, lane: u8) -> Option<LaneIndex> {
    let edge = net.edges.get(EdgeIndex(u32::try_from(link).ok()?))?;
    edge.lanes.get(usize::from(lane)).copied()
}

fn class(length: Metre, width: Metre) -> &'static str {
    match () {
        () if length > TRUCK => "truck",
        () if width < NARROW => "bicycle",
        () => "passenger",
    }
}

/// The number with the fewest decimals that 32 bits hold as this one.
fn shortest(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::NAN)
}

impl Reader<'_> {
    /// Reads the first record; whether places have heights.
    fn format(&mut self) -> Result<bool> {
        if self.kind()? != Some(FORMAT) {
            return Err(Error::content(self.path, "this is not a .trj file: its first byte is not 0"));
        }
        self.is_little = match self.byte()? {
            b'L' => true,
            b'B' => false,
            _ => return Err(self.wrong("this is not a .trj file: its second byte is neither L nor B")),
        };
        let version = self.float()?;
        if !(1.0..4.0).contains(&version) {
            return Err(self.wrong(format!("its version is {version}; 1.04 and 3.0 are known")));
        }
        Ok(version >= WITH_HEIGHTS && self.byte()? != 0)
    }

    /// The first byte of the next record; none at the end.
    fn kind(&mut self) -> Result<Option<u8>> {
        let is_over = self.source.fill_buf().map(<[u8]>::is_empty);
        if is_over.map_err(|source| Error::file(self.path, source))? { Ok(None) } else { self.byte().map(Some) }
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes).map_err(|source| match source.kind() {
            std::io::ErrorKind::UnexpectedEof => self.wrong("it is cut short within a record"),
            _ => Error::file(self.path, source),
        })?;
        self.at += N as u64;
        Ok(bytes)
    }

    fn byte(&mut self) -> Result<u8> {
        Ok(self.bytes::<1>()?[0])
    }

    fn int(&mut self) -> Result<i32> {
        let bytes = self.bytes()?;
        Ok(if self.is_little { i32::from_le_bytes(bytes) } else { i32::from_be_bytes(bytes) })
    }

    fn float(&mut self) -> Result<f32> {
        self.int().map(|bits| f32::from_bits(bits as u32))
    }

    fn floats<const N: usize>(&mut self) -> Result<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = shortest(self.float()?);
        }
        Ok(numbers)
    }

    fn wrong(&self, message: impl Into<String>) -> Error {
        Error::content(self.path, format!("byte {}: {}", self.at, message.into()))
    }
}
