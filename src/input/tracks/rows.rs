//! Tables of trajectories, in any order of their rows: sorted by road user, so that headings and speeds that they lack follow
//! from how each moved, then by time. Memory does not grow with their number.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use rustc_hash::FxHashMap;

use super::jumps::Jumps;
use super::layouts::hint;
use super::mapping::{Field, Mapping, Origin};
use super::meta::read_meta;
use super::sample::{FcdWriter, PEDESTRIAN, Sample};
use super::smooth::Smoother;
use super::spill::{Order, Row, Sorted, Sorter};
use super::table::{self, Cell};
use crate::geometry::Point;
use crate::geometry::rectangle::direction;
use crate::traffic::sumo_type::SumoType;
use crate::util::units::{Metre, MetrePerSecond};
use crate::{Error, Result};

/// A road user that moves less than this between the steps before and after keeps its heading, in m: noise would turn it.
const MOVED: Metre = 0.2;
/// Below this the direction of a velocity is noise, in m/s.
const MOVES: MetrePerSecond = 0.1;
/// Classes that a remark names.
const NAMED: usize = 5;

/// What the names of classes in public data mean; other names are cars.
const CLASSES: [(&str, &str); 27] = [
    ("car", "passenger"),
    ("passenger", "passenger"),
    ("vehicle", "passenger"),
    ("auto", "passenger"),
    ("van", "passenger"),
    ("suv", "passenger"),
    ("mv", "passenger"),
    ("truck", "truck"),
    ("lorry", "truck"),
    ("hgv", "truck"),
    ("truck_bus", "truck"),
    ("trailer", "trailer"),
    ("bus", "bus"),
    ("tram", "tram"),
    ("motorcycle", "motorcycle"),
    ("motorcyclist", "motorcycle"),
    ("motorbike", "motorcycle"),
    ("moped", "moped"),
    ("bicycle", "bicycle"),
    ("bicyclist", "bicycle"),
    ("cyclist", "bicycle"),
    ("bike", "bicycle"),
    ("tricycle", "bicycle"),
    ("pedestrian", PEDESTRIAN),
    ("person", PEDESTRIAN),
    ("pedestrian/bicycle", PEDESTRIAN),
    ("animal", PEDESTRIAN),
];

/// What is known of the road users beside their rows.
#[derive(Default)]
struct Users {
    ids: Vec<String>,
    numbers: FxHashMap<String, u32>,
    /// By the number that a row has: SUMO's class.
    classes: Vec<&'static str>,
    /// By id, from the file beside the table.
    class_of: FxHashMap<String, String>,
    /// The first [`NAMED`] unknown names of classes.
    unknown: Vec<String>,
}

impl Users {
    fn number(&mut self, id: &str) -> u32 {
        if let Some(known) = self.numbers.get(id) {
            return *known;
        }
        let number = self.ids.len() as u32;
        self.ids.push(id.to_owned());
        self.numbers.insert(id.to_owned(), number);
        number
    }

    fn class(&mut self, name: &str, mapping: &Mapping) -> u32 {
        let lower = name.to_lowercase();
        let known = mapping.classes.iter().chain(&CLASSES).find(|(known, _)| *known == lower);
        let is_new = || !name.is_empty() && !self.unknown.iter().any(|unknown| unknown == name);
        if known.is_none() && self.unknown.len() < NAMED && is_new() {
            self.unknown.push(name.to_owned());
        }
        let class = known.map_or("passenger", |(_, class)| class);
        let place = self.classes.iter().position(|known| *known == class).unwrap_or_else(|| {
            self.classes.push(class);
            self.classes.len() - 1
        });
        place as u32
    }
}

