//! What a run leaves on disk: `conflicts.csv`, `encounters.csv` on request, `run.json`.
//!
//! Rows are written as conflicts close, whole rows in one call each step, so that after a kill whatever closed before
//! is there. A kill within that call may leave the last row half (Linux ends a write between two pages then):
//! [`crate::analysis::logged`] leaves it out.

use std::fs::{self, File};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::record::RunRecord;
use crate::detection::encounter::Encounter;
use crate::events::Conflict;
use crate::geometry::Point;
use crate::traffic::net::Net;
use crate::traffic::roster::Roster;
use crate::util::decimal;
use crate::util::units::{Metre, Second};
use crate::{Error, Result};

/// The name of the conflicts' file.
pub const CONFLICTS: &str = "conflicts.csv";
/// The name of the encounters' file.
pub const ENCOUNTERS: &str = "encounters.csv";
/// The name of the file that says how the run was made.
pub const RUN: &str = "run.json";

/// The files of the log in a folder.
pub(crate) fn files(folder: &Path) -> impl Iterator<Item = PathBuf> {
    [CONFLICTS, ENCOUNTERS, RUN].into_iter().map(|name| folder.join(name))
}

/// The columns of [`CONFLICTS`].
pub const CONFLICT_COLUMNS: [&str; 37] = [
    "id",
    "ego",
    "foe",
    "kind",
    "severity",
    "begin",
    "end",
    "time",
    "gap",
    "mu",
    "margin",
    "clearance",
    "ttc",
    "drac",
    "pet",
    "delta_v",
    "ego_speed",
    "foe_speed",
    "angle",
    "x",
    "y",
    "lane",
    "collision",
    "ego_type",
    "foe_type",
    "ego_x",
    "ego_y",
    "ego_heading",
    "ego_length",
    "ego_width",
    "ego_path",
    "foe_x",
    "foe_y",
    "foe_heading",
    "foe_length",
    "foe_width",
    "foe_path",
];
/// The columns of [`ENCOUNTERS`].
pub const ENCOUNTER_COLUMNS: [&str; 10] =
    ["time", "ego", "foe", "kind", "gap", "mu", "margin", "ttc", "drac", "severity"];

/// The log of one run.
#[derive(Debug)]
pub struct Log {
    folder: PathBuf,
    made_folder: bool,
    conflicts: Table,
    encounters: Option<Table>,
    written: u64,
}

impl Log {
    /// Makes the folder where there is none, and the files' first lines in it.
    ///
    /// # Errors
    /// [`Error::File`] that names what cannot be written.
    pub fn create(folder: &Path, with_encounters: bool) -> Result<Self> {
        let made_folder = !folder.exists();
        fs::create_dir_all(folder).map_err(|source| Error::file(folder, source))?;
        let encounters = folder.join(ENCOUNTERS);
        // Those of an earlier run would be taken for this one's.
        let stale = if with_encounters { vec![RUN] } else { vec![RUN, ENCOUNTERS] };
        for name in stale {
            let path = folder.join(name);
            if path.is_file() {
                fs::remove_file(&path).map_err(|source| Error::file(&path, source))?;
            }
        }
        Ok(Self {
            conflicts: Table::create(folder.join(CONFLICTS), &CONFLICT_COLUMNS)?,
            encounters: with_encounters.then(|| Table::create(encounters, &ENCOUNTER_COLUMNS)).transpose()?,
            folder: folder.to_owned(),
            made_folder,
            written: 0,
        })
    }

