//! `conflicts.csv`, row by row.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};

use super::plausible::PlausibleRows;
use crate::{Error, Result};
use closecall_run::output::input_hash::Hasher;
use closecall_run::output::schema::{COLUMNS, Column, LoggedConflict, Presence, Value};
use closecall_run::util::csv_safe::plain;
use closecall_run::util::input_file::{self, ShortRows};

/// The rows of a `conflicts.csv`; memory is that of one row.
#[derive(Debug)]
pub(crate) struct CsvLog {
    path: PathBuf,
    reader: csv::Reader<ShortRows<Hashed>>,
    header: csv::StringRecord,
    row: csv::StringRecord,
    /// Where in a row each of the [`COLUMNS`] is; none where the file lacks it or it is not to be read.
    places: [Option<usize>; COLUMNS.len()],
    plausible: PlausibleRows,
    /// Whether the run wrote texts so that no spreadsheet runs them.
    is_safe: bool,
}

impl CsvLog {
    /// Opens the file and checks its columns and its end. A row that is cut short at the end is ignored if the log
    /// `has_no_result`: the run was killed while it wrote the row, or is still writing it.
    pub fn open(path: &Path, has_no_result: bool) -> Result<Self> {
        let fault = |source| Error::file(path, source);
        let mut file = input_file::file(path)?;
        let length = file.metadata().map_err(fault)?.len();
        let whole = whole_rows(&mut file, length).map_err(fault)?;
        if length == 0 {
            return Err(Error::content(path, "it is empty: not even the line of columns is there"));
        }
        if whole < length && !has_no_result {
            return Err(Error::content(path, "its last row is cut short"));
        }
        file.seek(SeekFrom::Start(0)).map_err(fault)?;
        let hashed = Hashed { file: file.take(whole), hasher: Hasher::default() };
        let mut reader = csv::Reader::from_reader(ShortRows::new(hashed));
        let header = reader.headers().map_err(|error| unreadable(path, 1, &error))?.clone();
        let mut log = Self {
            path: path.to_owned(),
            reader,
            header,
            row: csv::StringRecord::new(),
            places: [None; COLUMNS.len()],
            plausible: PlausibleRows::default(),
            is_safe: false,
        };
        log.read_columns(|presence| presence != Presence::Snapshot);
        let mut places = COLUMNS.iter().zip(log.places);
        let missing = places.find(|(column, place)| column.presence == Presence::Required && place.is_none());
        match missing {
            Some((column, _)) => Err(Error::line(path, 1, format!("the column \"{}\" is missing", column.name))),
            None => Ok(log),
        }
    }

    /// Reads the snapshots as well, where the file has them.
    pub(crate) fn read_snapshots(&mut self) {
        self.read_columns(|_| true);
    }

    fn read_columns(&mut self, is_wanted: impl Fn(Presence) -> bool) {
        let place = |column: &Column| self.header.iter().position(|known| column.is_named(known));
        self.places = COLUMNS.map(|column| place(&column).filter(|_| is_wanted(column.presence)));
    }

    /// Reads texts as they were before they were made safe for spreadsheets.
    pub(crate) fn undo_csv_safe(&mut self) {
        self.is_safe = true;
    }

    /// Demands that the margins are below 0, as a run logs them unless its options say otherwise.
    pub(crate) fn demand_margins_below_zero(&mut self) {
        self.plausible.margins_below_zero = true;
    }

    /// The SHA-256 of what was read: once no row is left, that of the file.
    pub fn digest(&self) -> String {
        self.reader.get_ref().source().hasher.clone().digits()
    }

    /// The columns of the file.
    pub fn columns(&self) -> Vec<String> {
        self.header.iter().map(str::to_owned).collect()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The next conflict; none after the last.
    pub fn read(&mut self) -> Result<Option<LoggedConflict>> {
        let line = self.reader.position().line();
        self.reader.get_mut().begin_row();
        let more = self.reader.read_record(&mut self.row).map_err(|error| unreadable(&self.path, line, &error))?;
        if !more {
            return Ok(None);
        }
        let cell = |column: usize| match self.places[column].and_then(|place| self.row.get(place)) {
            Some(text) if self.is_safe => COLUMNS[column].column_type.parse(plain(text)),
            Some(text) => COLUMNS[column].column_type.parse(text),
            None => Ok(Value::Missing),
        };
        let checked = LoggedConflict::from_cells(cell).and_then(|row| self.plausible.check(&row).map(|()| Some(row)));
        checked.map_err(|message| Error::line(&self.path, line, message))
    }
}

/// A file whose bytes are hashed as they are read.
#[derive(Debug)]
struct Hashed {
    file: Take<File>,
    hasher: Hasher,
}

impl Read for Hashed {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.hasher.add(&buffer[..read]);
        Ok(read)
    }
}

