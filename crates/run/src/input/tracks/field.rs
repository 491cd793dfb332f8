//! What a column of a table may be, and in which units.

use std::f64::consts::FRAC_PI_2;

use crate::util::header::Wanted;
use closecall::util::units::Radian;

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

    pub const NAMES: [(&'static str, Self); Self::COUNT] = [
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
    pub fn is_optional(self) -> bool {
        !matches!(self, Self::Id | Self::Time | Self::Frame | Self::X | Self::Y)
    }

    /// What its values are read as.
    pub fn wanted(self) -> Wanted {
        if matches!(self, Self::Id | Self::Class) { Wanted::Text } else { Wanted::Number }
    }

    /// Its name in `--columns`.
    pub fn key(self) -> &'static str {
        Self::NAMES.iter().find(|(_, field)| *field == self).map_or("", |(key, _)| key)
    }

    /// Its units, each with the factor to SI.
    pub fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Time => &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)],
            Self::X | Self::Y | Self::RearX | Self::RearY | Self::Length | Self::Width => &[("m", 1.0), ("ft", 0.3048)],
            // See [`HeadingUnit`].
            Self::Heading => &[("rad", 1.0), ("deg", 1.0), ("north", 1.0)],
            Self::Speed | Self::SpeedX | Self::SpeedY => {
                &[("m/s", 1.0), ("km/h", 1.0 / 3.6), ("mph", 0.447_04), ("ft/s", 0.3048)]
            }
            Self::Id | Self::Frame | Self::Class => &[],
        }
    }
}

/// A degree in rad.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// The unit of headings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum HeadingUnit {
    #[default]
    Radian,
    Degree,
    /// Degrees clockwise from north.
    North,
}

impl HeadingUnit {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Radian, Self::Degree, Self::North];

    /// Its name in `--columns`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radian => "rad",
            Self::Degree => "deg",
            Self::North => "north",
        }
    }

    /// The heading that a number in this unit means; in a picture, y points down.
    pub fn heading(self, number: f64, is_picture: bool) -> Radian {
        let up = if is_picture { -1.0 } else { 1.0 };
        match self {
            Self::Radian => up * number,
            Self::Degree => up * (number * DEGREE),
            Self::North => FRAC_PI_2 - number * DEGREE,
        }
    }

    /// The number of a heading.
    pub fn number(self, heading: Radian, is_picture: bool) -> f64 {
        let up = if is_picture { -1.0 } else { 1.0 };
        match self {
            Self::Radian => up * heading,
            Self::Degree => up * heading / DEGREE,
            Self::North => (FRAC_PI_2 - heading) / DEGREE,
        }
    }
}