    /// Appends conflicts that have closed.
    ///
    /// # Errors
    /// [`Error::File`] where the disk takes no more.
    pub fn append_conflicts(&mut self, conflicts: &[Conflict], net: Option<&Net>, roster: &Roster) -> Result<()> {
        for conflict in conflicts {
            self.written += 1;
            let (ego, foe) = (&conflict.ego_snapshot, &conflict.foe_snapshot);
            self.conflicts.row(&[
                Cell::Count(self.written),
                Cell::Text(&conflict.ego),
                Cell::Text(&conflict.foe),
                Cell::Text(conflict.kind.name()),
                Cell::Text(conflict.severity.name()),
                Cell::Number(conflict.begin),
                Cell::Number(conflict.end),
                Cell::Number(conflict.time),
                Cell::Number(conflict.gap),
                Cell::Number(conflict.mu),
                Cell::Number(conflict.margin),
                Cell::Number(conflict.clearance),
                Cell::maybe(conflict.ttc),
                Cell::maybe(conflict.drac),
                Cell::maybe(conflict.pet),
                Cell::Number(conflict.delta_v),
                Cell::Number(conflict.ego_speed),
                Cell::Number(conflict.foe_speed),
                Cell::Number(conflict.angle),
                Cell::Number(conflict.x),
                Cell::Number(conflict.y),
                match (conflict.lane, net) {
                    (Some(lane), Some(net)) => Cell::Text(net.lane_id(lane)),
                    _ => Cell::Empty,
                },
                Cell::Text(if conflict.collision { "true" } else { "false" }),
                Cell::Text(&roster.profile_at(conflict.ego_profile).name),
                Cell::Text(&roster.profile_at(conflict.foe_profile).name),
                Cell::Number(ego.front.x),
                Cell::Number(ego.front.y),
                Cell::Number(ego.heading),
                Cell::Number(ego.length),
                Cell::Number(ego.width),
                Cell::Path(&ego.path),
                Cell::Number(foe.front.x),
                Cell::Number(foe.front.y),
                Cell::Number(foe.heading),
                Cell::Number(foe.length),
                Cell::Number(foe.width),
                Cell::Path(&foe.path),
            ])?;
        }
        self.conflicts.flush()
    }

    /// Appends the pairs in conflict of one step, where that was asked for.
    ///
    /// # Errors
    /// [`Error::File`] where the disk takes no more.
    pub fn append_encounters<'a>(
        &mut self,
        time: Second,
        encounters: impl Iterator<Item = &'a Encounter>,
        roster: &Roster,
    ) -> Result<()> {
        let Some(table) = &mut self.encounters else { return Ok(()) };
        for found in encounters {
            let Some(near) = &found.nearness else { continue };
            table.row(&[
                Cell::Number(time),
                Cell::Text(roster.id(found.ego)),
                Cell::Text(roster.id(found.foe)),
                Cell::Text(found.kind.name()),
                Cell::Number(found.gap),
                Cell::Number(found.mu),
                Cell::Number(found.margin),
                Cell::maybe(near.ttc),
                Cell::maybe(near.drac),
                Cell::Text(near.severity.name()),
            ])?;
        }
        table.flush()
    }

    /// Writes `run.json`, whole or not at all.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be written.
    pub fn write_record(&self, record: &RunRecord) -> Result<()> {
        let path = self.folder.join(RUN);
        let draft = self.folder.join(format!("{RUN}.tmp"));
        let text = serde_json::to_string_pretty(record).map_err(|error| Error::content(&path, error.to_string()))?;
        fs::write(&draft, text + "\n").map_err(|source| Error::file(&draft, source))?;
        fs::rename(&draft, &path).map_err(|source| Error::file(&path, source))
    }

    /// Takes back what was written: the input could not be used after all.
    pub fn discard(self) {
        // What cannot be removed stays: the error that led here is the one to be told.
        for path in
            [Some(&self.conflicts.path), self.encounters.as_ref().map(|table| &table.path)].into_iter().flatten()
        {
            let _ = fs::remove_file(path);
        }
        let _ = fs::remove_file(self.folder.join(RUN));
        if self.made_folder {
            let _ = fs::remove_dir(&self.folder);
        }
    }
}

/// One CSV file.
#[derive(Debug)]
struct Table {
    path: PathBuf,
    rows: csv::Writer<WholeRows>,
    /// Of the cell that is being written.
    text: String,
}

/// The largest coordinate of a path, in m, that is written as 0.
const HALF_A_CENTIMETRE: Metre = 0.005;

