//! Guesses the meaning and unit of columns in a table of unknown layout, from their names and the values of the first rows.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::field::{Field, HeadingUnit};
use super::headings::Headings;
use super::spill::Row;
use super::table::{self, Cell};
use crate::Result;
use crate::util::header::Wanted;

/// Rows that are looked at.
const ROWS: usize = 20_000;
/// Frames per second where nothing tells.
const USUAL_RATE: f64 = 25.0;
/// Steps of this many units of time and more are of ms, us, ns: trajectories have steps of 5 ms to 10 s.
const STEPS: [(f64, &str); 3] = [(1e7, "ns"), (1e4, "us"), (5.0, "ms")];
/// By how much a speed may differ from the movement, as a share, to be in a unit.
const SAME_SPEED: f64 = 0.04;

/// What columns are often called, without their units.
const USUAL: [(Field, &[&str]); 12] = [
    (
        Field::Id,
        &[
            "id",
            "track_id",
            "trackid",
            "vehicle_id",
            "vehicleid",
            "object_id",
            "objectid",
            "agent_id",
            "actor_id",
            "car_id",
            "carid",
            "actor",
            "agent",
            "vehicle",
        ],
    ),
    (Field::Time, &["time", "t", "timestamp", "time_stamp", "sim_time", "global_time", "total", ""]),
    (Field::Frame, &["frame", "frame_id", "frameid", "framenum"]),
    (
        Field::X,
        &["x", "xcenter", "x_center", "center_x", "pos_x", "position_x", "utm_x", "x_utm", "local_x", "easting"],
    ),
    (
        Field::Y,
        &["y", "ycenter", "y_center", "center_y", "pos_y", "position_y", "utm_y", "y_utm", "local_y", "northing"],
    ),
    (Field::Heading, &["heading", "yaw", "psi", "orientation", "course", "theta"]),
    (Field::Speed, &["speed", "v", "velocity"]),
    (Field::SpeedX, &["vx", "v_x", "xvelocity", "x_velocity", "vel_x", "velocity_x"]),
    (Field::SpeedY, &["vy", "v_y", "yvelocity", "y_velocity", "vel_y", "velocity_y"]),
    (Field::Length, &["length", "l"]),
    (Field::Width, &["width", "w"]),
    (Field::Class, &["class", "type", "agent_type", "object_type", "category"]),
];

/// Other names of units.
const UNITS: [(&str, &[&str]); 12] = [
    ("s", &["sec", "secs", "second", "seconds"]),
    ("ms", &["msec", "millis", "millisecond", "milliseconds"]),
    ("us", &["µs", "usec", "micros", "microsecond", "microseconds"]),
    ("ns", &["nsec", "nanos", "nanosecond", "nanoseconds"]),
    ("m", &["meter", "meters", "metre", "metres"]),
    ("ft", &["feet", "foot"]),
    ("rad", &["radian", "radians"]),
    ("deg", &["degree", "degrees"]),
    ("m/s", &["mps", "ms"]),
    ("km/h", &["kmh", "kph", "kmph"]),
    ("mph", &["mi/h"]),
    ("ft/s", &["fps"]),
];

/// A column, and its unit if that is not the first of its field.
#[derive(Clone, Debug)]
struct Found<'a> {
    field: Field,
    name: &'a str,
    unit: Option<&'static str>,
}

/// The guessed layout of a table.
pub(super) struct Guess {
    /// The text of `--columns`.
    pub columns: String,
    /// What nothing tells, by the names in `--columns`.
    pub missing: Vec<&'static str>,
    /// Frames per second, where the time is a number of frames, and whether the speeds show them.
    pub frame_rate: Option<(f64, bool)>,
}

