//! A log as one Parquet file, for a data set of many runs.

use std::io::Write;
use std::path::Path;

use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::TypePtr;
use serde::{Deserialize, Serialize};

use super::packed::{DIGEST_KEY, FINGERPRINT_KEY, RECORD_KEY, RUN_TIME_KEY, RunTime, digest};
use super::reader::{self, ConflictReader};
use super::run::record;
use crate::{Error, Result};
use closecall_run::output::input_hash::Hasher;
use closecall_run::output::log::{CONFLICTS, PARQUET};
use closecall_run::output::parquet_columns::{self, fill};
use closecall_run::output::schema::Column;
use closecall_run::util::output_file::OutputFile;
use closecall_run::util::parquet_column::unreadable;

/// Rows of a row group: what is in memory while one is written.
const GROUP: usize = 1 << 16;

/// A column with the same value in all rows of a run, which tells the run from the others of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// The column's name.
    pub name: String,
    /// Its value in this run.
    pub value: LabelValue,
}

/// The value of a [`Label`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum LabelValue {
    /// A whole number.
    Count(u32),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

/// Writes a log with its `run.json` as the Parquet file `out`, whole or not at all.
///
/// # Errors
/// Those of reading the log; [`Error::file`] or [`Error::content`] where `out` cannot be written.
pub fn pack(folder: &Path, labels: &[Label], fingerprint: &str, run_time: RunTime, out: &Path) -> Result<()> {
    let conflicts = ConflictReader::open(folder)?.with_snapshots();
    let (_, record) = record(folder)?;
    let mut file = OutputFile::create(out)?;
    let run_time = serde_json::to_string(&run_time).map_err(|error| Error::Value(error.to_string()))?;
    let metadata = [(RECORD_KEY, record), (FINGERPRINT_KEY, fingerprint.to_owned()), (RUN_TIME_KEY, run_time)];
    write(&mut file, conflicts, labels, metadata).map_err(|fault| match fault {
        Fault::Own(error) => error,
        Fault::Parquet(error) => unreadable(out, &error).into(),
    })?;
    Ok(file.finish()?)
}

/// Turns the `conflicts.csv` of a log into `conflicts.parquet`.
///
/// # Errors
/// Those of [`pack`]; [`Error::file`] where the CSV file cannot be removed.
pub fn pack_in_place(folder: &Path) -> Result<()> {
    pack(folder, &[], "", RunTime::default(), &folder.join(PARQUET))?;
    let csv = folder.join(CONFLICTS);
    std::fs::remove_file(&csv).map_err(|source| Error::file(&csv, source))
}

enum Fault {
    Own(Error),
    Parquet(ParquetError),
}

impl From<ParquetError> for Fault {
    fn from(error: ParquetError) -> Self {
        Self::Parquet(error)
    }
}

fn write(
    file: &mut OutputFile,
    mut conflicts: ConflictReader,
    labels: &[Label],
    metadata: [(&str, String); 3],
) -> std::result::Result<(), Fault> {
    let file = HashedFile { file, hasher: Hasher::default() };
    let columns = conflicts.columns_of_schema();
    let mut writer = SerializedFileWriter::new(file, schema(&columns, labels)?, parquet_columns::properties())?;
    let mut rows = Vec::with_capacity(1024);
    loop {
        rows.clear();
        for conflict in conflicts.by_ref().take(GROUP) {
            rows.push(conflict.map_err(Fault::Own)?);
        }
        if rows.is_empty() {
            reader::check_none_lost(conflicts.lost().as_slice()).map_err(Fault::Own)?;
            break;
        }
        let mut group = writer.next_row_group()?;
        let mut written = 0;
        while let Some(mut column) = group.next_column()? {
            match columns.get(written) {
                Some(of_log) => fill(&mut column, &rows, of_log)?,
                None => repeat(&mut column, rows.len(), &labels[written - columns.len()].value)?,
            }
            column.close()?;
            written += 1;
        }
        group.close()?;
    }
    writer.flush().map_err(ParquetError::from)?;
    let digest =
        digest(writer.bytes_written(), writer.inner().hasher.clone(), metadata.each_ref().map(|(_, it)| &**it));
    for (key, value) in metadata.into_iter().chain([(DIGEST_KEY, digest)]) {
        writer.append_key_value_metadata(KeyValue::new(key.to_owned(), value));
    }
    writer.close()?;
    Ok(())
}

