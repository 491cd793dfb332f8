//! What a column of a table may be, and in which units.

use std::f64::consts::FRAC_PI_2;

use strum::{Display, EnumString, IntoStaticStr, VariantArray, VariantNames};

use crate::util::header::Wanted;
use closecall::util::units::Radian;

/// What a column is, by its name in `--columns`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Display, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "snake_case")]
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
    #[strum(serialize = "vx")]
    SpeedX,
    #[strum(serialize = "vy")]
    SpeedY,
    Length,
    Width,
    Class,
}

impl Field {
    pub const COUNT: usize = Self::VARIANTS.len();

    /// What a file may lack.
    pub fn is_optional(self) -> bool {
        !matches!(self, Self::Id | Self::Time | Self::Frame | Self::X | Self::Y)
    }

    /// What its values are read as.
    pub fn wanted(self) -> Wanted {
        if matches!(self, Self::Id | Self::Class) { Wanted::Text } else { Wanted::Number }
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, EnumString, IntoStaticStr, VariantArray)]
pub(super) enum HeadingUnit {
    #[default]
    #[strum(serialize = "rad")]
    Radian,
    #[strum(serialize = "deg")]
    Degree,
    /// Degrees clockwise from north.
    #[strum(serialize = "north")]
    North,
}

impl HeadingUnit {
    /// Its name in `--columns`.
    pub fn name(self) -> &'static str {
        self.into()
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
