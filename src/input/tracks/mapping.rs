//! Which column of a table is what, in which unit: the text of `--columns`, and the options beside it.

use super::format::RecordingFormat;
use crate::util::limits::{Limit, RESERVE};
use crate::util::units::Metre;

/// The noise of a place: one of 10 m tells no lane from the next.
pub const NOISE: Limit = Limit { of: "noise", least: 0.0, is_open: true, most: 10.0, ..RESERVE };

/// How a table of trajectories is read.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct TrackOptions {
    /// Format of the recording [default: as its first bytes and columns tell; closecall inspect FILE says].
    #[cfg_attr(feature = "cli", arg(long, value_enum, ignore_case = true))]
    pub format: Option<RecordingFormat>,
    /// Columns of a table (CSV, Parquet): id, time or frame, x, y; if there are any, heading, speed or vx and vy, length, width,
    /// class, rear_x, rear_y. Units in brackets: time s, ms, us, ns; lengths m, ft; heading rad, deg, counter-clockwise
    /// from +x, or north, degrees clockwise from north; speeds m/s, km/h, mph, ft/s.
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "x=COLUMN[UNIT],…", default_value = "", hide_default_value = true)
    )]
    pub columns: String,
    /// Frames per second of a recording whose time is a number of frames.
    #[cfg_attr(feature = "cli", arg(long, value_name = "HZ"))]
    pub frame_rate: Option<f64>,
    /// What x and y of --columns are: the middle of the road user, or of its front.
    #[cfg_attr(feature = "cli", arg(long, value_enum, value_name = "PLACE"))]
    pub origin: Option<Origin>,
    /// Smooth the places and headings of a table of trajectories. M is the standard deviation of the noise in a place, in m; without
    /// a value 0.1.
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "M", num_args = 0..=1, require_equals = true, default_missing_value = "0.1", value_parser = noise)
    )]
    pub smooth: Option<Metre>,
}

/// The standard deviation of noise in m.
#[cfg(feature = "cli")]
fn noise(text: &str) -> Result<Metre, String> {
    let noise = text.parse().ok().filter(|noise| NOISE.holds(*noise));
    noise.ok_or_else(|| format!("it must be {}", NOISE.range()))
}

/// What x and y of a road user are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Origin {
    /// The middle of its outline.
    #[default]
    Centre,
    /// The middle of its front.
    Front,
    /// The upper left corner of its outline in a picture; it drives along x.
    #[cfg_attr(feature = "cli", value(skip))]
    UpperLeft,
}

/// What a column is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Field {
    Id,
    Time,
    Frame,
    X,
    Y,
    RearX,
    RearY,
    Heading,
    Speed,
    SpeedX,
    SpeedY,
    Length,
    Width,
    Class,
}

impl Field {
    pub const COUNT: usize = 14;

    const NAMES: [(&'static str, Self); Self::COUNT] = [
        ("id", Self::Id),
        ("time", Self::Time),
        ("frame", Self::Frame),
        ("x", Self::X),
        ("y", Self::Y),
        ("rear_x", Self::RearX),
        ("rear_y", Self::RearY),
        ("heading", Self::Heading),
        ("speed", Self::Speed),
        ("vx", Self::SpeedX),
        ("vy", Self::SpeedY),
        ("length", Self::Length),
        ("width", Self::Width),
        ("class", Self::Class),
    ];

    /// What a file may lack.
    fn is_optional(self) -> bool {
        !matches!(self, Self::Id | Self::Time | Self::Frame | Self::X | Self::Y)
    }

    /// Its units, each with the factor to SI.
    fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Time => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)],
            Self::X | Self::Y | Self::RearX | Self::RearY | Self::Length | Self::Width => &[("m", 1.0), ("ft", 0.3048)],
            // The last is clockwise from north; `rows` turns it.
            Self::Heading => &[("rad", 1.0), ("deg", DEGREE), (NORTH, DEGREE)],
            Self::Speed | Self::SpeedX | Self::SpeedY => {
                &[("m/s", 1.0), ("km/h", 1.0 / 3.6), ("mph", 0.447_04), ("ft/s", 0.3048)]
            }
            Self::Id | Self::Frame | Self::Class => &[],
        }
    }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// The unit of a heading in degrees clockwise from north.
const NORTH: &str = "north";

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NamedField {
    pub field: Field,
    pub name: String,
    /// To SI.
    pub factor: f64,
}

/// Which columns a table has, and how they are to be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mapping {
    pub fields: Vec<NamedField>,
    pub origin: Origin,
    pub frame_rate: Option<f64>,
    pub is_picture: bool,
    /// Whether the heading is clockwise from north.
    pub is_compass: bool,
    pub classes: &'static [(&'static str, &'static str)],
    pub has_meta: bool,
}