/// One cell of a row.
enum Cell<'a> {
    Text(&'a str),
    Number(f64),
    Count(u64),
    /// As x y x y …, to the centimetre; without commas, so that no cell needs quotes.
    Path(&'a [Point]),
    Empty,
}

impl Cell<'_> {
    fn maybe(value: Option<f64>) -> Self {
        value.map_or(Self::Empty, Self::Number)
    }

    /// What stands in the cell; made in `text` where it is not there yet.
    fn text<'a>(&'a self, text: &'a mut String) -> &'a str {
        text.clear();
        match self {
            Self::Text(text) => return text,
            Self::Number(value) => return decimal::shortest(*value, text),
            Self::Count(count) => text.push_str(&count.to_string()),
            Self::Path(points) => {
                for (number, value) in points.iter().flat_map(|point| [point.x, point.y]).enumerate() {
                    if number > 0 {
                        text.push(' ');
                    }
                    // What rounds to 0 has no sign: that would be one of rounding, another on another machine.
                    decimal::push_fixed(text, if value.abs() < HALF_A_CENTIMETRE { 0.0 } else { value }, 2);
                }
            }
            Self::Empty => {}
        }
        text
    }
}

impl Table {
    fn create(path: PathBuf, columns: &[&str]) -> Result<Self> {
        let file = File::create(&path).map_err(|source| Error::file(&path, source))?;
        let rows = WholeRows { file, written: 0, waiting: Vec::new() };
        let mut table = Self { path, rows: csv::Writer::from_writer(rows), text: String::new() };
        table.row(&columns.iter().map(|column| Cell::Text(column)).collect::<Vec<_>>())?;
        table.flush()?;
        Ok(table)
    }

    fn row(&mut self, cells: &[Cell]) -> Result<()> {
        let Self { rows, text, .. } = self;
        let written = cells.iter().try_for_each(|cell| rows.write_field(cell.text(text)));
        let written = written.and_then(|()| rows.write_record(None::<&[u8]>));
        written.map_err(|error| self.unwritable(error.into()))
    }

    fn flush(&mut self) -> Result<()> {
        self.rows.flush().map_err(|source| self.unwritable(source))
    }

    fn unwritable(&self, source: std::io::Error) -> Error {
        Error::file(&self.path, source)
    }
}

/// A file to which rows go when they are flushed, all in one call; what was flushed so far is whole.
#[derive(Debug)]
struct WholeRows {
    file: File,
    /// How many bytes are on disk.
    written: u64,
    waiting: Vec<u8>,
}

impl Write for WholeRows {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.waiting.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        let done = self.file.write_all(&self.waiting);
        match done {
            Ok(()) => self.written += self.waiting.len() as u64,
            Err(_) => self.take_back(),
        }
        // A step with many rows would keep its room for the rest of the run.
        self.waiting = Vec::new();
        done
    }
}

impl WholeRows {
    /// No row is left half where the disk is full, and the next one follows the last whole one.
    fn take_back(&mut self) {
        // If not even that can be done, that is no news.
        let _ = self.file.set_len(self.written);
        let _ = self.file.seek(SeekFrom::Start(self.written));
    }
}

#[cfg(test)]
mod tests {
    use crate::output::log::*;

    #[test]
    fn after_a_row_that_the_disk_took_half_of_the_next_one_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        let mut rows = WholeRows { file: File::create(&path).unwrap(), written: 0, waiting: b"first\n".to_vec() };
        rows.flush().unwrap();
        rows.file.write_all(b"sec").unwrap();
        rows.take_back();
        rows.write_all(b"third\n").unwrap();
        rows.flush().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "first\nthird\n");
    }

    #[test]
    fn a_path_writes_what_rounds_to_nothing_without_a_sign() {
        let points = [(-0.0, -4e-16), (-0.0049, -0.0051)].map(|(x, y)| Point::new(x, y));
        assert_eq!(Cell::Path(&points).text(&mut String::new()), "0.00 0.00 0.00 -0.01");
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let message = Log::create(Path::new("/proc/closecall"), false).unwrap_err().to_string();
        assert!(message.starts_with("/proc/closecall: "), "{message}");
    }
}
