//! The place of a conflict on a map.

use crate::output::schema::LoggedConflict;

/// In what the places of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// Degrees of longitude and latitude (WGS 84).
    Degrees,
    /// The net's own metres: where it lies on the earth is not known.
    Metres,
}

impl Frame {
    /// That of a log with this first conflict.
    pub fn of(first: Option<&LoggedConflict>) -> Self {
        if first.is_none_or(|first| first.lon.is_some()) { Self::Degrees } else { Self::Metres }
    }
}

/// Where a conflict is; none where its degrees are not known.
pub fn place(conflict: &LoggedConflict, frame: Frame) -> Option<[f64; 2]> {
    match frame {
        Frame::Degrees => Some([conflict.lon?, conflict.lat?]),
        Frame::Metres => Some([conflict.x, conflict.y]),
    }
}

/// A point as well-known binary (OGC 06-103r4), little-endian.
pub(crate) fn well_known([x, y]: [f64; 2]) -> Vec<u8> {
    let mut bytes = vec![1];
    bytes.extend(1_u32.to_le_bytes());
    bytes.extend(x.to_le_bytes());
    bytes.extend(y.to_le_bytes());
    bytes
}