impl Mapping {
    /// The columns in the text of `--columns`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut fields: Vec<NamedField> = Vec::new();
        let mut is_compass = false;
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let (key, column) =
                part.split_once('=').ok_or_else(|| format!("\"{part}\" is not x=COLUMN or x=COLUMN[UNIT]"))?;
            let field =
                Field::NAMES.iter().find(|(name, _)| *name == key).map(|(_, field)| *field).ok_or_else(|| {
                    let known = Field::NAMES.map(|(name, _)| name).join(", ");
                    format!("\"{key}\" is unknown; known are {known}")
                })?;
            let unit = column.strip_suffix(']').and_then(|column| column.rsplit_once('['));
            let (name, unit) = unit.map_or((column, None), |(name, unit)| (name, Some(unit)));
            let factor = match unit {
                None => 1.0,
                Some(unit) => {
                    field.units().iter().find(|(known, _)| *known == unit).map(|(_, factor)| *factor).ok_or_else(
                        || {
                            let known = field.units().iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", ");
                            format!(
                                "{key} has no unit \"{unit}\"; {}",
                                if known.is_empty() { "it has none" } else { &known }
                            )
                        },
                    )?
                }
            };
            is_compass |= field == Field::Heading && unit == Some(NORTH);
            if fields.iter().any(|known| known.field == field) {
                return Err(format!("{key} is there twice"));
            }
            fields.push(NamedField { field, name: name.to_owned(), factor });
        }
        let has = |field: Field| fields.iter().any(|known| known.field == field);
        for (name, is_there) in [
            ("id", has(Field::Id)),
            ("time or frame", has(Field::Time) || has(Field::Frame)),
            ("x", has(Field::X)),
            ("y", has(Field::Y)),
        ] {
            if !is_there {
                return Err(format!("{name} is missing"));
            }
        }
        Ok(Self {
            fields,
            origin: Origin::default(),
            frame_rate: None,
            is_picture: false,
            is_compass,
            classes: &[],
            has_meta: false,
        })
    }

    /// The columns by which its layout is known: those that a file must have, and the heading, which tells SinD from
    /// INTERACTION.
    pub fn distinctive(&self) -> impl Iterator<Item = &str> {
        let is_distinctive = |field: &&NamedField| !field.field.is_optional() || field.field == Field::Heading;
        let speeds = self.fields.iter().filter(|field| matches!(field.field, Field::SpeedX | Field::Speed));
        self.fields.iter().filter(is_distinctive).chain(speeds).map(|field| field.name.as_str())
    }

    /// Where in a table the columns are, by field.
    ///
    /// # Errors
    /// Which column is missing.
    pub fn places(&self, names: &[String]) -> Result<[Option<(usize, f64)>; Field::COUNT], String> {
        let mut places = [None; Field::COUNT];
        for NamedField { field, name, factor } in &self.fields {
            let exact = names.iter().position(|known| known == name);
            let place = exact.or_else(|| names.iter().position(|known| known.eq_ignore_ascii_case(name)));
            match place {
                Some(place) => places[*field as usize] = Some((place, *factor)),
                None if field.is_optional() => {}
                None => return Err(format!("it has no column {name}")),
            }
        }
        Ok(places)
    }

    /// The columns that a table lacks.
    pub fn lacking<'a>(&'a self, names: &'a [String]) -> impl Iterator<Item = &'a str> {
        self.fields.iter().map(|field| field.name.as_str()).filter(|name| !has(names, name))
    }
}

/// Whether a column is among these; the releases of a data set differ in upper and lower case.
pub(super) fn has(names: &[String], name: &str) -> bool {
    names.iter().any(|known| known.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_columns_do_not_tell_is_named() {
        for (text, said) in [
            ("x", "\"x\" is not x=COLUMN"),
            ("z=height", "\"z\" is unknown; known are id, time"),
            ("x=a[yd]", "x has no unit \"yd\"; m, ft"),
            ("id=a[m]", "id has no unit \"m\"; it has none"),
            ("id=a,id=b", "id is there twice"),
            ("id=a,x=b,y=c", "time or frame is missing"),
        ] {
            let error = Mapping::parse(text).unwrap_err();
            assert!(error.starts_with(said), "{error}");
        }
    }

    #[test]
    fn a_column_may_have_brackets_in_its_name() {
        let mapping = Mapping::parse("id=a,time=t[x][ms],x=x,y=y").unwrap();
        assert_eq!((mapping.fields[1].name.as_str(), mapping.fields[1].factor), ("t[x]", 1e-3));
    }
}
