//! The columns of a recording in a table: which attribute each of them has, and whose.
//!
//! SUMO's xml2csv writes separate columns for vehicles and persons (`vehicle_x`, `person_x`). SUMO itself writes the same
//! columns for both, named after the kind of the first road user, or without a kind (`--output.column-header plain`).

use std::path::Path;

use super::rows::{Attribute, Scope};
use crate::{Error, Result};

/// The columns of a table that matter.
#[derive(Debug)]
pub(super) struct Columns {
    /// The position of the time.
    pub time: usize,
    /// The other columns that matter, by position.
    pub named: Vec<NamedColumn>,
    /// Whether vehicles and persons share them.
    pub shared: bool,
}

/// A column that matters.
#[derive(Clone, Copy, Debug)]
pub(super) struct NamedColumn {
    /// Its position, from the left.
    pub place: usize,
    /// None if it only shows that the row is a person's.
    pub attribute: Option<Attribute>,
    pub person: bool,
}

impl Columns {
    /// The columns with these names.
    ///
    /// # Errors
    /// [`Error::Content`] if a column is missing.
    pub fn of(path: &Path, names: &[String], scope: Scope) -> Result<Self> {
        let place = |wanted: &str| names.iter().position(|name| name == wanted);
        let Some(time) = place("timestep_time").or_else(|| place("time")) else {
            return Err(Error::content(path, "it is not an fcd-output: it has no column timestep_time"));
        };
        let has = |attribute: &str| KINDS.map(|kind| place(&format!("{kind}{attribute}")).is_some());
        for needed in ["id", "x", "y", "angle", "speed"] {
            if !has(needed).contains(&true) {
                return Err(Error::content(path, format!("it has no column vehicle_{needed}")));
            }
        }
        let [vehicles, persons, _] = has("id");
        let named = names.iter().enumerate().filter_map(|(place, name)| column(place, name, scope)).collect();
        Ok(Self { time, named, shared: !(vehicles && persons) })
    }
}

/// What stands before the name of an attribute.
const KINDS: [&str; 3] = ["vehicle_", "person_", ""];

fn column(place: usize, name: &str, scope: Scope) -> Option<NamedColumn> {
    let [vehicle, person, _] = KINDS.map(|kind| name.strip_prefix(kind));
    let attribute = scope.attribute(vehicle.or(person).unwrap_or(name).as_bytes());
    let person = person.is_some();
    // A value in any person column shows that the row is a person's.
    (person || attribute.is_some()).then_some(NamedColumn { place, attribute, person })
}
