//! The columns of `series.csv`, which has a row per step of each conflict: the number of the conflict, then those columns
//! of the log that a single step has.

use super::schema::{COLUMNS, Column, LoggedConflict, Value};
use crate::options::measures::Measures;

/// The number of the conflict, which is its `id` in the log.
const CONFLICT: &str = "conflict";

/// The columns of the log that the series lacks: what only a whole event has, and what is the same in each of its steps.
const OF_THE_EVENT: [&str; 21] = [
    "id",
    "begin",
    "end",
    "pet",
    "collision_sumo",
    "ego_type",
    "foe_type",
    "ego_length",
    "ego_width",
    "ego_path",
    "foe_length",
    "foe_width",
    "foe_path",
    "rss_violation",
    "tet",
    "tit",
    "cpi",
    "ta",
    "conflicting_speed",
    "ta_level",
    "dr",
];

fn columns(measures: Measures) -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(move |column| column.is_in(measures) && !OF_THE_EVENT.contains(&column.name))
}

/// The names of the columns, with these added measures.
pub(super) fn names(measures: Measures) -> impl Iterator<Item = &'static str> {
    [CONFLICT].into_iter().chain(columns(measures).map(|column| column.name))
}

/// The values of a step, as a conflict of its own that has the number of the whole one.
pub(super) fn values(step: &LoggedConflict, measures: Measures) -> impl Iterator<Item = Value<'_>> {
    [Value::Count(step.id)].into_iter().chain(columns(measures).map(|column| (column.get)(step)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::condition::Measure;

    #[test]
    fn every_column_that_it_lacks_is_one_of_the_log() {
        assert!(OF_THE_EVENT.iter().all(|name| Column::named(name).is_some()));
        assert_eq!(names(Measures::ALL).count(), 1 + COLUMNS.len() - OF_THE_EVENT.len());
    }

    #[test]
    fn every_measure_of_a_condition_is_a_column_of_the_log() {
        assert!(Measure::ALL.iter().all(|measure| Column::named(measure.name()).is_some()));
    }
}