/// Turns a table into SUMO's fcd-output, smoothed if its places have this noise; returns what had to be assumed.
pub(super) fn convert(
    path: &Path,
    mapping: &Mapping,
    noise: Option<Metre>,
    out: &mut FcdWriter,
) -> Result<Vec<String>> {
    let mut users = Users::default();
    let mut frame_rate = mapping.frame_rate;
    if mapping.has_meta {
        let meta = read_meta(path)?;
        frame_rate = frame_rate.or(meta.frame_rate);
        users.class_of = meta.class_of;
    }
    let by_user = read(path, mapping, frame_rate, &mut users)?;
    let fault = |source| Error::file(path, source);
    let mut steps = Sorter::new(Order::Steps);
    let (mut smoother, mut jumps, mut derived) = (Smoother::new(noise), Jumps::default(), [0, 0]);
    let complete = |track: &mut [Row]| {
        let added = smoother.smooth(track, |jump| jumps.add(jump));
        derived = [0, 1].map(|of| derived[of] + added[of]);
        complete(track, &mut derived);
        track.iter().try_for_each(|row| steps.push(*row))
    };
    each_track(by_user, complete).map_err(fault)?;
    let mut steps = steps.sorted().map_err(fault)?;
    while let Some(Row { user, class, time, values: [x, y, heading, speed, length, width] }) =
        steps.next().map_err(fault)?
    {
        let id = users.ids.get(user as usize).map_or("", String::as_str);
        let class = users.classes.get(class as usize).copied().unwrap_or("passenger");
        let length = if length > 0.0 { length } else { SumoType::of_class("", class).length };
        let place = Point::new(x, y);
        let front = if mapping.origin == Origin::Front { place } else { place + direction(heading) * (length / 2.0) };
        let written =
            out.write(&Sample { time, id, class, front, height: 0.0, heading, speed, length, width, lane: None });
        written.map_err(|why| Error::content(path, format!("\"{id}\" at {time} s: {why}")))?;
    }
    let id = |user: u32| users.ids.get(user as usize).map_or("", String::as_str);
    Ok(remarks(&users, derived).into_iter().chain(jumps.remarks(id)).collect())
}

fn remarks(users: &Users, [headings, speeds]: [u64; 2]) -> Vec<String> {
    let mut remarks = Vec::new();
    if headings > 0 {
        remarks.push(format!("headings: {headings} rows have none, so they follow from how the road user moved"));
    }
    if speeds > 0 {
        remarks.push(format!("speeds: {speeds} rows have none, so they follow from how far the road user moved"));
    }
    if !users.unknown.is_empty() {
        let named = users.unknown.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        remarks.push(format!("classes: {named} are unknown, so they are cars"));
    }
    remarks
}

/// Reads the rows, sorted by road user.
fn read(path: &Path, mapping: &Mapping, frame_rate: Option<f64>, users: &mut Users) -> Result<Sorted> {
    let mut sorter = Sorter::new(Order::Users);
    let places = std::cell::Cell::new([None; Field::COUNT]);
    let begin = |names: &[String]| {
        let found = mapping.places(names).map_err(|why| why + &hint(names))?;
        if found[Field::Time as usize].is_none() && frame_rate.is_none() {
            return Err("its time is a number of frames: --frame-rate HZ is needed".to_owned());
        }
        places.set(found);
        Ok(())
    };
    table::read(path, begin, |cells| {
        let reader = RowReader { mapping, places: places.get(), cells };
        let row = reader.row(frame_rate, users)?;
        sorter.push(row).map_err(|error| error.to_string())
    })?;
    if users.ids.is_empty() {
        return Err(Error::content(path, "it has no rows"));
    }
    sorter.sorted().map_err(|source| Error::file(path, source))
}

/// One row of the table.
struct RowReader<'a> {
    mapping: &'a Mapping,
    places: [Option<(usize, f64)>; Field::COUNT],
    cells: &'a [Cell<'a>],
}

