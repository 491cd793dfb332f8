//! The columns of the series, `series.csv` or `series.parquet`, which has a row per step of each conflict: the number of the
//! conflict, then the log's columns that a single step has.

use super::schema::{COLUMNS, Column};
use closecall::options::measures::Measures;

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

/// The columns, with these added measures, of a step as a conflict of its own that has the number of the whole one.
pub(super) fn columns(measures: Measures) -> impl Iterator<Item = Column> {
    let number = Column::named("id").map(|id| id.renamed(CONFLICT));
    let of_a_step = move |column: &&Column| column.is_in(measures) && !OF_THE_EVENT.contains(&column.name);
    number.into_iter().chain(COLUMNS.iter().filter(of_a_step).copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use closecall::options::condition::Measure;
    use strum::VariantNames;

    #[test]
    fn every_column_that_it_lacks_is_one_of_the_log() {
        assert!(OF_THE_EVENT.iter().all(|name| Column::named(name).is_some()));
        assert_eq!(columns(Measures::ALL).count(), 1 + COLUMNS.len() - OF_THE_EVENT.len());
    }

    #[test]
    fn every_measure_of_a_condition_is_a_column_of_the_log() {
        assert!(Measure::VARIANTS.iter().all(|name| Column::named(name).is_some()));
    }
}
