//! `conflicts.csv`, row by row.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::encounter::{Kind, Severity};
use crate::log::CONFLICTS;
use crate::units::{Metre, MetrePerSecond, MetrePerSecondSquared, Radian, Second};
use crate::{Error, Result};

/// A row of `conflicts.csv`; docs/log.md says what each column is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoggedConflict {
    /// 1, 2, 3, … in the order of the file.
    pub id: u64,
    /// SUMO's id of the ego.
    pub ego: String,
    /// SUMO's id of the foe.
    pub foe: String,
    /// The kind at the smallest margin.
    pub kind: Kind,
    /// The worst over the event.
    pub severity: Severity,
    /// First step with margin < 0, in s.
    pub begin: Second,
    /// Last step with margin < 0, in s.
    pub end: Second,
    /// The step with the smallest margin, in s.
    pub time: Second,
    /// The room that was left, in m.
    pub gap: Metre,
    /// The minimal collision distance, in m.
    pub mu: Metre,
    /// gap − μ, in m.
    pub margin: Metre,
    /// Smallest distance between the two rectangles, in m.
    pub clearance: Metre,
    /// Smallest time to collision, in s.
    pub ttc: Option<Second>,
    /// Largest deceleration rate to avoid the collision, in m/s².
    pub drac: Option<MetrePerSecondSquared>,
    /// Post-encroachment time, in s.
    pub pet: Option<Second>,
    /// Speed change of the ego in a fully inelastic collision, in m/s.
    pub delta_v: MetrePerSecond,
    /// Speed of the ego, in m/s.
    pub ego_speed: MetrePerSecond,
    /// Speed of the foe, in m/s.
    pub foe_speed: MetrePerSecond,
    /// Angle between the headings at the meeting place, in rad.
    pub angle: Radian,
    /// The ego's front bumper at the meeting place, x in m.
    pub x: Metre,
    /// The same, y in m.
    pub y: Metre,
    /// The lane of the meeting place; empty where there is none.
    pub lane: String,
    /// Whether the rectangles overlapped in any step.
    pub collision: bool,
    /// The ego's type; empty in logs of before there was this column.
    #[serde(default)]
    pub ego_type: String,
    /// The foe's type; empty in logs of before there was this column.
    #[serde(default)]
    pub foe_type: String,
}

impl LoggedConflict {
    /// The edge of the meeting place; empty where there is no lane.
    pub fn edge(&self) -> &str {
        self.lane.rsplit_once('_').map_or("", |(edge, _)| edge)
    }

    /// The junction of the meeting place; empty where it is not within one.
    pub fn junction(&self) -> &str {
        let within = self.edge().strip_prefix(':');
        within.and_then(|edge| edge.rsplit_once('_')).map_or("", |(junction, _)| junction)
    }
}

/// The conflicts of one log folder, one by one, in the order of the file; memory is that of one row.
#[derive(Debug)]
pub struct ConflictReader {
    path: PathBuf,
    reader: csv::Reader<File>,
    header: csv::StringRecord,
    row: csv::StringRecord,
    failed: bool,
}

impl ConflictReader {
    /// Opens the `conflicts.csv` of a log folder.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read; [`Error::Content`] where it is empty or cut short;
    /// [`Error::Line`] where its first line is not that of a log.
    pub fn open(folder: &Path) -> Result<Self> {
        let path = folder.join(CONFLICTS);
        let mut file = File::open(&path).map_err(|source| Error::file(&path, source))?;
        check_end(&mut file, &path)?;
        let mut reader = csv::Reader::from_reader(file);
        let header = reader.headers().map_err(|error| unreadable(&path, &error))?.clone();
        for column in REQUIRED {
            if !header.iter().any(|known| known == column) {
                return Err(Error::line(&path, 1, format!("the column \"{column}\" is missing")));
            }
        }
        Ok(Self { path, reader, header, row: csv::StringRecord::new(), failed: false })
    }

    /// The columns of the file.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.header.iter()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn read(&mut self) -> Result<Option<LoggedConflict>> {
        let more = self.reader.read_record(&mut self.row).map_err(|error| unreadable(&self.path, &error))?;
        if !more {
            return Ok(None);
        }
        let conflict = self.row.deserialize::<LoggedConflict>(Some(&self.header));
        let conflict = conflict.map_err(|error| unreadable(&self.path, &error))?;
        let line = || self.row.position().map_or(0, csv::Position::line);
        // A NaN would compare with nothing in every quantile that follows.
        let numbers = [conflict.begin, conflict.end, conflict.time, conflict.gap, conflict.mu, conflict.margin];
        let numbers = numbers.into_iter().chain([conflict.delta_v, conflict.x, conflict.y]);
        let measures = [conflict.ttc, conflict.drac, conflict.pet].into_iter().flatten();
        match numbers.chain(measures).find(|number| !number.is_finite()) {
            Some(number) => Err(Error::line(&self.path, line(), format!("{number} is no number of a log"))),
            None => Ok(Some(conflict)),
        }
    }
}

