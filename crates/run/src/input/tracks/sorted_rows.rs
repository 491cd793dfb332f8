//! Tables of trajectories, in any order of their rows, one file or several of one time base: sorted by road user, so that headings
//! and speeds that they lack follow from how each moved, then by time. Memory does not grow with their number.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::path::Path;

use super::by_track::Tracks;
use super::fcd_row::{FcdWriter, Sample};
use super::field::Field;
use super::layouts::hint;
use super::mapped_table::Table;
use super::mapping::{Origin, Places};
use super::meta::{Meta, name_beside, read_meta};
use super::said::Said;
use super::spill::{Order, Row, Sorted, Sorter};
use super::table::{self, Cell};
use super::users::Users;
use crate::util::decimal::Written;
use crate::{Error, Result};
use closecall::geometry::rectangle::direction;
use closecall::geometry::{Point, Vector};
use closecall::traffic::sumo_type::SumoType;
use closecall::util::units::{Metre, MetrePerSecond};

/// Below this the direction of a velocity is noise, in m/s.
const MOVES: MetrePerSecond = 0.1;
/// Rows after which a wish to stop is asked for.
const ASKED: u64 = 4096;

/// Turns tables into SUMO's fcd-output, smoothed if their places have this noise; returns what had to be assumed.
pub(super) fn convert(
    tables: &[Table],
    noise: Option<Metre>,
    stopped: &mut dyn FnMut() -> bool,
    out: &mut FcdWriter,
) -> Result<Said> {
    let mut users = Users::default();
    let mut said = Said::default();
    let path = tables.first().map_or(Path::new(""), |table| table.path);
    let fault = |source| Error::file(path, source);
    let mut by_user = read(tables, &mut users, &mut said, stopped)?;
    let mut tracks = Tracks::new(tables, noise);
    let mut rows = 0;
    while let Some(row) = by_user.next().map_err(fault)? {
        tracks.add(row, &mut users).map_err(fault)?;
        ask(&mut rows, stopped)?;
    }
    let mut steps = tracks.finish(&mut users).map_err(fault)?;
    let origin = tables.first().map_or(Origin::default(), |table| table.mapping.origin);
    while let Some(row) = steps.next().map_err(fault)? {
        let Row { user, class, time, values: [x, y, _, speed, length, width] } = row;
        let heading = tracks.heading(&row);
        let (id, class) = (users.id(user), users.class_name(class));
        let length = if length > 0.0 { length } else { SumoType::of_class("", class).length };
        let place = Point::new(x, y);
        let front = if origin == Origin::Front { place } else { place + direction(heading) * (length / 2.0) };
        let written =
            out.write(&Sample { time, id, class, front, height: 0.0, heading, speed, length, width, lane: None });
        written.map_err(|why| Error::content(path, format!("\"{id}\" at {} s: {why}", Written(time))))?;
        ask(&mut rows, stopped)?;
    }
    users.counts.note_assumed(&mut said);
    said.doubtful.extend(tracks.remarks(|user| users.id(user)));
    Ok(said)
}

/// Counts a row, and asks now and then whether to stop.
fn ask(rows: &mut u64, stopped: &mut dyn FnMut() -> bool) -> Result<()> {
    *rows += 1;
    if rows.is_multiple_of(ASKED) && stopped() { Err(Error::Stopped) } else { Ok(()) }
}

/// Reads the rows of all files, sorted by road user.
fn read(tables: &[Table], users: &mut Users, said: &mut Said, stopped: &mut dyn FnMut() -> bool) -> Result<Sorted> {
    let mut sorter = Sorter::new(Order::Users);
    let mut rows = 0;
    for (number, table) in tables.iter().enumerate() {
        users.begin_file();
        let of_file = FileReader::new(table, if tables.len() > 1 { Some(number) } else { None })?;
        said.doubtful.extend(of_file.meta.remarks.iter().cloned());
        let elsewhere = tables.iter().flat_map(|table| &table.names).cloned().collect::<Vec<_>>();
        let places = std::cell::RefCell::new(Places::default());
        let mut is_stopped = false;
        let begin = |names: &[String]| {
            let found = table.mapping.places(names, &elsewhere).map_err(|why| why + &hint(names))?;
            if found.of[Field::Time as usize].is_none() && of_file.frame_rate.is_none() {
                return Err("its time is a number of frames: --frame-rate HZ is needed".to_owned());
            }
            let read = found.read.clone();
            places.replace(found);
            Ok(read)
        };
        let cut = table::read(table.path, begin, |cells| {
            let places = places.borrow();
            let reader = RowReader { file: &of_file, places: &places, cells };
            if let Some(row) = reader.row(users)? {
                sorter.push(row).map_err(|error| error.to_string())?;
            }
            is_stopped = ask(&mut rows, stopped).is_err();
            Ok(!is_stopped)
        })?;
        said.doubtful.extend(cut);
        if is_stopped {
            return Err(Error::Stopped);
        }
        said.doubtful.extend(of_file.lacking(places.into_inner(), users));
    }
    match tables.first() {
        Some(table) if users.is_empty() => Err(Error::content(table.path, "it has no rows of road users")),
        table => sorter.sorted().map_err(|source| Error::file(table.map_or(Path::new(""), |table| table.path), source)),
    }
}

/// What is known of a file while its rows are read.
struct FileReader<'a> {
    table: &'a Table<'a>,
    frame_rate: Option<f64>,
    meta: Meta,
    /// Its number, where there are several: each has ids of its own.
    number: Option<usize>,
}

impl<'a> FileReader<'a> {
    fn new(table: &'a Table, number: Option<usize>) -> Result<Self> {
        let meta = if table.mapping.has_meta { read_meta(table.path)? } else { Meta::default() };
        Ok(Self { table, frame_rate: table.mapping.frame_rate.or(meta.frame_rate), meta, number })
    }