impl RowReader<'_> {
    fn cell(&self, field: Field) -> Option<(&Cell<'_>, f64)> {
        let (place, factor) = self.places[field as usize]?;
        Some((self.cells.get(place)?, factor))
    }

    fn text(&self, field: Field) -> Cow<'_, str> {
        self.cell(field).map_or(Cow::Borrowed(""), |(cell, _)| cell.text())
    }

    /// The number in SI units; none where there is none.
    fn number(&self, field: Field) -> std::result::Result<Option<f64>, String> {
        let Some((cell, factor)) = self.cell(field) else { return Ok(None) };
        let number = cell.number().map_err(|why| format!("column {}: {why}", self.name(field)))?;
        Ok(number.map(|number| number * factor))
    }

    fn needed(&self, field: Field) -> std::result::Result<f64, String> {
        self.number(field)?.ok_or_else(|| format!("column {}: a number is needed, but it is empty", self.name(field)))
    }

    fn name(&self, field: Field) -> &str {
        self.mapping.fields.iter().find(|known| known.field == field).map_or("", |known| &known.name)
    }

    fn row(&self, frame_rate: Option<f64>, users: &mut Users) -> std::result::Result<Row, String> {
        let id = self.text(Field::Id);
        if id.is_empty() {
            return Err(format!("column {}: an id is needed, but it is empty", self.name(Field::Id)));
        }
        let time = match frame_rate {
            _ if self.places[Field::Time as usize].is_some() => self.needed(Field::Time)?,
            rate => self.needed(Field::Frame)? / rate.unwrap_or(1.0),
        };
        // Sums of steps: a millionth of a second tells them apart.
        let time = (time * 1e6).round() / 1e6;
        let class = match users.class_of.get(&*id).cloned() {
            Some(class) => users.class(&class, self.mapping),
            None => users.class(&self.text(Field::Class), self.mapping),
        };
        let up = if self.mapping.is_picture { -1.0 } else { 1.0 };
        let mut place = Point::new(self.needed(Field::X)?, up * self.needed(Field::Y)?);
        let [mut length, width] =
            [self.number(Field::Length)?, self.number(Field::Width)?].map(Option::unwrap_or_default);
        let velocity = self.number(Field::SpeedX)?.zip(self.number(Field::SpeedY)?).map(|(x, y)| (x, up * y));
        let mut heading = self.number(Field::Heading)?.map(|angle| match self.mapping.is_compass {
            true => FRAC_PI_2 - angle,
            false => up * angle,
        });
        if let Some((rear_x, rear_y)) = self.number(Field::RearX)?.zip(self.number(Field::RearY)?) {
            let ahead = place - Point::new(rear_x, up * rear_y);
            if ahead.norm() > 0.0 {
                heading = Some(ahead.y.atan2(ahead.x));
                length = if length > 0.0 { length } else { ahead.norm() };
            }
        }
        if self.mapping.origin == Origin::UpperLeft {
            place += crate::geometry::Vector::new(length, up * width) / 2.0;
            heading = velocity.map(|(x, _)| if x < 0.0 { PI } else { 0.0 });
        }
        let of_velocity = velocity.filter(|(x, y)| x.hypot(*y) > MOVES).map(|(x, y)| y.atan2(x));
        let heading = heading.or(of_velocity).unwrap_or(f64::NAN);
        let speed = self.number(Field::Speed)?.or(velocity.map(|(x, y)| x.hypot(y))).unwrap_or(f64::NAN);
        let user = users.number(&id);
        Ok(Row { user, class, time, values: [place.x, place.y, heading, speed, length, width] })
    }
}

/// Calls `with` for one track after the other.
fn each_track(mut rows: Sorted, mut with: impl FnMut(&mut [Row]) -> std::io::Result<()>) -> std::io::Result<()> {
    let mut track: Vec<Row> = Vec::new();
    loop {
        let next = rows.next()?;
        if track.first().is_some_and(|first| next.is_none_or(|next| next.user != first.user)) {
            with(&mut track)?;
            track.clear();
        }
        match next {
            Some(row) => track.push(row),
            None => return Ok(()),
        }
    }
}

/// Derives the headings and speeds that the rows of a track, in the order of time, lack.
fn complete(track: &mut [Row], derived: &mut [u64; 2]) {
    let places = track.iter().map(|row| (row.time, Point::new(row.values[0], row.values[1]))).collect::<Vec<_>>();
    let moved = |number: usize| {
        let (from, to) = (number.saturating_sub(1), (number + 1).min(places.len() - 1));
        (places[to].0 - places[from].0, places[to].1 - places[from].1)
    };
    let mut heading = f64::NAN;
    let mut waiting = 0;
    for (number, Row { values, .. }) in track.iter_mut().enumerate() {
        let (lasted, way) = moved(number);
        if values[2].is_nan() {
            derived[0] += 1;
            values[2] = if way.norm() >= MOVED { way.y.atan2(way.x) } else { heading };
        }
        if values[3].is_nan() {
            derived[1] += 1;
            values[3] = if lasted > 0.0 { way.norm() / lasted } else { 0.0 };
        }
        heading = values[2];
        if heading.is_nan() {
            waiting = number + 1;
        }
    }
    // Those that stood at first head where they went then; one that never moved heads along +x.
    let first = track.get(waiting).map_or(0.0, |row| row.values[2]);
    track[..waiting].iter_mut().for_each(|row| row.values[2] = first);
}