/// How many bytes of a file its whole rows take: those that end with a line end.
fn whole_rows(file: &mut File, length: u64) -> std::io::Result<u64> {
    let mut end = length;
    let mut block = [0; 4096];
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

fn unreadable(path: &Path, line: u64, error: &csv::Error) -> Error {
    let line = error.position().map_or(line, csv::Position::line);
    let message = match error.kind() {
        csv::ErrorKind::Io(source) if source.kind() == std::io::ErrorKind::InvalidData => source.to_string(),
        csv::ErrorKind::Io(source) => return Error::file(path, std::io::Error::new(source.kind(), source.to_string())),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the row has {len} cells, not {expected_len}")
        }
        csv::ErrorKind::Utf8 { err, .. } => err.to_string(),
        _ => error.to_string(),
    };
    Error::line(path, line, message)
}

#[cfg(test)]
mod tests {
    use crate::logged::conflicts_csv::*;
    use std::fs;

    use crate::logged::ConflictReader;
    use closecall::detection::kind::Kind;
    use closecall_run::output::log::CONFLICTS;

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

    /// The columns of [`ROW`]; a later version may have more.
    fn header() -> String {
        let first = "id,ego,foe,kind,severity,begin,end,time,gap,mu,margin,clearance,ttc,drac,pet,delta_v,ego_speed,\
                     foe_speed,angle,x,y,lane,collision,ego_type,foe_type,";
        let snapshots = ["ego", "foe"]
            .map(|user| format!("{user}_x,{user}_y,{user}_heading,{user}_length,{user}_width,{user}_path"));
        format!("{first}{}\n", snapshots.join(","))
    }

    #[test]
    fn a_row_comes_back_as_it_was_written() {
        let [conflict] = &read("row", &(header() + ROW)).unwrap()[..] else { panic!() };
        assert_eq!((conflict.id, &*conflict.ego, conflict.kind, conflict.margin), (1, "a", Kind::Side, -2.0));
        assert_eq!((conflict.ttc, conflict.pet, conflict.collision), (Some(1.2), None, false));
        assert_eq!((conflict.edge(), conflict.junction(), &*conflict.foe_type), (":J_12_0", "J_12", "truck"));
    }

    #[test]
    fn the_delta_v_of_an_earlier_version_is_the_egos() {
        let [conflict] = &read("earlier", &(header() + ROW)).unwrap()[..] else { panic!() };
        assert_eq!((conflict.ego_delta_v, conflict.foe_delta_v, conflict.delta_v()), (2.0, None, 2.0));
        let header = header().replace("delta_v", "ego_delta_v,foe_delta_v");
        let [conflict] = &read("delta_v", &(header + &ROW.replace(",,2,10,", ",,2,9,10,"))).unwrap()[..] else {
            panic!()
        };
        assert_eq!((conflict.ego_delta_v, conflict.foe_delta_v, conflict.delta_v()), (2.0, Some(9.0), 9.0));
    }

    #[test]
    fn a_log_without_conflicts_is_a_log() {
        assert_eq!(read("none", &header()).unwrap(), []);
    }

    #[test]
    fn a_half_row_of_a_killed_run_is_ignored() {
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        // The half row is longer than the blocks in which its begin is searched.
        let half = ROW.replace("truck", &"truck".repeat(2000));
        fs::write(&path, header() + ROW + &half[..half.len() - 1]).unwrap();
        let mut rows = CsvLog::open(&path, true).unwrap();
        assert_eq!(rows.read().unwrap().map(|conflict| conflict.id), Some(1));
        assert_eq!(rows.read().unwrap(), None);
        assert!(CsvLog::open(&path, false).is_err());
    }

    #[test]
    fn an_error_names_its_line() {
        for (name, text, said) in [
            ("empty", String::new(), "it is empty"),
            ("schema", "time,ego\n".to_owned(), "line 1: the column \"id\" is missing"),
            ("cells", header() + ROW + "2,a,b,side\n", "line 3: the row has 4 cells, not 37"),
            ("cut", header() + &ROW[..ROW.len() - 1], "its last row is cut short"),
            ("kind", header() + &ROW.replace("side", "odd"), "line 2: kind: \"odd\" is not a kind"),
            ("number", header() + &ROW.replace("-2", "NaN"), "line 2: margin: NaN is not a finite number"),
        ] {
            let message = read(name, &text).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains('\n'), "{message}");
        }
    }
}