/// A file that hashes what is written to it.
struct HashedFile<'a> {
    file: &'a mut OutputFile,
    hasher: Hasher,
}

impl Write for HashedFile<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hasher.add(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

/// The schema of a file with these columns of the log and these labels.
fn schema(of_log: &[&Column], labels: &[Label]) -> std::result::Result<TypePtr, ParquetError> {
    let label = |label: &Label| {
        let physical = match label.value {
            LabelValue::Count(_) => Physical::INT64,
            LabelValue::Number(_) => Physical::DOUBLE,
            LabelValue::Text(_) => Physical::BYTE_ARRAY,
        };
        parquet_columns::typed(&label.name, physical, Repetition::REQUIRED)
    };
    let of_log = of_log.iter().map(|column| parquet_columns::of_log(column));
    parquet_columns::schema(of_log.chain(labels.iter().map(label)))
}

/// Writes a label: the same value in all rows.
fn repeat(
    column: &mut SerializedColumnWriter<'_>,
    rows: usize,
    value: &LabelValue,
) -> std::result::Result<(), ParquetError> {
    match value {
        LabelValue::Count(count) => {
            column.typed::<Int64Type>().write_batch(&vec![i64::from(*count); rows], None, None)?;
        }
        LabelValue::Number(number) => {
            column.typed::<DoubleType>().write_batch(&vec![*number; rows], None, None)?;
        }
        LabelValue::Text(text) => {
            column.typed::<ByteArrayType>().write_batch(&vec![ByteArray::from(text.as_str()); rows], None, None)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use crate::logged::pack::*;
    use crate::logged::{PARQUET, Packed};
    use closecall_run::output::log::{CONFLICTS, RUN};
    use closecall_run::output::schema::{COLUMNS, ColumnType, LoggedConflict};

    fn labels() -> [Label; 3] {
        [
            ("option_epsilon", LabelValue::Number(0.5)),
            ("sumo_x", LabelValue::Text("y".to_owned())),
            ("seed", LabelValue::Count(7)),
        ]
        .map(|(name, value)| Label { name: name.to_owned(), value })
    }

    /// A value of a column in the row of this number; some are missing.
    fn cell(column: &Column, id: usize) -> String {
        match (column.name, column.column_type) {
            ("ego", _) => format!("\"a,{id}\""),
            ("kind", _) => "side".to_owned(),
            ("severity", _) => "serious".to_owned(),
            (_, ColumnType::Count) => id.to_string(),
            ("collision", _) => id.is_multiple_of(2).to_string(),
            _ if column.is_optional() && (id + column.name.len()).is_multiple_of(3) => String::new(),
            (_, ColumnType::Flag) => id.is_multiple_of(2).to_string(),
            ("ego_path" | "foe_path", _) => format!("{} -2.50", id % 7),
            (name, ColumnType::Text) => format!("{name} {}", id % 7),
            ("margin", _) => format!("-{}.25", id % 100),
            (_, ColumnType::Number) if column.unit() == "1" => "0.25".to_owned(),
            (_, ColumnType::Number) => format!("{}.25", id % 100),
        }
    }

    fn packed(name: &str, rows: usize) -> (Vec<LoggedConflict>, Vec<LoggedConflict>, Packed) {
        let folder = std::env::temp_dir().join(format!("closecall-pack-{name}-{}", std::process::id()));
        fs::create_dir_all(folder.join("log")).unwrap();
        let mut text = COLUMNS.map(|column| column.name).join(",") + "\n";
        for id in 1..=rows {
            text += &(COLUMNS.map(|column| cell(&column, id)).join(",") + "\n");
        }
        fs::write(folder.join("log").join(CONFLICTS), text).unwrap();
        fs::write(folder.join("log").join(RUN), "{}\n").unwrap();
        let run_time = RunTime { wall: 1.5, cpu: 2.25 };
        pack(&folder.join("log"), &labels(), "abc", run_time, &folder.join("p").join(PARQUET)).unwrap();
        assert_eq!(fs::read_dir(folder.join("p")).unwrap().count(), 1, "a draft is left");
        let read = |folder: &Path| {
            let reader = ConflictReader::open(folder).unwrap().with_snapshots();
            assert_eq!(reader.columns(), COLUMNS.map(|column| column.name));
            reader.collect::<Result<Vec<_>>>().unwrap()
        };
        let both = (read(&folder.join("log")), read(&folder.join("p")));
        let beside = Packed::of(&folder.join("p").join(PARQUET)).unwrap();
        fs::remove_dir_all(folder).unwrap();
        (both.0, both.1, beside)
    }

    #[test]
    fn a_flipped_bit_among_the_rows_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let [log, packed] = ["log", "p"].map(|name| folder.path().join(name));
        fs::create_dir(&log).unwrap();
        let rows = (1..=20).map(|id| COLUMNS.map(|column| cell(&column, id)).join(",") + "\n").collect::<String>();
        fs::write(log.join(CONFLICTS), COLUMNS.map(|column| column.name).join(",") + "\n" + &rows).unwrap();
        fs::write(log.join(RUN), "{}\n").unwrap();
        pack(&log, &labels(), "abc", RunTime::default(), &packed.join(PARQUET)).unwrap();
        let whole = fs::read(packed.join(PARQUET)).unwrap();
        let is_noticed = || {
            let Ok(mut reader) = ConflictReader::open(&packed) else { return true };
            reader.by_ref().any(|row| row.is_err()) || reader.lost().is_some()
        };
        assert!(!is_noticed());
        for place in (4..whole.len() / 4).step_by(97) {
            let mut changed = whole.clone();
            changed[place] ^= 4;
            fs::write(packed.join(PARQUET), changed).unwrap();
            assert!(is_noticed(), "byte {place} of {}", whole.len());
        }
    }

    #[test]
    fn a_packed_log_reads_the_same_across_row_groups() {
        for rows in [0, 1, 5000, GROUP + 10] {
            let (logged, packed, beside) = packed(&format!("rows{rows}"), rows);
            assert_eq!(logged.len(), rows);
            assert_eq!(logged, packed);
            assert_eq!((beside.record.as_str(), beside.fingerprint.as_str()), ("{}\n", "abc"));
            assert_eq!(beside.run_time, Some(RunTime { wall: 1.5, cpu: 2.25 }));
            let names = beside.labels.iter().map(|(name, number)| (name.as_str(), *number)).collect::<Vec<_>>();
            assert_eq!(names, [("option_epsilon", true), ("sumo_x", false), ("seed", true)]);
        }
    }

    #[test]
    fn a_packed_log_has_the_added_columns_that_it_was_told_to_have() {
        let folder = tempfile::tempdir().unwrap();
        let [log, packed] = ["log", "p"].map(|name| folder.path().join(name));
        fs::create_dir(&log).unwrap();
        let columns = COLUMNS.iter().filter(|column| column.is_in("t2,ei".parse().unwrap())).map(|column| column.name);
        let columns = columns.collect::<Vec<_>>();
        fs::write(log.join(CONFLICTS), columns.join(",") + "\n").unwrap();
        fs::write(log.join(RUN), "{}\n").unwrap();
        pack(&log, &labels(), "abc", RunTime::default(), &packed.join(PARQUET)).unwrap();
        assert_eq!(ConflictReader::open(&packed).unwrap().columns(), columns);
        assert!(columns.ends_with(&["t2", "ei"]));
    }

    #[test]
    fn a_file_that_is_cut_short_is_named() {
        let path = std::env::temp_dir().join(format!("closecall-cut-{}", std::process::id()));
        fs::write(&path, "PAR1 and no more").unwrap();
        let message = Packed::of(&path).unwrap_err().to_string();
        fs::remove_file(&path).unwrap();
        assert!(message.contains("closecall-cut-") && !message.contains('\n'), "{message}");
    }
}
