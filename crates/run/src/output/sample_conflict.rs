//! A logged conflict to try things with.

use super::schema::{COLUMNS, LoggedConflict};

/// A side conflict of caution in which the named columns have these texts, as a log writes them; every other is 1 where it
/// can be.
///
/// # Errors
/// Where a column cannot have the text.
pub fn sample(values: &[(&str, &str)]) -> Result<LoggedConflict, String> {
    let cell = |column: usize| {
        let name = COLUMNS[column].name;
        let own = values.iter().find(|(own, _)| *own == name).map(|(_, text)| *text);
        COLUMNS[column].column_type.parse(own.unwrap_or(match name {
            "kind" => "side",
            "severity" => "caution",
            "collision" => "false",
            "unavoidable" | "collision_sumo" | "artefact" => "",
            _ => "1",
        }))
    };
    LoggedConflict::from_cells(cell)
}