impl Iterator for ConflictReader {
    type Item = Result<LoggedConflict>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let read = self.read().transpose();
        self.failed = matches!(read, Some(Err(_)));
        read
    }
}

/// The columns without which a row is no [`LoggedConflict`].
const REQUIRED: [&str; 23] = {
    let [required @ .., _, _, _, _, _, _, _, _, _, _, _, _, _, _] = crate::log::CONFLICT_COLUMNS;
    required
};

/// Whole rows end with a line end: what does not was cut short.
fn check_end(file: &mut File, path: &Path) -> Result<()> {
    let fault = |source| Error::file(path, source);
    let length = file.metadata().map_err(fault)?.len();
    if length == 0 {
        return Err(Error::content(path, "it is empty: not even the line of columns is there"));
    }
    let mut last = [0];
    file.seek(SeekFrom::End(-1)).map_err(fault)?;
    file.read_exact(&mut last).map_err(fault)?;
    file.seek(SeekFrom::Start(0)).map_err(fault)?;
    if last == *b"\n" { Ok(()) } else { Err(Error::content(path, "its last row is cut short")) }
}

fn unreadable(path: &Path, error: &csv::Error) -> Error {
    let line = error.position().map_or(0, csv::Position::line);
    let message = match error.kind() {
        csv::ErrorKind::Io(source) => return Error::file(path, std::io::Error::new(source.kind(), source.to_string())),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} cells, not {expected_len}")
        }
        csv::ErrorKind::Deserialize { err, .. } => {
            let column = err.field().and_then(|field| crate::log::CONFLICT_COLUMNS.get(field as usize));
            column.map_or_else(|| err.kind().to_string(), |column| format!("{column}: {}", err.kind()))
        }
        csv::ErrorKind::Utf8 { err, .. } => err.to_string(),
        _ => error.to_string(),
    };
    Error::line(path, line, message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const ROW: &str = concat!(
        "1,a,b,side,serious,0,1,0.5,1,3,-2,0.4,1.2,3.5,,2,10,5,1.57,7,8,:J_12_0_1,false,car,truck,",
        "3,8,0,4.6,1.8,5 8 7 8,9,5,1.57,12,2.5,\n",
    );

    fn read(name: &str, text: &str) -> Result<Vec<LoggedConflict>> {
        let folder = std::env::temp_dir().join(format!("closecall-logged-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(CONFLICTS), text).unwrap();
        let conflicts = ConflictReader::open(&folder).and_then(Iterator::collect);
        fs::remove_dir_all(folder).unwrap();
        conflicts
    }

    fn header() -> String {
        crate::log::CONFLICT_COLUMNS.join(",") + "\n"
    }

    #[test]
    fn a_row_comes_back_as_it_was_written() {
        let [conflict] = &read("row", &(header() + ROW)).unwrap()[..] else { panic!() };
        assert_eq!((conflict.id, &*conflict.ego, conflict.kind, conflict.margin), (1, "a", Kind::Side, -2.0));
        assert_eq!((conflict.ttc, conflict.pet, conflict.collision), (Some(1.2), None, false));
        assert_eq!((conflict.edge(), conflict.junction(), &*conflict.foe_type), (":J_12_0", "J_12", "truck"));
    }

    #[test]
    fn a_log_without_conflicts_is_a_log() {
        assert_eq!(read("none", &header()).unwrap(), []);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (name, text, said) in [
            ("empty", String::new(), "it is empty"),
            ("schema", "time,ego\n".to_owned(), "line 1: the column \"id\" is missing"),
            ("cells", header() + ROW + "2,a,b,side\n", "line 3: the row has 4 cells, not 37"),
            ("cut", header() + &ROW[..ROW.len() - 1], "its last row is cut short"),
            ("kind", header() + &ROW.replace("side", "odd"), "line 2: unknown variant"),
            ("number", header() + &ROW.replace("-2", "NaN"), "line 2: NaN is no number of a log"),
        ] {
            let message = read(name, &text).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains('\n'), "{message}");
        }
    }
}
