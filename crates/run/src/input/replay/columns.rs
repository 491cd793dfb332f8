//! The columns of a recording in a table: which attribute each of them has, and whose.
//!
//! SUMO's xml2csv writes separate columns for vehicles and persons (`vehicle_x`, `person_x`). SUMO itself writes the same
//! columns for both, named after the kind of the first road user, or without a kind (`--output.column-header plain`).

use std::path::Path;

use super::fcd_attributes::{Attribute, Scope};
use crate::util::header;
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
    /// [`Error::Content`] if a column is missing, or is there twice.
    pub fn of(path: &Path, names: &[String], scope: Scope) -> Result<Self> {
        let place = |wanted: &str| header::exact(names, wanted).map_err(|why| Error::content(path, why));
        let time = match place("timestep_time")? {
            None => place("time")?,
            place => place,
        };
        let Some(time) = time else {
            return Err(Error::content(path, "it is not an fcd-output: it has no column timestep_time"));
        };
        let is_there = |name: &str| names.iter().any(|known| known == name);
        let has = |attribute: &str| KINDS.map(|kind| is_there(&format!("{kind}{attribute}")));
        for needed in ["id", "x", "y", "angle", "speed"] {
            if !has(needed).contains(&true) {
                return Err(Error::content(path, format!("it has no column vehicle_{needed}")));
            }
        }
        let [vehicles, persons, _] = has("id");
        let named = names.iter().enumerate().filter_map(|(place, name)| column(place, name, scope)).collect::<Vec<_>>();
        let what = |column: &NamedColumn| column.attribute.map(|attribute| (attribute, column.person));
        for (number, column) in named.iter().enumerate().filter(|(_, column)| column.attribute.is_some()) {
            if let Some(other) = named[..number].iter().find(|other| what(other) == what(column)) {
                let [first, second] = [other, column].map(|column| &names[column.place]);
                return Err(Error::content(path, format!("its columns {first} and {second} are the same")));
            }
        }
        Ok(Self { time, named, shared: !(vehicles && persons) })
    }
}

/// The places of the columns of an fcd-output that are read.
///
/// # Errors
/// Those of `Columns::of`.
pub fn columns_of_fcd(names: &[String]) -> Result<Vec<usize>> {
    let columns = Columns::of(Path::new("the data frame"), names, Scope::All)?;
    Ok(std::iter::once(columns.time).chain(columns.named.iter().map(|column| column.place)).collect())
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
