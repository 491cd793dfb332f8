//! `conflicts.csv`, row by row.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};

use super::conflicts::{LoggedConflict, LoggedSnapshot};
use crate::{Error, Result};

/// The rows of a `conflicts.csv`; memory is that of one row.
#[derive(Debug)]
pub struct CsvRows {
    path: PathBuf,
    reader: csv::Reader<Take<File>>,
    header: csv::StringRecord,
    row: csv::StringRecord,
    /// Where in a row ego's and foe's snapshots are, if they are wanted and there.
    snapshots: Option<[StancePlaces; 2]>,
}

/// Where in a row x, y, heading, length, width and path are.
type StancePlaces = [usize; 6];

impl CsvRows {
    /// Opens the file and checks its columns and its end. What follows the last whole row is left out where the run
    /// was killed while it wrote that, or is about to write more: where it `has_no_result`.
    pub fn open(path: &Path, has_no_result: impl FnOnce() -> bool) -> Result<Self> {
        let fault = |source| Error::file(path, source);
        let mut file = File::open(path).map_err(fault)?;
        let length = file.metadata().map_err(fault)?.len();
        let whole = whole_rows(&mut file, length).map_err(fault)?;
        if length == 0 {
            return Err(Error::content(path, "it is empty: not even the line of columns is there"));
        }
        if whole < length && !has_no_result() {
            return Err(Error::content(path, "its last row is cut short"));
        }
        file.seek(SeekFrom::Start(0)).map_err(fault)?;
        let mut reader = csv::Reader::from_reader(file.take(whole));
        let header = reader.headers().map_err(|error| unreadable(path, &error))?.clone();
        for column in REQUIRED {
            if !header.iter().any(|known| known == column) {
                return Err(Error::line(path, 1, format!("the column \"{column}\" is missing")));
            }
        }
        Ok(Self { path: path.to_owned(), reader, header, row: csv::StringRecord::new(), snapshots: None })
    }

    /// From now on rows have their snapshots, where the file has them.
    pub fn read_snapshots(&mut self) {
        let places = |who: &str| {
            let mut places = [0; 6];
            for (place, name) in places.iter_mut().zip(["x", "y", "heading", "length", "width", "path"]) {
                let name = format!("{who}_{name}");
                *place = self.header.iter().position(|known| known == name)?;
            }
            Some(places)
        };
        self.snapshots = places("ego").zip(places("foe")).map(<[StancePlaces; 2]>::from);
    }

    /// The columns.
    pub fn columns(&self) -> Vec<String> {
        self.header.iter().map(str::to_owned).collect()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next row; none after the last.
    pub fn read(&mut self) -> Result<Option<LoggedConflict>> {
        let more = self.reader.read_record(&mut self.row).map_err(|error| unreadable(&self.path, &error))?;
        if !more {
            return Ok(None);
        }
        let conflict = self.row.deserialize::<LoggedConflict>(Some(&self.header));
        let mut conflict = conflict.map_err(|error| unreadable(&self.path, &error))?;
        let line = || self.row.position().map_or(0, csv::Position::line);
        if let Some(number) = conflict.not_finite() {
            return Err(Error::line(&self.path, line(), format!("{number} is no number of a log")));
        }
        if let Some([ego, foe]) = &self.snapshots {
            let stance = |places| self.stance(places).map_err(|message| Error::line(&self.path, line(), message));
            conflict.snapshots = Some(Box::new([stance(ego)?, stance(foe)?]));
        }
        Ok(Some(conflict))
    }

    fn stance(&self, places: &StancePlaces) -> std::result::Result<LoggedSnapshot, String> {
        let cell = |place: usize| self.row.get(place).unwrap_or_default();
        let number = |place: usize| match cell(place) {
            "" => Ok(0.0),
            text => {
                let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
                number.ok_or_else(|| format!("\"{text}\" is no number"))
            }
        };
        let [x, y, heading, length, width, path] = *places;
        Ok(LoggedSnapshot {
            x: number(x)?,
            y: number(y)?,
            heading: number(heading)?,
            length: number(length)?,
            width: number(width)?,
            path: cell(path).to_owned(),
        })
    }
}

/// The columns without which a row is no [`LoggedConflict`].
const REQUIRED: [&str; 23] = {
    let [required @ .., _, _, _, _, _, _, _, _, _, _, _, _, _, _] = crate::output::log::CONFLICT_COLUMNS;
    required
};

/// How many of a file's bytes whole rows take: those that end with a line end.
fn whole_rows(file: &mut File, length: u64) -> std::io::Result<u64> {
    let (mut end, mut block) = (length, [0; 4096]);
    while end > 0 {
        let begin = end.saturating_sub(block.len() as u64);
        let part = &mut block[..(end - begin) as usize];
        file.seek(SeekFrom::Start(begin))?;
        file.read_exact(part)?;
        if let Some(last) = part.iter().rposition(|byte| *byte == b'\n') {
            return Ok(begin + last as u64 + 1);
        }
        end = begin;
    }
    Ok(0)
}

fn unreadable(path: &Path, error: &csv::Error) -> Error {
    let line = error.position().map_or(0, csv::Position::line);
    let message = match error.kind() {
        csv::ErrorKind::Io(source) => return Error::file(path, std::io::Error::new(source.kind(), source.to_string())),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} cells, not {expected_len}")
        }
        csv::ErrorKind::Deserialize { err, .. } => {
            let column = err.field().and_then(|field| crate::output::log::CONFLICT_COLUMNS.get(field as usize));
            column.map_or_else(|| err.kind().to_string(), |column| format!("{column}: {}", err.kind()))
        }
        csv::ErrorKind::Utf8 { err, .. } => err.to_string(),
        _ => error.to_string(),
    };
    Error::line(path, line, message)
}

#[cfg(test)]
mod tests {
    use crate::analysis::logged::csv::*;
    use std::fs;

    use crate::analysis::logged::ConflictReader;
    use crate::detection::kind::Kind;
    use crate::output::log::CONFLICTS;

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
        crate::output::log::CONFLICT_COLUMNS.join(",") + "\n"
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
    fn of_a_run_that_was_killed_as_it_wrote_a_row_the_whole_ones_are_read() {
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        // The half row is longer than what is looked through at once.
        let half = ROW.replace("truck", &"truck".repeat(2000));
        fs::write(&path, header() + ROW + &half[..half.len() - 1]).unwrap();
        let mut rows = CsvRows::open(&path, || true).unwrap();
        assert_eq!(rows.read().unwrap().map(|conflict| conflict.id), Some(1));
        assert_eq!(rows.read().unwrap(), None);
        assert!(CsvRows::open(&path, || false).is_err());
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
