//! The meaning and unit of a table's columns: the text of `--columns`, and the options beside it.

use strum::VariantNames;

use super::field::{Field, HeadingUnit};
use super::format::RecordingFormat;
use crate::util::header::{self, Wanted};
use closecall::util::limits::{Limit, RESERVE};
use closecall::util::units::Metre;

/// The noise of a place: one of 10 m tells no lane from the next.
pub const NOISE: Limit = Limit { of: "noise", least: 0.0, is_open: true, most: 10.0, ..RESERVE };

/// How a table of trajectories is read.
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
#[command(next_help_heading = "Recording")]
pub struct TrackOptions {
    /// Format of the recording [default: detected from the file; closecall inspect FILE shows it].
    #[arg(long, value_enum, ignore_case = true)]
    pub format: Option<RecordingFormat>,
    /// Columns of a table (CSV, Parquet): id, time or frame, x, y; if there are any, heading, speed or vx and vy, length, width,
    /// class, rear_x, rear_y. Units in brackets: time s, ms, us, ns; lengths m, ft; heading rad, deg, counter-clockwise
    /// from +x, or north, degrees clockwise from north; speeds m/s, km/h, mph, ft/s.
    #[arg(long, value_name = "x=COLUMN[UNIT],…", default_value = "", hide_default_value = true)]
    pub columns: String,
    /// Frames per second of a recording whose time is a number of frames.
    #[arg(long, value_name = "HZ")]
    pub frame_rate: Option<f64>,
    /// Reference point of x and y of --columns: the middle of the road user, or of its front.
    #[arg(long, value_enum, value_name = "PLACE")]
    pub origin: Option<Origin>,
    /// Smooth the places and headings of a table of trajectories. M is the standard deviation of the noise in a place, in m; without
    /// a value 0.1.
    #[arg(long, value_name = "M", num_args = 0..=1, require_equals = true, default_missing_value = "0.1", value_parser = noise)]
    pub smooth: Option<Metre>,
}

/// The standard deviation of noise in m.
fn noise(text: &str) -> Result<Metre, String> {
    let noise = text.parse().ok().filter(|noise| NOISE.holds(*noise));
    noise.ok_or_else(|| format!("it must be {}", NOISE.range()))
}

/// Reference point of x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Origin {
    /// The middle of its outline.
    #[default]
    Centre,
    /// The middle of its front.
    Front,
    /// The upper left corner of its outline in a picture; it drives along x.
    #[value(skip)]
    UpperLeft,
}

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
    pub heading_unit: HeadingUnit,
    pub classes: &'static [(&'static str, &'static str)],
    pub has_meta: bool,
    /// Whether the user named the columns, so that all of them have to be there.
    pub is_named: bool,
    /// Columns that tell road users apart whose ids are the same, where there are any: the ids are used again.
    pub reused: &'static [&'static str],
}

/// Where the columns of a table are.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// By field: the place among the columns that are read, and the factor to SI.
    pub of: [Option<(usize, f64)>; Field::COUNT],
    /// Of the columns that tell apart road users with one id.
    pub reused: Vec<usize>,
    /// The columns that are read, by their places in the table.
    pub read: Vec<(usize, Wanted)>,
}

impl Mapping {
    /// The columns in the text of `--columns`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut fields: Vec<NamedField> = Vec::new();
        let mut heading_unit = HeadingUnit::default();
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let (key, column) =
                part.split_once('=').ok_or_else(|| format!("\"{part}\" is not x=COLUMN or x=COLUMN[UNIT]"))?;
            let unknown = |_| format!("\"{key}\" is unknown; known are {}", Field::VARIANTS.join(", "));
            let field = key.parse::<Field>().map_err(unknown)?;
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
            if let (Field::Heading, Some(unit)) = (field, unit) {
                heading_unit = unit.parse().unwrap_or_default();
            }
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
            heading_unit,
            classes: &[],
            has_meta: false,
            is_named: false,
            reused: &[],
        })
    }

    /// The columns by which its layout is known: those that a file must have, and the speed.
    pub(crate) fn distinctive(&self) -> impl Iterator<Item = &str> {
        let is_distinctive = |field: &&NamedField| !field.field.is_optional();
        let speeds = self.fields.iter().filter(|field| matches!(field.field, Field::SpeedX | Field::Speed));
        self.fields.iter().filter(is_distinctive).chain(speeds).map(|field| field.name.as_str())
    }

    /// The name of the column of a field; empty where the mapping has none.
    pub fn name(&self, field: Field) -> &str {
        self.fields.iter().find(|known| known.field == field).map_or("", |known| &known.name)
    }

    /// The unit of headings that are given, if there are any.
    pub(crate) fn given_headings(&self) -> Option<HeadingUnit> {
        let is_derived = self.origin == Origin::UpperLeft || !self.name(Field::RearX).is_empty();
        Some(self.heading_unit).filter(|_| !is_derived && !self.name(Field::Heading).is_empty())
    }

    /// Where in a table the columns are. `elsewhere` are the names of columns of the recording's other files, which may have what
    /// this one lacks.
    ///
    /// # Errors
    /// Which column is missing, or is there twice.
    pub fn places(&self, names: &[String], elsewhere: &[String]) -> Result<Places, String> {
        let mut places = Places::default();
        for NamedField { field, name, factor } in &self.fields {
            match header::any_case(names, name)? {
                Some(place) => {
                    places.of[*field as usize] = Some((places.read.len(), *factor));
                    places.read.push((place, field.wanted()));
                }
                None if field.is_optional() && (!self.is_named || has(elsewhere, name)) => {}
                None => return Err(format!("it has no column {name}")),
            }
        }
        for name in self.reused {
            if let Some(place) = header::any_case(names, name)? {
                places.reused.push(places.read.len());
                places.read.push((place, Wanted::Text));
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
    fn what_the_user_named_must_be_in_one_of_the_files() {
        let names = ["id", "time", "x", "y", "len"].map(str::to_owned);
        let layout = Mapping::parse("id=id,time=time,x=x,y=y,length=lenght").unwrap();
        assert!(layout.places(&names, &[]).is_ok_and(|places| places.read.len() == 4));
        let named = Mapping { is_named: true, ..layout };
        assert_eq!(named.places(&names, &[]).unwrap_err(), "it has no column lenght");
        assert!(named.places(&names, &["lenght".to_owned()]).is_ok());
    }

    #[test]
    fn a_column_may_have_brackets_in_its_name() {
        let mapping = Mapping::parse("id=a,time=t[x][ms],x=x,y=y").unwrap();
        assert_eq!((mapping.fields[1].name.as_str(), mapping.fields[1].factor), ("t[x]", 1e-3));
    }
}