/// Guesses what the columns of a table are.
pub(super) fn guess(path: &Path, names: &[String]) -> Result<Guess> {
    let column = |(field, usual): &(Field, &[&str])| {
        let found = names.iter().find_map(|name| unit_in(name, *field, usual).map(|unit| (name.as_str(), unit)));
        found.map(|(name, unit)| Found { field: *field, name, unit })
    };
    let mut found = USUAL.iter().filter_map(column).collect::<Vec<_>>();
    let sample = Sample::read(path, names, &found)?;
    // A clock time of day cannot be read.
    found.retain(|it| it.field == Field::Id || it.field == Field::Class || sample.are_numbers[it.field as usize]);
    let has = |found: &[Found], field: Field| found.iter().any(|it| it.field == field);
    let has_time = has(&found, Field::Time);
    found.retain(|it| it.field != Field::Frame || !has_time);
    for place in 0..found.len() {
        if found[place].unit.is_none() {
            let factor = factor(&found, if has_time { Field::Time } else { Field::Frame });
            found[place].unit = sample.unit(found[place].field, factor);
        } else if found[place].field == Field::Heading {
            let named = found[place].unit.and_then(|unit| unit.parse().ok());
            found[place].unit = named.map(|named| sample.heading_unit(named).name());
        }
    }
    let clock = if has_time { Field::Time } else { Field::Frame };
    let needed = [Field::Id, clock, Field::X, Field::Y];
    let missing = needed.into_iter().filter(|field| !has(&found, *field)).map(<&str>::from).collect::<Vec<_>>();
    let mut columns = Vec::new();
    for (field, _) in &USUAL {
        match found.iter().find(|it| it.field == *field) {
            Some(Found { name, unit, .. }) => {
                let first = field.units().first().map(|(first, _)| *first);
                // Brackets at the end of a name would be taken for its unit.
                let unit = if name.ends_with(']') { unit.or(first) } else { unit.filter(|unit| Some(*unit) != first) };
                let unit = unit.map_or(String::new(), |unit| format!("[{unit}]"));
                columns.push(format!("{field}={name}{unit}"));
            }
            None if needed.contains(field) => columns.push(format!("{field}=COLUMN")),
            None => {}
        }
    }
    let rate = || sample.frame_rate().map_or((USUAL_RATE, false), |rate| (rate, true));
    Ok(Guess { columns: columns.join(","), missing, frame_rate: (!has_time).then(rate) })
}

/// The factor of a field to SI.
fn factor(found: &[Found], field: Field) -> f64 {
    let unit = found.iter().find(|it| it.field == field).and_then(|it| it.unit);
    unit.and_then(|unit| field.units().iter().find(|(known, _)| *known == unit)).map_or(1.0, |(_, factor)| *factor)
}

/// Whether a column is often called so, and the unit in its name: `speed [km/h]`, `t_ms`.
fn unit_in(name: &str, field: Field, usual: &[&str]) -> Option<Option<&'static str>> {
    let name = name.to_lowercase();
    if !name.is_empty() && usual.contains(&name.as_str()) {
        return Some(None);
    }
    let (stem, unit) = name.rsplit_once(['[', '(']).or_else(|| name.rsplit_once(['_', ' '])).unwrap_or(("", &name));
    let (stem, unit) = (stem.trim_end_matches(['_', ' ']), unit.trim_end_matches([']', ')']));
    let is_meant =
        |known: &str| known == unit || UNITS.iter().any(|(it, others)| *it == known && others.contains(&unit));
    let unit = field.units().iter().map(|(known, _)| *known).find(|known| is_meant(known))?;
    // A column "s" is the way along a lane.
    (usual.contains(&stem) && !(stem.is_empty() && unit == "s")).then_some(Some(unit))
}

/// The numbers of the first rows, in the order of road users and times.
struct Sample {
    rows: Vec<(u32, [f64; Field::COUNT])>,
    /// By field: whether all its values are numbers.
    are_numbers: [bool; Field::COUNT],
}

