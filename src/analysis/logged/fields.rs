//! The columns of a conflict with their types: what Parquet needs and CSV does not say.

use parquet::basic::Type as Physical;

use super::conflicts::{LoggedConflict, LoggedSnapshot};
use crate::output::log::CONFLICT_COLUMNS;

/// A column: its type, and how a conflict fills it.
#[derive(Clone, Copy, Debug)]
pub enum Field {
    /// A whole number.
    Count(fn(&LoggedConflict) -> i64),
    /// An id or a name.
    Text(fn(&LoggedConflict) -> &str),
    /// A number; null where there is none.
    Number(fn(&LoggedConflict) -> Option<f64>),
    /// Yes or no.
    Flag(fn(&LoggedConflict) -> bool),
}

impl Field {
    /// How Parquet stores it.
    pub fn physical(self) -> Physical {
        match self {
            Self::Count(_) => Physical::INT64,
            Self::Text(_) => Physical::BYTE_ARRAY,
            Self::Number(_) => Physical::DOUBLE,
            Self::Flag(_) => Physical::BOOLEAN,
        }
    }
}

/// The columns of the log that every conflict has; the others are those of the snapshots.
pub const WITHOUT_STANCES: usize = 25;

/// How the columns of the log are filled, in the order of [`CONFLICT_COLUMNS`].
pub const FIELDS: [Field; CONFLICT_COLUMNS.len()] = [
    Field::Count(|conflict| conflict.id as i64),
    Field::Text(|conflict| &conflict.ego),
    Field::Text(|conflict| &conflict.foe),
    Field::Text(|conflict| conflict.kind.name()),
    Field::Text(|conflict| conflict.severity.name()),
    Field::Number(|conflict| Some(conflict.begin)),
    Field::Number(|conflict| Some(conflict.end)),
    Field::Number(|conflict| Some(conflict.time)),
    Field::Number(|conflict| Some(conflict.gap)),
    Field::Number(|conflict| Some(conflict.mu)),
    Field::Number(|conflict| Some(conflict.margin)),
    Field::Number(|conflict| Some(conflict.clearance)),
    Field::Number(|conflict| conflict.ttc),
    Field::Number(|conflict| conflict.drac),
    Field::Number(|conflict| conflict.pet),
    Field::Number(|conflict| Some(conflict.delta_v)),
    Field::Number(|conflict| Some(conflict.ego_speed)),
    Field::Number(|conflict| Some(conflict.foe_speed)),
    Field::Number(|conflict| Some(conflict.angle)),
    Field::Number(|conflict| Some(conflict.x)),
    Field::Number(|conflict| Some(conflict.y)),
    Field::Text(|conflict| &conflict.lane),
    Field::Flag(|conflict| conflict.collision),
    Field::Text(|conflict| &conflict.ego_type),
    Field::Text(|conflict| &conflict.foe_type),
    Field::Number(|conflict| ego(conflict).map(|stance| stance.x)),
    Field::Number(|conflict| ego(conflict).map(|stance| stance.y)),
    Field::Number(|conflict| ego(conflict).map(|stance| stance.heading)),
    Field::Number(|conflict| ego(conflict).map(|stance| stance.length)),
    Field::Number(|conflict| ego(conflict).map(|stance| stance.width)),
    Field::Text(|conflict| ego(conflict).map_or("", |stance| &stance.path)),
    Field::Number(|conflict| foe(conflict).map(|stance| stance.x)),
    Field::Number(|conflict| foe(conflict).map(|stance| stance.y)),
    Field::Number(|conflict| foe(conflict).map(|stance| stance.heading)),
    Field::Number(|conflict| foe(conflict).map(|stance| stance.length)),
    Field::Number(|conflict| foe(conflict).map(|stance| stance.width)),
    Field::Text(|conflict| foe(conflict).map_or("", |stance| &stance.path)),
];

fn ego(conflict: &LoggedConflict) -> Option<&LoggedSnapshot> {
    conflict.snapshots.as_deref().map(|[ego, _]| ego)
}

fn foe(conflict: &LoggedConflict) -> Option<&LoggedSnapshot> {
    conflict.snapshots.as_deref().map(|[_, foe]| foe)
}