    /// What the file lacks with the classes, or a file whose columns the user named, as lines.
    fn lacking(&self, places: Places, users: &mut Users) -> Vec<String> {
        let Table { path, mapping, names } = self.table;
        let mut remarks = Vec::new();
        let lacking = mapping.lacking(names).collect::<Vec<_>>();
        if mapping.is_named && !lacking.is_empty() {
            remarks.push(format!("{}: it has no column {}", path.display(), lacking.join(", ")));
        }
        let is_classed = places.of[Field::Class as usize].is_some();
        let file = || name_beside(path, "tracksMeta").unwrap_or_else(|| "tracksMeta".to_owned());
        let unclassed = std::mem::take(&mut users.counts.unclassed);
        if mapping.has_meta && self.meta.class_of.is_none() && !is_classed {
            remarks.push(format!("classes: the file {} with the classes is missing", file()));
        } else if let Some(first) = unclassed.iter().min() {
            let count = unclassed.len();
            remarks.push(format!("classes: {} lacks {count} of the road users, one of them \"{first}\"", file()));
        }
        remarks
    }
}

/// One row of the table.
struct RowReader<'a> {
    file: &'a FileReader<'a>,
    places: &'a Places,
    cells: &'a [Cell<'a>],
}

impl RowReader<'_> {
    fn cell(&self, field: Field) -> Option<(&Cell<'_>, f64)> {
        let (place, factor) = self.places.of[field as usize]?;
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

    /// A length or width; 0 where there is none.
    fn size(&self, field: Field) -> std::result::Result<Metre, String> {
        let size = self.number(field)?.unwrap_or_default();
        if size >= 0.0 { Ok(size) } else { Err(format!("column {}: {size} m is below 0", self.name(field))) }
    }

    fn name(&self, field: Field) -> &str {
        self.file.table.mapping.name(field)
    }

    /// The row; none if it is not a road user's.
    fn row(&self, users: &mut Users) -> std::result::Result<Option<Row>, String> {
        let mapping = &self.file.table.mapping;
        let id = self.text(Field::Id);
        if id.is_empty() {
            return Err(format!("column {}: an id is needed, but it is empty", self.name(Field::Id)));
        }
        let time = match self.file.frame_rate {
            _ if self.places.of[Field::Time as usize].is_some() => self.needed(Field::Time)?,
            rate => self.needed(Field::Frame)? / rate.unwrap_or(1.0),
        };
        // Sums of steps: a millionth of a second tells them apart.
        let time = (time * 1e6).round() / 1e6;
        let Some(class) = self.class(&id, users) else { return Ok(None) };
        let up = if mapping.is_picture { -1.0 } else { 1.0 };
        let mut place = Point::new(self.needed(Field::X)?, up * self.needed(Field::Y)?);
        let (mut length, width) = (self.size(Field::Length)?, self.size(Field::Width)?);
        let velocity = self.number(Field::SpeedX)?.zip(self.number(Field::SpeedY)?).map(|(x, y)| (x, up * y));
        let given = self.number(Field::Heading)?;
        let mut heading = given.map(|number| mapping.heading_unit.heading(number, mapping.is_picture));
        if let Some((rear_x, rear_y)) = self.number(Field::RearX)?.zip(self.number(Field::RearY)?) {
            let ahead = place - Point::new(rear_x, up * rear_y);
            if ahead.norm() > 0.0 {
                heading = Some(ahead.y.atan2(ahead.x));
                length = if length > 0.0 { length } else { ahead.norm() };
            }
        }
        if mapping.origin == Origin::UpperLeft {
            place += Vector::new(length, up * width) / 2.0;
            heading = velocity.map(|(x, _)| if x < 0.0 { PI } else { 0.0 });
        }
        users.counts.rows += 1;
        users.counts.lengths += u64::from(length == 0.0);
        users.counts.widths += u64::from(width == 0.0);
        let of_velocity = velocity.filter(|(x, y)| x.hypot(*y) > MOVES).map(|(x, y)| y.atan2(x));
        let heading = heading.or(of_velocity).unwrap_or(f64::NAN);
        let speed = self.number(Field::Speed)?.or(velocity.map(|(x, y)| x.hypot(y))).unwrap_or(f64::NAN);
        let user = self.user(&id, users);
        Ok(Some(Row { user, class, time, values: [place.x, place.y, heading, speed, length, width] }))
    }

    /// The number of the class; none if not a road user.
    fn class(&self, id: &str, users: &mut Users) -> Option<u32> {
        let of_meta = self.file.meta.class_of.as_ref();
        let known = of_meta.and_then(|class_of| class_of.get(id));
        if of_meta.is_some() && known.is_none() && !users.counts.unclassed.contains(id) {
            users.counts.unclassed.insert(id.to_owned());
        }
        let name = known.map_or_else(|| self.text(Field::Class), |class| Cow::Borrowed(class.as_str()));
        users.counts.classes += u64::from(name.is_empty());
        users.class(&name, &self.file.table.mapping)
    }

    /// The number of the road user.
    fn user(&self, id: &str, users: &mut Users) -> u32 {
        let parts = self.places.reused.iter().filter_map(|place| self.cells.get(*place));
        let mut key = Cow::Borrowed(id);
        for part in parts.map(Cell::text).chain(self.file.number.map(|number| Cow::Owned(number.to_string()))) {
            key = Cow::Owned(format!("{key}\n{part}"));
        }
        let is_reused = !self.file.table.mapping.reused.is_empty();
        if is_reused { users.number_of_reused(&key, id) } else { users.number(&key, id) }
    }
}