impl Sample {
    fn read(path: &Path, names: &[String], found: &[Found]) -> Result<Self> {
        let mut sample = Self { rows: Vec::new(), are_numbers: [true; Field::COUNT] };
        let mut users: FxHashMap<String, u32> = FxHashMap::default();
        let place = |it: &Found| names.iter().position(|name| name == it.name).unwrap_or_default();
        let wanted = |it: &Found| if it.field == Field::Id { Wanted::Text } else { Wanted::Number };
        let numbers = found.iter().filter(|it| it.field != Field::Class).collect::<Vec<_>>();
        let columns = numbers.iter().map(|it| (place(it), wanted(it))).collect();
        table::read(
            path,
            |_| Ok(columns),
            |cells| {
                let mut user = 0;
                let mut values = [f64::NAN; Field::COUNT];
                for (it, cell) in numbers.iter().zip(cells) {
                    if it.field == Field::Id {
                        let count = users.len() as u32;
                        user = *users.entry(cell.text().into_owned()).or_insert(count);
                    } else {
                        let number = Cell::number(cell);
                        sample.are_numbers[it.field as usize] &= number.is_ok();
                        values[it.field as usize] = number.ok().flatten().unwrap_or(f64::NAN);
                    }
                }
                sample.rows.push((user, values));
                Ok(sample.rows.len() < ROWS)
            },
        )?;
        let time = |values: &[f64; Field::COUNT]| {
            let [time, frame] = [Field::Time, Field::Frame].map(|field| values[field as usize]);
            if time.is_nan() { frame } else { time }
        };
        sample.rows.sort_by(|a, b| a.0.cmp(&b.0).then(time(&a.1).total_cmp(&time(&b.1))));
        Ok(sample)
    }

    fn values(&self, field: Field) -> impl Iterator<Item = f64> {
        self.rows.iter().map(move |(_, values)| values[field as usize]).filter(|value| !value.is_nan())
    }

    /// The unit of a field whose name does not tell it; `second` is the unit of time in s.
    fn unit(&self, field: Field, second: f64) -> Option<&'static str> {
        match field {
            Field::Time => {
                let mut times = self.values(field).collect::<Vec<_>>();
                times.sort_by(f64::total_cmp);
                let step = median(times.windows(2).map(|two| two[1] - two[0]).filter(|step| *step > 0.0).collect())?;
                STEPS.iter().find(|(least, _)| step >= *least).map(|(_, unit)| *unit)
            }
            Field::Heading => Some(self.heading_unit(HeadingUnit::Radian).name()),
            Field::Speed => {
                let ratios = self.steps(Field::Time).map(|[lasted, way, speed]| way / (lasted * second) / speed);
                let ratio = median(ratios.collect())?;
                let is_it = |(_, factor): &&(&str, f64)| (ratio / factor - 1.0).abs() < SAME_SPEED;
                field.units().iter().find(is_it).map(|(unit, _)| *unit)
            }
            _ => None,
        }
    }

    /// The unit of headings that may be in this one.
    fn heading_unit(&self, unit: HeadingUnit) -> HeadingUnit {
        let mut headings = Headings::new(unit, false);
        for (user, values) in &self.rows {
            let of = |field: Field| values[field as usize];
            let heading = unit.heading(of(Field::Heading), false);
            let values = [of(Field::X), of(Field::Y), heading, 0.0, 0.0, 0.0];
            headings.add(&Row { user: *user, class: 0, time: 0.0, values });
        }
        let beyond = |angle: f64| angle.abs() > std::f64::consts::TAU * 1.01;
        let is_beyond = unit == HeadingUnit::Radian && self.values(Field::Heading).any(beyond);
        headings.better().unwrap_or(if is_beyond { HeadingUnit::Degree } else { unit })
    }

    /// The frames per second that the speeds show.
    fn frame_rate(&self) -> Option<f64> {
        let rates = self.steps(Field::Frame).map(|[lasted, way, speed]| speed * lasted / way);
        median(rates.collect()).map(f64::round).filter(|rate| *rate > 0.0)
    }

    /// How long it took to the next row of a road user that moves, how far it drove and at which speed.
    fn steps(&self, clock: Field) -> impl Iterator<Item = [f64; 3]> {
        let steps = self.rows.windows(2).filter(|two| two[0].0 == two[1].0).map(move |two| {
            let change = |field: Field| two[1].1[field as usize] - two[0].1[field as usize];
            let [speed, vx, vy] = [Field::Speed, Field::SpeedX, Field::SpeedY].map(|field| two[0].1[field as usize]);
            let speed = if speed.is_nan() { vx.hypot(vy) } else { speed };
            [change(clock), change(Field::X).hypot(change(Field::Y)), speed]
        });
        steps.filter(|step| step.iter().all(|it| *it > 0.0))
    }
}

fn median(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied()
}
